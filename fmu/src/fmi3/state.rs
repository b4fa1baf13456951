//! Saving and restoring the state of an instance.

use super::arguments::Places;
use super::instance::call;
use super::types::{FmuState, Instance, Status};
use crate::handles::{fresh, to_pointer};
use crate::lifecycle::Refusal;

/// `fmi3GetFMUState`: a new state where `*FMUState` is NULL, else the state there is overwritten.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3GetFMUState(instance: Instance, FMUState: *mut FmuState) -> Status {
    call(instance, "fmi3GetFMUState", |component| {
        // SAFETY: NULL or valid, by the promise of the border.
        let place = unsafe { Places::new("FMUState", FMUState, 1) }?;
        let state = place.first();
        if state.is_null() {
            let handle = fresh();
            component.saved.insert(handle, component.lifecycle.clone());
            place.put(0, to_pointer(handle));
        } else {
            let now = component.lifecycle.clone();
            *component.saved.get_mut(&state.addr()).ok_or_else(unknown)? = now;
        }
        Ok(())
    })
}

/// `fmi3SetFMUState`.
#[unsafe(no_mangle)]
pub extern "C" fn fmi3SetFMUState(instance: Instance, FMUState: FmuState) -> Status {
    call(instance, "fmi3SetFMUState", |component| {
        component.lifecycle = component.saved.get(&FMUState.addr()).ok_or_else(unknown)?.clone();
        Ok(())
    })
}

/// `fmi3FreeFMUState`: sets `*FMUState` to NULL; a NULL state is ignored.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3FreeFMUState(instance: Instance, FMUState: *mut FmuState) -> Status {
    call(instance, "fmi3FreeFMUState", |component| {
        if FMUState.is_null() {
            return Ok(());
        }
        // SAFETY: valid, by the promise of the border.
        let place = unsafe { Places::new("FMUState", FMUState, 1) }?;
        let state = place.first();
        if !state.is_null() {
            component.saved.remove(&state.addr()).ok_or_else(unknown)?;
            place.put(0, std::ptr::null_mut());
        }
        Ok(())
    })
}

fn unknown() -> Refusal {
    Refusal::Unsupported("FMUState is NULL, freed, or not a state of this instance".into())
}
