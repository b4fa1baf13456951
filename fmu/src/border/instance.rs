//! An instance behind its handle, and the guard under which every call runs.

use super::Status;
use super::arguments::{list, text};
use super::logger::Logger;
use crate::handles::Registry;
use crate::lifecycle::{Lifecycle, Refusal};
use crate::model::FmuModel;
use std::any::Any;
use std::collections::BTreeMap;
use std::ffi::{c_char, c_void};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::ptr::null_mut;

/// The handle that the importer holds.
pub type Instance = *mut c_void;

/// One instance; `X` is what a version of the standard keeps besides.
pub(crate) struct Component<X> {
    pub(crate) lifecycle: Lifecycle,
    pub(crate) logger: Logger,
    /// Saved states by handle; they belong to the instance and are freed with it.
    pub(crate) saved: BTreeMap<usize, Lifecycle>,
    pub(crate) own: X,
}

/// Runs `body` on the instance: a refusal is logged with the function's name and becomes an error, and
/// so does a panic, after which the instance is failed. An unknown or freed instance is an error without
/// a message, since no logger is known.
pub(crate) fn call<X, R: Into<Status>>(
    instances: &Registry<Component<X>>,
    instance: Instance,
    function: &str,
    body: impl FnOnce(&mut Component<X>) -> Result<R, Refusal>,
) -> Status {
    // The outer guard is for what is left: locks, handles, the making of a message.
    catch_unwind(AssertUnwindSafe(|| guarded(instances, instance, function, body))).unwrap_or(Status::Error)
}

fn guarded<X, R: Into<Status>>(
    instances: &Registry<Component<X>>,
    instance: Instance,
    function: &str,
    body: impl FnOnce(&mut Component<X>) -> Result<R, Refusal>,
) -> Status {
    let Some(shared) = instances.get(instance) else { return Status::Error };
    // The standard forbids a call while another one runs on the instance, be it from a second thread or
    // from inside a callback. Waiting could hang the importer.
    let Ok(mut component) = shared.try_lock() else { return Status::Error };
    let component = &mut *component;
    match catch_unwind(AssertUnwindSafe(|| body(component))) {
        Ok(Ok(reply)) => reply.into(),
        Ok(Err(refusal)) => {
            let discarded = matches!(refusal, Refusal::Discarded(_) | Refusal::Long { .. });
            let status = if discarded { Status::Discard } else { Status::Error };
            component.logger.refused(status, &format!("{function}: {refusal}"));
            status
        }
        Err(panic) => {
            component.lifecycle.fail();
            component.logger.error(&format!("{function}: defect in the FMU: {}", words(&*panic)));
            Status::Error
        }
    }
}

/// Makes an instance of the model that `load` finds: NULL, with a message, where that fails.
pub(crate) fn create<X>(
    instances: &Registry<Component<X>>,
    function: &str,
    logger: Logger,
    own: X,
    load: impl FnOnce() -> Result<Box<dyn FmuModel>, String>,
    begin: impl FnOnce(Box<dyn FmuModel>) -> Result<Lifecycle, Refusal>,
) -> Instance {
    let made = catch_unwind(AssertUnwindSafe(|| begin(load()?).map_err(|refusal| refusal.to_string())));
    let reason = match made {
        Ok(Ok(lifecycle)) => {
            return instances.insert(Component { lifecycle, logger, saved: BTreeMap::new(), own });
        }
        Ok(Err(reason)) => reason,
        Err(panic) => format!("defect in the FMU: {}", words(&*panic)),
    };
    let _ = catch_unwind(AssertUnwindSafe(|| logger.error(&format!("{function}: {reason}"))));
    null_mut()
}

/// Frees an instance; NULL and instances that are freed already are ignored.
pub(crate) fn free<X>(instances: &Registry<Component<X>>, instance: Instance) {
    // No panic may cross the C interface, also not from the destructor of a model.
    let _ = catch_unwind(AssertUnwindSafe(|| instances.remove(instance)));
}

/// Turns debug logging on or off.
///
/// # Safety
/// `categories` is NULL or valid for `count` pointers, each NULL or a text.
pub(crate) unsafe fn configure_logging<X>(
    component: &mut Component<X>,
    on: bool,
    categories: *const *const c_char,
    count: usize,
) -> Result<(), Refusal> {
    // SAFETY: by the safety section above.
    let pointers = unsafe { list("categories", categories, count) }?;
    let mut names = Vec::with_capacity(pointers.len());
    for pointer in pointers {
        // SAFETY: by the safety section above.
        let name = unsafe { text(*pointer) }.ok_or(Refusal::Pointer("categories[i]"))?;
        names.push(name.to_str().map_err(|_| Refusal::Text("categories[i]"))?);
    }
    component.logger.configure(on, &names).map_err(Refusal::Unsupported)
}

/// What a panic said.
fn words(panic: &(dyn Any + Send)) -> &str {
    match (panic.downcast_ref::<&str>(), panic.downcast_ref::<String>()) {
        (Some(words), _) => words,
        (_, Some(words)) => words,
        _ => "unknown",
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::border::logger::Sink;
    use crate::model::{Failure, Outcome};
    use bekker_modeldescription::xml::Description;
    use std::ffi::CStr;
    use std::sync::{Arc, Mutex};

    /// A model of which only reset works.
    struct Broken;

    impl FmuModel for Broken {
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
        fn duplicate(&self) -> Box<dyn FmuModel> {
            Box::new(Self)
        }
    }

    struct Kept(Arc<Mutex<String>>);

    impl Sink for Kept {
        fn send(&self, _: Status, _: &CStr, message: &CStr) {
            self.0.lock().expect("not poisoned").push_str(&message.to_string_lossy());
        }
    }

    #[test]
    fn property_a_panic_stays_inside_and_is_told() {
        static INSTANCES: Registry<Component<()>> = Registry::new();
        let log = Arc::new(Mutex::new(String::new()));
        let logger = Logger::new(Kept(Arc::clone(&log)), false);
        let load = || -> Result<Box<dyn FmuModel>, String> { Ok(Box::new(Broken)) };
        let instance = create(&INSTANCES, "create", logger, (), load, |model| Ok(Lifecycle::new(model)));
        let enter = |c: &mut Component<()>| c.lifecycle.enter_initialization(0.0, None);
        let reset = |c: &mut Component<()>| -> Result<(), Refusal> {
            c.lifecycle.reset();
            Ok(())
        };
        assert_eq!(call(&INSTANCES, instance, "enter", enter), Status::Ok);
        assert_eq!(call(&INSTANCES, instance, "exit", |c| c.lifecycle.exit_initialization()), Status::Error);
        assert_eq!(*log.lock().expect("not poisoned"), "exit: defect in the FMU: start went wrong");
        let end = |c: &mut Component<()>| c.lifecycle.terminate();
        assert_eq!(call(&INSTANCES, instance, "end", end), Status::Error, "the instance has failed");
        assert_eq!(call(&INSTANCES, instance, "reset", reset), Status::Ok, "and can be reset");
        free(&INSTANCES, instance);
        assert_eq!(call(&INSTANCES, instance, "reset", reset), Status::Error);
    }

    #[test]
    fn property_a_panic_while_loading_gives_null_and_a_message() {
        static INSTANCES: Registry<Component<()>> = Registry::new();
        let log = Arc::new(Mutex::new(String::new()));
        let logger = Logger::new(Kept(Arc::clone(&log)), false);
        let load = || -> Result<Box<dyn FmuModel>, String> { panic!("no file") };
        assert!(create(&INSTANCES, "create", logger, (), load, |model| Ok(Lifecycle::new(model))).is_null());
        assert_eq!(*log.lock().expect("not poisoned"), "create: defect in the FMU: no file");
    }
}
