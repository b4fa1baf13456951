//! An instance behind its handle, and the guard under which every call runs.

use super::logger::Logger;
use super::types::{Instance, Status};
use crate::handles::Registry;
use crate::lifecycle::{Lifecycle, Refusal};
use std::any::Any;
use std::collections::BTreeMap;
use std::panic::{AssertUnwindSafe, catch_unwind};

/// All instances of this process.
pub(super) static INSTANCES: Registry<Component> = Registry::new();

/// One instance.
pub(super) struct Component {
    pub(super) lifecycle: Lifecycle,
    pub(super) logger: Logger,
    /// Saved states by handle; they belong to the instance and are freed with it.
    pub(super) saved: BTreeMap<usize, Lifecycle>,
}

/// Runs `body` on the instance: a refusal is logged with the function's name and becomes an error, and
/// so does a panic, after which the instance is failed. An unknown or freed instance is an error without
/// a message, since nobody is known to tell it to.
pub(super) fn call(
    instance: Instance,
    function: &str,
    body: impl FnOnce(&mut Component) -> Result<(), Refusal>,
) -> Status {
    let Some(shared) = INSTANCES.get(instance) else { return Status::Error };
    // The standard forbids a call while another one runs on the instance, be it from a second thread or
    // from inside a callback. Waiting could hang the importer.
    let Ok(mut component) = shared.try_lock() else { return Status::Error };
    let component = &mut *component;
    match catch_unwind(AssertUnwindSafe(|| body(component))) {
        Ok(Ok(())) => Status::Ok,
        Ok(Err(refusal)) => {
            component.logger.error(&format!("{function}: {refusal}"));
            Status::Error
        }
        Err(panic) => {
            component.lifecycle.fail();
            component.logger.error(&format!("{function}: defect in the FMU: {}", words(&*panic)));
            Status::Error
        }
    }
}

/// What a panic said.
pub(super) fn words(panic: &(dyn Any + Send)) -> &str {
    match (panic.downcast_ref::<&str>(), panic.downcast_ref::<String>()) {
        (Some(words), _) => words,
        (_, Some(words)) => words,
        _ => "unknown",
    }
}
