//! Making and freeing instances, version, debug logging.

use super::instances::{INSTANCES, call};
use super::types::{Boolean, Environment, IntermediateUpdate, LogMessage, Messages, Updates};
use crate::border::Status;
use crate::border::arguments::text;
use crate::border::instance::{self, Instance};
use crate::border::load;
use crate::border::logger::Logger;
use crate::lifecycle::Lifecycle;
use std::ffi::{c_char, c_void};
use std::ptr::null_mut;

/// `fmi3GetVersion`.
#[unsafe(no_mangle)]
pub extern "C" fn fmi3GetVersion() -> *const c_char {
    c"3.0".as_ptr()
}

/// `fmi3InstantiateCoSimulation`: NULL, with a message, where the FMU cannot be made. The list of intermediate
/// variables is not needed: every variable can be read, and every input set, in the callback.
#[unsafe(no_mangle)]
#[allow(clippy::too_many_arguments)]
pub unsafe extern "C" fn fmi3InstantiateCoSimulation(
    instanceName: *const c_char,
    instantiationToken: *const c_char,
    resourcePath: *const c_char,
    _visible: Boolean,
    loggingOn: Boolean,
    eventModeUsed: Boolean,
    earlyReturnAllowed: Boolean,
    _requiredIntermediateVariables: *const u32,
    _nRequiredIntermediateVariables: usize,
    instanceEnvironment: Environment,
    logMessage: LogMessage,
    intermediateUpdate: IntermediateUpdate,
) -> Instance {
    let logger = Logger::new(Messages(logMessage, instanceEnvironment), loggingOn != 0);
    let own = Updates {
        callback: intermediateUpdate,
        environment: instanceEnvironment,
        early_return: earlyReturnAllowed != 0,
    };
    // SAFETY: NULL or texts, by the importer's obligations in `fmi3`.
    let [name, token, resources] = unsafe { [text(instanceName), text(instantiationToken), text(resourcePath)] };
    instance::create(
        &INSTANCES,
        "fmi3InstantiateCoSimulation",
        logger,
        own,
        || load(name, token, resources),
        |model| Ok(Lifecycle::cosimulation(model, eventModeUsed != 0)),
    )
}

/// `fmi3InstantiateModelExchange`: NULL, with a message, where the FMU cannot be made, or its model is no system of
/// differential equations.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3InstantiateModelExchange(
    instanceName: *const c_char,
    instantiationToken: *const c_char,
    resourcePath: *const c_char,
    _visible: Boolean,
    loggingOn: Boolean,
    instanceEnvironment: Environment,
    logMessage: LogMessage,
) -> Instance {
    let logger = Logger::new(Messages(logMessage, instanceEnvironment), loggingOn != 0);
    let own = Updates { callback: None, environment: instanceEnvironment, early_return: false };
    // SAFETY: NULL or texts, by the importer's obligations in `fmi3`.
    let [name, token, resources] = unsafe { [text(instanceName), text(instantiationToken), text(resourcePath)] };
    instance::create(
        &INSTANCES,
        "fmi3InstantiateModelExchange",
        logger,
        own,
        || load(name, token, resources),
        Lifecycle::exchange,
    )
}

/// `fmi3InstantiateScheduledExecution`: NULL with a message, the FMU has no clocks to schedule.
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
    let logger = Logger::new(Messages(logMessage, instanceEnvironment), loggingOn != 0);
    logger.error("fmi3InstantiateScheduledExecution: the FMU has no clocks and offers no scheduled execution");
    null_mut()
}

/// `fmi3FreeInstance`: NULL and instances that are freed already are ignored.
#[unsafe(no_mangle)]
pub extern "C" fn fmi3FreeInstance(instance: Instance) {
    instance::free(&INSTANCES, instance);
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
        // SAFETY: NULL or valid, by the importer's obligations in `fmi3`.
        unsafe { instance::configure_logging(component, loggingOn != 0, categories, nCategories) }
    })
}
