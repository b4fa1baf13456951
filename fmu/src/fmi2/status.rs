//! How the last communication step went.

use super::types::{Boolean, Last, call};
use crate::border::Status;
use crate::border::arguments::Places;
use crate::border::instance::{Component, Instance};
use crate::lifecycle::Refusal;
use std::ffi::{c_char, c_int};

/// `fmi2DoStepStatus` of `fmi2StatusKind`.
const DO_STEP_STATUS: c_int = 0;
/// `fmi2PendingStatus`.
const PENDING_STATUS: c_int = 1;
/// `fmi2LastSuccessfulTime`.
const LAST_SUCCESSFUL_TIME: c_int = 2;
/// `fmi2Terminated`.
const TERMINATED: c_int = 3;

fn answer<T: Copy>(
    c: Instance,
    function: &str,
    (kind, known): (c_int, c_int),
    value: *mut T,
    read: impl FnOnce(&Component<Last>) -> T,
) -> Status {
    call(c, function, |component| {
        if kind != known {
            return Err(Refusal::Unsupported(format!("the status kind {kind} is not one of this function's")));
        }
        // SAFETY: NULL or valid, by the importer's obligations in `fmi3`.
        let place = unsafe { Places::new("value", value, 1) }?;
        place.put(0, read(component));
        Ok(())
    })
}

/// `fmi2GetStatus`: how `fmi2DoStep` went.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetStatus(c: Instance, s: c_int, value: *mut Status) -> Status {
    answer(c, "fmi2GetStatus", (s, DO_STEP_STATUS), value, |component| component.own.status)
}

/// `fmi2GetRealStatus`: the time that was reached.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetRealStatus(c: Instance, s: c_int, value: *mut f64) -> Status {
    answer(c, "fmi2GetRealStatus", (s, LAST_SUCCESSFUL_TIME), value, |component| component.lifecycle.time())
}

/// `fmi2GetBooleanStatus`: whether the simulation has ended.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetBooleanStatus(c: Instance, s: c_int, value: *mut Boolean) -> Status {
    answer(c, "fmi2GetBooleanStatus", (s, TERMINATED), value, |component| component.lifecycle.ended().is_some().into())
}

/// `fmi2GetIntegerStatus`: the standard has no status that is an integer.
#[unsafe(no_mangle)]
pub extern "C" fn fmi2GetIntegerStatus(c: Instance, s: c_int, _value: *mut c_int) -> Status {
    call(c, "fmi2GetIntegerStatus", |_| -> Result<(), Refusal> {
        Err(Refusal::Unsupported(format!("the status kind {s} is not an integer")))
    })
}

/// `fmi2GetStringStatus`: says that no step is pending, as steps are not asynchronous.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetStringStatus(c: Instance, s: c_int, value: *mut *const c_char) -> Status {
    answer(c, "fmi2GetStringStatus", (s, PENDING_STATUS), value, |_| c"no step is pending".as_ptr())
}
