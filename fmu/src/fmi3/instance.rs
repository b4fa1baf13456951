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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fmi3::types::LogMessage;
    use crate::fmi3::{fmi3FreeInstance, fmi3Reset, fmi3Terminate};
    use crate::model::{Failure, Model, Outcome};
    use bekker_modeldescription::xml::Description;
    use std::ffi::{CStr, c_char, c_void};

    /// A model of which only reset works.
    struct Broken;

    impl Model for Broken {
        fn description(&self) -> &Description {
            panic!("no description")
        }
        fn get(&self, _: usize) -> f64 {
            f64::NAN
        }
        fn set(&mut self, _: usize, _: f64) {}
        fn start(&mut self) -> Result<(), Failure> {
            panic!("start went wrong")
        }
        fn inner_step(&self) -> f64 {
            1.0
        }
        fn elapsed(&self) -> f64 {
            0.0
        }
        fn advance(&mut self, _: u64) -> Result<Outcome, Failure> {
            Ok(Outcome::Running)
        }
        fn reset(&mut self) {}
        fn duplicate(&self) -> Box<dyn Model> {
            Box::new(Self)
        }
    }

    unsafe extern "C" fn keep(place: *mut c_void, _: Status, _: *const c_char, message: *const c_char) {
        // SAFETY: the test passes the place of a String, the library a text.
        let (log, message) = unsafe { (&mut *place.cast::<String>(), CStr::from_ptr(message)) };
        log.push_str(&message.to_string_lossy());
    }

    #[test]
    fn property_a_panic_stays_inside_and_is_told() {
        let mut log = String::new();
        let callback: LogMessage = Some(keep);
        let logger = Logger::new(callback, (&raw mut log).cast(), false);
        let lifecycle = Lifecycle::new(Box::new(Broken));
        let instance = INSTANCES.insert(Component { lifecycle, logger, saved: BTreeMap::new() });
        let enter = |c: &mut Component| c.lifecycle.enter_initialization(0.0, None);
        assert_eq!(call(instance, "enter", enter), Status::Ok);
        assert_eq!(call(instance, "exit", |c| c.lifecycle.exit_initialization()), Status::Error);
        assert_eq!(log, "exit: defect in the FMU: start went wrong");
        assert_eq!(fmi3Terminate(instance), Status::Error, "the instance has failed");
        assert_eq!(fmi3Reset(instance), Status::Ok, "and can be reset");
        fmi3FreeInstance(instance);
        assert_eq!(fmi3Reset(instance), Status::Error);
    }
}
