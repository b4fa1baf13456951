//! Event mode, step mode, discrete states.

use super::instances::call;
use crate::border::Status;
use crate::border::arguments::Places;
use crate::border::instance::Instance;
use crate::lifecycle::{Phase, Refusal};

/// `fmi3EnterEventMode`.
#[unsafe(no_mangle)]
pub extern "C" fn fmi3EnterEventMode(instance: Instance) -> Status {
    call(instance, "fmi3EnterEventMode", |component| component.lifecycle.enter_event_mode())
}

/// `fmi3EnterStepMode`.
#[unsafe(no_mangle)]
pub extern "C" fn fmi3EnterStepMode(instance: Instance) -> Status {
    call(instance, "fmi3EnterStepMode", |component| component.lifecycle.enter_step_mode())
}

/// `fmi3EvaluateDiscreteStates`: nothing to do, values are always up to date when they are read.
#[unsafe(no_mangle)]
pub extern "C" fn fmi3EvaluateDiscreteStates(instance: Instance) -> Status {
    call(instance, "fmi3EvaluateDiscreteStates", |component| match component.lifecycle.phase() {
        Phase::Event | Phase::Initialization => Ok(()),
        phase => Err(Refusal::Order { phase, expected: "`event mode` or `initialization mode`".into() }),
    })
}

/// `fmi3UpdateDiscreteStates`: one call settles an event.
#[unsafe(no_mangle)]
#[allow(clippy::too_many_arguments)]
pub unsafe extern "C" fn fmi3UpdateDiscreteStates(
    instance: Instance,
    discreteStatesNeedUpdate: *mut bool,
    terminateSimulation: *mut bool,
    nominalsOfContinuousStatesChanged: *mut bool,
    valuesOfContinuousStatesChanged: *mut bool,
    nextEventTimeDefined: *mut bool,
    nextEventTime: *mut f64,
) -> Status {
    call(instance, "fmi3UpdateDiscreteStates", |component| {
        // SAFETY: NULL or valid, by the importer's obligations in `fmi3`.
        let (again, end, nominals, values, defined, time) = unsafe {
            (
                Places::new("discreteStatesNeedUpdate", discreteStatesNeedUpdate, 1)?,
                Places::new("terminateSimulation", terminateSimulation, 1)?,
                Places::new("nominalsOfContinuousStatesChanged", nominalsOfContinuousStatesChanged, 1)?,
                Places::new("valuesOfContinuousStatesChanged", valuesOfContinuousStatesChanged, 1)?,
                Places::new("nextEventTimeDefined", nextEventTimeDefined, 1)?,
                Places::new("nextEventTime", nextEventTime, 1)?,
            )
        };
        let outcome = component.lifecycle.update_discrete_states()?;
        again.put(0, false);
        nominals.put(0, false);
        values.put(0, outcome.states_changed);
        end.put(0, outcome.terminate.is_some());
        defined.put(0, outcome.next_time.is_some());
        time.put(0, outcome.next_time.unwrap_or(0.0));
        if let Some(reason) = outcome.terminate {
            component.logger.ended(component.lifecycle.time(), &reason);
        }
        Ok(())
    })
}
