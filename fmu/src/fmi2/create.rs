//! Version, making and freeing instances, debug logging, initialization, the end.

use super::types::{Boolean, Callbacks, INSTANCES, Last, Messages, call};
use crate::border::arguments::text;
use crate::border::instance::{self, Instance};
use crate::border::logger::Logger;
use crate::border::{Status, load};
use crate::lifecycle::Lifecycle;
use crate::resources::path_of_uri;
use std::ffi::{CStr, CString, c_char, c_int};
use std::ptr::null_mut;

/// `fmi2GetTypesPlatform`.
#[unsafe(no_mangle)]
pub extern "C" fn fmi2GetTypesPlatform() -> *const c_char {
    c"default".as_ptr()
}

/// `fmi2GetVersion`.
#[unsafe(no_mangle)]
pub extern "C" fn fmi2GetVersion() -> *const c_char {
    c"2.0".as_ptr()
}

/// `fmi2ModelExchange` of `fmi2Type`.
const MODEL_EXCHANGE: c_int = 0;
/// `fmi2CoSimulation` of `fmi2Type`.
const CO_SIMULATION: c_int = 1;

/// `fmi2Instantiate`: NULL, with a message, where the FMU cannot be made.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2Instantiate(
    instanceName: *const c_char,
    fmuType: c_int,
    fmuGUID: *const c_char,
    fmuResourceLocation: *const c_char,
    functions: *const Callbacks,
    _visible: Boolean,
    loggingOn: Boolean,
) -> Instance {
    const NAME: &str = "fmi2Instantiate";
    // SAFETY: NULL or texts, by the importer's obligations in `fmi3`.
    let [name, guid, resources] = unsafe { [text(instanceName), text(fmuGUID), text(fmuResourceLocation)] };
    // Without callbacks no message is logged; the FMU runs without them.
    let valid = !functions.is_null() && functions.is_aligned();
    // SAFETY: neither NULL nor unaligned; valid by the importer's obligations in `fmi3`.
    let callbacks = valid.then(|| unsafe { *functions });
    let messages = Messages {
        log: callbacks.and_then(|callbacks| callbacks.logger),
        environment: callbacks.map_or(null_mut(), |callbacks| callbacks.environment),
        name: name.map(CStr::to_owned).unwrap_or_default(),
    };
    let logger = Logger::new(messages, loggingOn != 0);
    let own = Last { status: Status::Ok };
    let load = || {
        let path = resources.filter(|uri| !uri.is_empty()).map(path_of_uri).transpose()?;
        let path = path.map(|path| CString::new(path).map_err(|_| "the resource location has a NUL".to_owned()));
        load(name, guid, path.transpose()?.as_deref())
    };
    match fmuType {
        CO_SIMULATION => {
            instance::create(&INSTANCES, NAME, logger, own, load, |model| Ok(Lifecycle::cosimulation(model, false)))
        }
        MODEL_EXCHANGE => instance::create(&INSTANCES, NAME, logger, own, load, Lifecycle::exchange),
        other => {
            logger.error(&format!("{NAME}: the type is {other}, expected 0 (model exchange) or 1 (co-simulation)"));
            null_mut()
        }
    }
}

/// `fmi2FreeInstance`: NULL and instances that are freed already are ignored.
#[unsafe(no_mangle)]
pub extern "C" fn fmi2FreeInstance(c: Instance) {
    instance::free(&INSTANCES, c);
}

/// `fmi2SetDebugLogging`: without categories, all of them.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SetDebugLogging(
    c: Instance,
    loggingOn: Boolean,
    nCategories: usize,
    categories: *const *const c_char,
) -> Status {
    call(c, "fmi2SetDebugLogging", |component| {
        // SAFETY: NULL or valid, by the importer's obligations in `fmi3`.
        unsafe { instance::configure_logging(component, loggingOn != 0, categories, nCategories) }
    })
}

/// `fmi2SetupExperiment`; the tolerance is not used, the integrator's step is fixed.
#[unsafe(no_mangle)]
pub extern "C" fn fmi2SetupExperiment(
    c: Instance,
    _toleranceDefined: Boolean,
    _tolerance: f64,
    startTime: f64,
    stopTimeDefined: Boolean,
    stopTime: f64,
) -> Status {
    call(c, "fmi2SetupExperiment", |component| {
        component.lifecycle.set_up(startTime, (stopTimeDefined != 0).then_some(stopTime))
    })
}

/// `fmi2EnterInitializationMode`.
#[unsafe(no_mangle)]
pub extern "C" fn fmi2EnterInitializationMode(c: Instance) -> Status {
    call(c, "fmi2EnterInitializationMode", |component| component.lifecycle.enter_initialization_as_set_up())
}

/// `fmi2ExitInitializationMode`.
#[unsafe(no_mangle)]
pub extern "C" fn fmi2ExitInitializationMode(c: Instance) -> Status {
    call(c, "fmi2ExitInitializationMode", |component| component.lifecycle.exit_initialization())
}

/// `fmi2Terminate`.
#[unsafe(no_mangle)]
pub extern "C" fn fmi2Terminate(c: Instance) -> Status {
    call(c, "fmi2Terminate", |component| component.lifecycle.terminate())
}

/// `fmi2Reset`.
#[unsafe(no_mangle)]
pub extern "C" fn fmi2Reset(c: Instance) -> Status {
    call(c, "fmi2Reset", |component| {
        component.lifecycle.reset();
        component.own.status = Status::Ok;
        Ok(())
    })
}
