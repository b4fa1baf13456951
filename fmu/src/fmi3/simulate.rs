//! Initialization, steps, the end.

use super::instances::call;
use super::types::{Boolean, Updates};
use crate::border::Status;
use crate::border::arguments::Places;
use crate::border::instance::{Component, Instance};
use crate::lifecycle::{LONGEST, Progress, Refusal};

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

/// `fmi3DoStep`; where the simulation ends on the way, `terminateSimulation` is true and `lastSuccessfulTime` says
/// when. With a callback, it is called after each inner step, and may ask for an early return where the
/// importer allows that. Else a step of more than [`LONGEST`](crate::lifecycle::LONGEST) seconds returns early by itself where
/// the importer allows it, and is discarded where it does not.
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
    let mut begun: Option<Step> = None;
    loop {
        let (mut finished, mut reached) = (true, f64::NAN);
        let status = call(instance, NAME, |component| {
            // SAFETY: NULL or valid until the function returns, by the importer's obligations in `fmi3`.
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
            let step = match &begun {
                Some(step) => step,
                None => begun.insert(Step::begin(component, currentCommunicationPoint, communicationStepSize)?),
            };
            let progress = step.advance(component)?;
            (reached, finished) =
                (progress.time, component.lifecycle.has_reached(step.end) || progress.ended.is_some());
            time.put(0, progress.time);
            early.put(0, finished && progress.ended.is_none() && step.end < step.target);
            let early_by_itself = finished && progress.ended.is_none() && step.updates.callback.is_none();
            if early_by_itself && step.end < step.target {
                component
                    .logger
                    .event(&format!("{NAME}: returns early after {LONGEST} s of {} s", communicationStepSize));
            }
            if let Some(reason) = progress.ended {
                terminate.put(0, true);
                component.logger.ended(progress.time, &reason);
            }
            Ok(())
        });
        let Some(step) = begun.as_mut().filter(|_| status == Status::Ok && !finished) else { return status };
        let status = step.update(instance, reached);
        if status != Status::Ok {
            return status;
        }
    }
}

const NAME: &str = "fmi3DoStep";

/// A communication step on its way. The instance is free between its parts, so that the importer can read and set
/// variables in its callback.
struct Step {
    /// The importer's communication point, seconds since the start.
    target: f64,
    /// Where the step will end: earlier where the importer asks for it.
    end: f64,
    updates: Updates,
}

impl Step {
    fn begin(component: &Component<Updates>, current: f64, size: f64) -> Result<Self, Refusal> {
        let (life, updates) = (&component.lifecycle, component.own);
        let target = life.begin_step(current, size)?;
        let end = match updates {
            Updates { callback: Some(_), early_return: true, .. } => target,
            Updates { early_return: true, .. } => life.in_one_call(target),
            _ => {
                life.not_too_long(target)?;
                target
            }
        };
        Ok(Self { target, end, updates })
    }

    /// On to the end or, with a callback, to the next end of an inner step.
    fn advance(&self, component: &mut Component<Updates>) -> Result<Progress, Refusal> {
        let life = &mut component.lifecycle;
        let point = if self.updates.callback.is_some() { life.next_point(self.end) } else { self.end };
        life.go_to(point)
    }

    /// Calls back, with the instance in the mode in which its variables can be read and inputs set.
    fn update(&mut self, instance: Instance, time: f64) -> Status {
        let updates = self.updates;
        let Some(callback) = updates.callback else { return Status::Ok };
        let status = call(instance, NAME, |component| component.lifecycle.intermediate(true));
        if status != Status::Ok {
            return status;
        }
        let (mut requested, mut until) = (0, time);
        // SAFETY: the importer's function, called on the thread of its own call; both places live until it returns.
        unsafe {
            callback(updates.environment, time, true, true, true, updates.early_return, &mut requested, &mut until);
        }
        call(instance, NAME, |component| {
            component.lifecycle.intermediate(false)?;
            if requested != 0 && updates.early_return {
                self.end = component.lifecycle.since_start(until).clamp(component.lifecycle.elapsed(), self.target);
            }
            Ok(())
        })
    }
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
