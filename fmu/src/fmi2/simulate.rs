//! Co-simulation: steps, and derivatives of inputs and outputs by time.

use super::types::{Boolean, call};
use crate::border::Status;
use crate::border::arguments::{Places, list};
use crate::border::instance::Instance;
use crate::lifecycle::Refusal;
use std::ffi::c_int;

/// `fmi2DoStep`; a step of more than [`LONGEST`](crate::lifecycle::LONGEST) seconds is discarded, nothing of it is made. Where
/// the simulation ends on the way, the step is discarded, and `fmi2GetRealStatus` and
/// `fmi2GetBooleanStatus` say when and that the FMU wants to end.
#[unsafe(no_mangle)]
pub extern "C" fn fmi2DoStep(
    c: Instance,
    currentCommunicationPoint: f64,
    communicationStepSize: f64,
    _noSetFMUStatePriorToCurrentPoint: Boolean,
) -> Status {
    call(c, "fmi2DoStep", |component| {
        component.own.status = Status::Error;
        let progress = component.lifecycle.step(currentCommunicationPoint, communicationStepSize);
        if matches!(progress, Err(Refusal::Long { .. })) {
            component.own.status = Status::Discard;
        }
        let progress = progress?;
        component.own.status = match &progress.ended {
            None => Status::Ok,
            Some(reason) => {
                component.logger.ended(progress.time, reason);
                Status::Discard
            }
        };
        Ok(component.own.status)
    })
}

/// `fmi2CancelStep`: refused, no step ever is under way when a call is possible.
#[unsafe(no_mangle)]
pub extern "C" fn fmi2CancelStep(c: Instance) -> Status {
    call(c, "fmi2CancelStep", |_| -> Result<(), Refusal> {
        Err(Refusal::Unsupported("no step is under way, steps are not asynchronous (canRunAsynchronuously)".into()))
    })
}

/// `fmi2SetRealInputDerivatives`: of any order, for the next step.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SetRealInputDerivatives(
    c: Instance,
    vr: *const u32,
    nvr: usize,
    order: *const c_int,
    value: *const f64,
) -> Status {
    call(c, "fmi2SetRealInputDerivatives", |component| {
        // SAFETY: NULL or valid, by the importer's obligations in `fmi3`.
        let (references, orders, values) =
            unsafe { (list("vr", vr, nvr)?, list("order", order, nvr)?, list("value", value, nvr)?) };
        component.lifecycle.set_input_derivatives(references, orders, values)
    })
}

/// `fmi2GetRealOutputDerivatives`, of order 1.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetRealOutputDerivatives(
    c: Instance,
    vr: *const u32,
    nvr: usize,
    order: *const c_int,
    value: *mut f64,
) -> Status {
    call(c, "fmi2GetRealOutputDerivatives", |component| {
        // SAFETY: NULL or valid, by the importer's obligations in `fmi3`.
        let (references, orders, values) =
            unsafe { (list("vr", vr, nvr)?, list("order", order, nvr)?, Places::new("value", value, nvr)?) };
        component.lifecycle.output_derivatives(references, orders, &mut |place, value| values.put(place, value))
    })
}
