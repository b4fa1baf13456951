//! Initialization, steps, the end.

use super::arguments::Places;
use super::instance::call;
use super::types::{Boolean, Instance, Status};

/// `fmi3EnterInitializationMode`; the tolerance is not used, the integrator's step is fixed.
#[unsafe(no_mangle)]
pub extern "C" fn fmi3EnterInitializationMode(
    instance: Instance,
    _toleranceDefined: Boolean,
    _tolerance: f64,
    startTime: f64,
    stopTimeDefined: Boolean,
    stopTime: f64,
) -> Status {
    call(instance, "fmi3EnterInitializationMode", |component| {
        component.lifecycle.enter_initialization(startTime, (stopTimeDefined != 0).then_some(stopTime))
    })
}

/// `fmi3ExitInitializationMode`.
#[unsafe(no_mangle)]
pub extern "C" fn fmi3ExitInitializationMode(instance: Instance) -> Status {
    call(instance, "fmi3ExitInitializationMode", |component| component.lifecycle.exit_initialization())
}

/// `fmi3DoStep`; where the simulation ends on the way, `terminateSimulation` is true and
/// `lastSuccessfulTime` says when. There is no event handling and no early return.
#[unsafe(no_mangle)]
#[allow(clippy::too_many_arguments)]
pub unsafe extern "C" fn fmi3DoStep(
    instance: Instance,
    currentCommunicationPoint: f64,
    communicationStepSize: f64,
    _noSetFMUStatePriorToCurrentPoint: Boolean,
    eventHandlingNeeded: *mut bool,
    terminateSimulation: *mut bool,
    earlyReturn: *mut bool,
    lastSuccessfulTime: *mut f64,
) -> Status {
    call(instance, "fmi3DoStep", |component| {
        // SAFETY: NULL or valid, by the promise of the border.
        let (event, terminate, early, time) = unsafe {
            (
                Places::new("eventHandlingNeeded", eventHandlingNeeded, 1)?,
                Places::new("terminateSimulation", terminateSimulation, 1)?,
                Places::new("earlyReturn", earlyReturn, 1)?,
                Places::new("lastSuccessfulTime", lastSuccessfulTime, 1)?,
            )
        };
        [&event, &terminate, &early].into_iter().for_each(|flag| flag.put(0, false));
        time.put(0, component.lifecycle.time());
        let progress = component.lifecycle.step(currentCommunicationPoint, communicationStepSize)?;
        time.put(0, progress.time);
        if let Some(reason) = progress.ended {
            terminate.put(0, true);
            component.logger.event(&format!("the simulation ends at {} s: {reason}", progress.time));
        }
        Ok(())
    })
}

/// `fmi3Terminate`.
#[unsafe(no_mangle)]
pub extern "C" fn fmi3Terminate(instance: Instance) -> Status {
    call(instance, "fmi3Terminate", |component| component.lifecycle.terminate())
}

/// `fmi3Reset`.
#[unsafe(no_mangle)]
pub extern "C" fn fmi3Reset(instance: Instance) -> Status {
    call(instance, "fmi3Reset", |component| {
        component.lifecycle.reset();
        Ok(())
    })
}
