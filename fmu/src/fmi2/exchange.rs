//! Model exchange: the importer integrates.

use super::types::{Boolean, EventInfo, call};
use crate::border::Status;
use crate::border::arguments::{Places, list, list_mut};
use crate::border::instance::Instance;

/// `fmi2EnterEventMode`.
#[unsafe(no_mangle)]
pub extern "C" fn fmi2EnterEventMode(c: Instance) -> Status {
    call(c, "fmi2EnterEventMode", |component| component.lifecycle.enter_event_mode())
}

/// `fmi2NewDiscreteStates`: one call settles an event.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2NewDiscreteStates(c: Instance, eventInfo: *mut EventInfo) -> Status {
    call(c, "fmi2NewDiscreteStates", |component| {
        // SAFETY: NULL or valid, by the importer's obligations in `fmi3`.
        let place = unsafe { Places::new("fmi2eventInfo", eventInfo, 1) }?;
        let outcome = component.lifecycle.update_discrete_states()?;
        place.put(
            0,
            EventInfo {
                terminate_simulation: outcome.terminate.is_some().into(),
                values_of_continuous_states_changed: outcome.states_changed.into(),
                next_event_time_defined: outcome.next_time.is_some().into(),
                next_event_time: outcome.next_time.unwrap_or(0.0),
                ..EventInfo::default()
            },
        );
        if let Some(reason) = outcome.terminate {
            component.logger.ended(component.lifecycle.time(), &reason);
        }
        Ok(())
    })
}

/// `fmi2EnterContinuousTimeMode`.
#[unsafe(no_mangle)]
pub extern "C" fn fmi2EnterContinuousTimeMode(c: Instance) -> Status {
    call(c, "fmi2EnterContinuousTimeMode", |component| component.lifecycle.enter_continuous_time())
}

/// `fmi2CompletedIntegratorStep`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2CompletedIntegratorStep(
    c: Instance,
    _noSetFMUStatePriorToCurrentPoint: Boolean,
    enterEventMode: *mut Boolean,
    terminateSimulation: *mut Boolean,
) -> Status {
    call(c, "fmi2CompletedIntegratorStep", |component| {
        // SAFETY: NULL or valid, by the importer's obligations in `fmi3`.
        let (event, end) = unsafe {
            (
                Places::new("enterEventMode", enterEventMode, 1)?,
                Places::new("terminateSimulation", terminateSimulation, 1)?,
            )
        };
        let outcome = component.lifecycle.completed_step()?;
        event.put(0, outcome.states_changed.into());
        end.put(0, outcome.terminate.is_some().into());
        if let Some(reason) = outcome.terminate {
            component.logger.ended(component.lifecycle.time(), &reason);
        }
        Ok(())
    })
}

/// `fmi2SetTime`.
#[unsafe(no_mangle)]
pub extern "C" fn fmi2SetTime(c: Instance, time: f64) -> Status {
    call(c, "fmi2SetTime", |component| component.lifecycle.set_time(time))
}

/// `fmi2SetContinuousStates`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SetContinuousStates(c: Instance, x: *const f64, nx: usize) -> Status {
    call(c, "fmi2SetContinuousStates", |component| {
        // SAFETY: NULL or valid, by the importer's obligations in `fmi3`.
        let states = unsafe { list("x", x, nx) }?;
        component.lifecycle.set_states(states)
    })
}

macro_rules! vectors {
    ($($(#[$doc:meta])* $function:ident($argument:ident, $count:ident) = $method:ident;)*) => {$(
        $(#[$doc])*
        #[unsafe(no_mangle)]
        pub unsafe extern "C" fn $function(c: Instance, $argument: *mut f64, $count: usize) -> Status {
            call(c, stringify!($function), |component| {
                // SAFETY: NULL or valid, by the importer's obligations in `fmi3`.
                let places = unsafe { list_mut(stringify!($argument), $argument, $count) }?;
                component.lifecycle.$method(places)
            })
        }
    )*};
}

vectors! {
    /// `fmi2GetDerivatives`: discarded where the equations have no value.
    fmi2GetDerivatives(derivatives, nx) = state_derivatives;
    /// `fmi2GetEventIndicators`: discarded where the equations have no value.
    fmi2GetEventIndicators(eventIndicators, ni) = event_indicators;
    /// `fmi2GetContinuousStates`.
    fmi2GetContinuousStates(x, nx) = states;
    /// `fmi2GetNominalsOfContinuousStates`.
    fmi2GetNominalsOfContinuousStates(x_nominal, nx) = nominals;
}
