//! Model exchange: the importer integrates.

use super::instances::call;
use super::types::Boolean;
use crate::border::Status;
use crate::border::arguments::{Places, list, list_mut};
use crate::border::instance::Instance;

/// `fmi3EnterContinuousTimeMode`.
#[unsafe(no_mangle)]
pub extern "C" fn fmi3EnterContinuousTimeMode(instance: Instance) -> Status {
    call(instance, "fmi3EnterContinuousTimeMode", |component| component.lifecycle.enter_continuous_time())
}

/// `fmi3CompletedIntegratorStep`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3CompletedIntegratorStep(
    instance: Instance,
    _noSetFMUStatePriorToCurrentPoint: Boolean,
    enterEventMode: *mut bool,
    terminateSimulation: *mut bool,
) -> Status {
    call(instance, "fmi3CompletedIntegratorStep", |component| {
        // SAFETY: NULL or valid, by the importer's obligations in `fmi3`.
        let (event, end) = unsafe {
            (
                Places::new("enterEventMode", enterEventMode, 1)?,
                Places::new("terminateSimulation", terminateSimulation, 1)?,
            )
        };
        let outcome = component.lifecycle.completed_step()?;
        event.put(0, outcome.states_changed);
        end.put(0, outcome.terminate.is_some());
        if let Some(reason) = outcome.terminate {
            component.logger.ended(component.lifecycle.time(), &reason);
        }
        Ok(())
    })
}

/// `fmi3SetTime`.
#[unsafe(no_mangle)]
pub extern "C" fn fmi3SetTime(instance: Instance, time: f64) -> Status {
    call(instance, "fmi3SetTime", |component| component.lifecycle.set_time(time))
}

/// `fmi3SetContinuousStates`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3SetContinuousStates(
    instance: Instance,
    continuousStates: *const f64,
    nContinuousStates: usize,
) -> Status {
    call(instance, "fmi3SetContinuousStates", |component| {
        // SAFETY: NULL or valid, by the importer's obligations in `fmi3`.
        let states = unsafe { list("continuousStates", continuousStates, nContinuousStates) }?;
        component.lifecycle.set_states(states)
    })
}

macro_rules! vectors {
    ($($(#[$doc:meta])* $function:ident($argument:ident, $count:ident) = $method:ident;)*) => {$(
        $(#[$doc])*
        #[unsafe(no_mangle)]
        pub unsafe extern "C" fn $function(instance: Instance, $argument: *mut f64, $count: usize) -> Status {
            call(instance, stringify!($function), |component| {
                // SAFETY: NULL or valid, by the importer's obligations in `fmi3`.
                let places = unsafe { list_mut(stringify!($argument), $argument, $count) }?;
                component.lifecycle.$method(places)
            })
        }
    )*};
}

vectors! {
    /// `fmi3GetContinuousStates`.
    fmi3GetContinuousStates(continuousStates, nContinuousStates) = states;
    /// `fmi3GetContinuousStateDerivatives`: discarded where the equations have no value.
    fmi3GetContinuousStateDerivatives(derivatives, nContinuousStates) = state_derivatives;
    /// `fmi3GetNominalsOfContinuousStates`.
    fmi3GetNominalsOfContinuousStates(nominals, nContinuousStates) = nominals;
    /// `fmi3GetEventIndicators`: discarded where the equations have no value.
    fmi3GetEventIndicators(eventIndicators, nEventIndicators) = event_indicators;
}

/// `fmi3GetNumberOfEventIndicators`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3GetNumberOfEventIndicators(instance: Instance, nEventIndicators: *mut usize) -> Status {
    call(instance, "fmi3GetNumberOfEventIndicators", |component| {
        // SAFETY: NULL or valid, by the importer's obligations in `fmi3`.
        let place = unsafe { Places::new("nEventIndicators", nEventIndicators, 1) }?;
        place.put(0, component.lifecycle.sizes()?.1);
        Ok(())
    })
}

/// `fmi3GetNumberOfContinuousStates`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3GetNumberOfContinuousStates(instance: Instance, nContinuousStates: *mut usize) -> Status {
    call(instance, "fmi3GetNumberOfContinuousStates", |component| {
        // SAFETY: NULL or valid, by the importer's obligations in `fmi3`.
        let place = unsafe { Places::new("nContinuousStates", nContinuousStates, 1) }?;
        place.put(0, component.lifecycle.sizes()?.0);
        Ok(())
    })
}
