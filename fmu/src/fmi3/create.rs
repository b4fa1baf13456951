//! Making and freeing instances, version, debug logging.

use super::arguments::{list, text};
use super::instance::{Component, INSTANCES, call, words};
use super::logger::Logger;
use super::types::{Boolean, Environment, Instance, IntermediateUpdate, LogMessage, Status};
use crate::lifecycle::{Lifecycle, Refusal};
use crate::model::Model;
use std::collections::BTreeMap;
use std::ffi::{CStr, c_char, c_void};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::ptr::null_mut;

/// `fmi3GetVersion`.
#[unsafe(no_mangle)]
pub extern "C" fn fmi3GetVersion() -> *const c_char {
    c"3.0".as_ptr()
}

/// `fmi3InstantiateCoSimulation`: NULL, with a message, where the FMU cannot be made.
#[unsafe(no_mangle)]
#[allow(clippy::too_many_arguments)]
pub unsafe extern "C" fn fmi3InstantiateCoSimulation(
    instanceName: *const c_char,
    instantiationToken: *const c_char,
    resourcePath: *const c_char,
    _visible: Boolean,
    loggingOn: Boolean,
    eventModeUsed: Boolean,
    _earlyReturnAllowed: Boolean,
    _requiredIntermediateVariables: *const u32,
    nRequiredIntermediateVariables: usize,
    instanceEnvironment: Environment,
    logMessage: LogMessage,
    _intermediateUpdate: IntermediateUpdate,
) -> Instance {
    const NAME: &str = "fmi3InstantiateCoSimulation";
    let logger = Logger::new(logMessage, instanceEnvironment, loggingOn != 0);
    if eventModeUsed != 0 {
        logger.error(&format!("{NAME}: eventModeUsed must be false, the FMU has no event mode"));
        return null_mut();
    }
    if nRequiredIntermediateVariables > 0 {
        logger.warning(&format!("{NAME}: the FMU offers no intermediate updates and will not call back"));
    }
    // SAFETY: NULL or texts, by the promise of the border.
    let [name, token, resources] = unsafe { [text(instanceName), text(instantiationToken), text(resourcePath)] };
    match catch_unwind(AssertUnwindSafe(|| load(name, token, resources))) {
        Ok(Ok(model)) => {
            let lifecycle = Lifecycle::new(model);
            INSTANCES.insert(Component { lifecycle, logger, saved: BTreeMap::new() })
        }
        Ok(Err(reason)) => {
            logger.error(&format!("{NAME}: {reason}"));
            null_mut()
        }
        Err(panic) => {
            logger.error(&format!("{NAME}: defect in the FMU: {}", words(&*panic)));
            null_mut()
        }
    }
}

fn load(name: Option<&CStr>, token: Option<&CStr>, resources: Option<&CStr>) -> Result<Box<dyn Model>, String> {
    if name.is_none_or(CStr::is_empty) {
        return Err("instanceName is NULL or empty".into());
    }
    let token = token.ok_or("instantiationToken is NULL")?.to_string_lossy();
    let folder = crate::resources::folder(resources)?;
    let model = crate::load(&folder)?;
    let expected = model.description().fmi3_token().map_err(|error| error.to_string())?;
    if *token == expected {
        return Ok(model);
    }
    Err(format!(
        "the instantiation token `{token}` does not belong to the model in `{}`, whose token is `{expected}`: \
         modelDescription.xml and the resources are not from the same export, or the library is another version",
        folder.display()
    ))
}

/// `fmi3InstantiateModelExchange`: NULL with a message, the FMU is for co-simulation.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3InstantiateModelExchange(
    _instanceName: *const c_char,
    _instantiationToken: *const c_char,
    _resourcePath: *const c_char,
    _visible: Boolean,
    loggingOn: Boolean,
    instanceEnvironment: Environment,
    logMessage: LogMessage,
) -> Instance {
    let logger = Logger::new(logMessage, instanceEnvironment, loggingOn != 0);
    logger.error("fmi3InstantiateModelExchange: the FMU offers co-simulation only");
    null_mut()
}

/// `fmi3InstantiateScheduledExecution`: NULL with a message, the FMU is for co-simulation.
#[unsafe(no_mangle)]
#[allow(clippy::too_many_arguments)]
pub unsafe extern "C" fn fmi3InstantiateScheduledExecution(
    _instanceName: *const c_char,
    _instantiationToken: *const c_char,
    _resourcePath: *const c_char,
    _visible: Boolean,
    loggingOn: Boolean,
    instanceEnvironment: Environment,
    logMessage: LogMessage,
    _clockUpdate: *const c_void,
    _lockPreemption: *const c_void,
    _unlockPreemption: *const c_void,
) -> Instance {
    let logger = Logger::new(logMessage, instanceEnvironment, loggingOn != 0);
    logger.error("fmi3InstantiateScheduledExecution: the FMU offers co-simulation only");
    null_mut()
}

/// `fmi3FreeInstance`: NULL and instances that are freed already are ignored.
#[unsafe(no_mangle)]
pub extern "C" fn fmi3FreeInstance(instance: Instance) {
    // A model's drop has no code of ours; the guard is for the promise that no panic crosses.
    let _ = catch_unwind(AssertUnwindSafe(|| INSTANCES.remove(instance)));
}

/// `fmi3SetDebugLogging`: without categories, all of them.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3SetDebugLogging(
    instance: Instance,
    loggingOn: Boolean,
    nCategories: usize,
    categories: *const *const c_char,
) -> Status {
    call(instance, "fmi3SetDebugLogging", |component| {
        // SAFETY: NULL or valid, by the promise of the border.
        let pointers = unsafe { list("categories", categories, nCategories) }?;
        let mut names = Vec::with_capacity(pointers.len());
        for pointer in pointers {
            // SAFETY: NULL or a text, by the promise of the border.
            let name = unsafe { text(*pointer) }.ok_or(Refusal::Pointer("categories[i]"))?;
            names.push(name.to_str().map_err(|_| Refusal::Text("categories[i]"))?);
        }
        component.logger.configure(loggingOn != 0, &names).map_err(Refusal::Unsupported)
    })
}
