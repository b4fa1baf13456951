//! Saving and restoring the state of an instance, and directional derivatives.

use super::types::call;
use crate::border::Status;
use crate::border::arguments::{Places, list};
use crate::border::instance::Instance;
use crate::border::state::{self, SavedState};
use crate::lifecycle::Direction;

/// `fmi2GetFMUstate`: a new state where `*FMUstate` is NULL, else the state there is overwritten.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetFMUstate(c: Instance, FMUstate: *mut SavedState) -> Status {
    // SAFETY: NULL or valid, by the importer's obligations in `fmi3`.
    call(c, "fmi2GetFMUstate", |component| unsafe { state::save(component, FMUstate) })
}

/// `fmi2SetFMUstate`.
#[unsafe(no_mangle)]
pub extern "C" fn fmi2SetFMUstate(c: Instance, FMUstate: SavedState) -> Status {
    call(c, "fmi2SetFMUstate", |component| state::restore(component, FMUstate))
}

/// `fmi2FreeFMUstate`: sets `*FMUstate` to NULL; a NULL state is ignored.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2FreeFMUstate(c: Instance, FMUstate: *mut SavedState) -> Status {
    // SAFETY: NULL or valid, by the importer's obligations in `fmi3`.
    call(c, "fmi2FreeFMUstate", |component| unsafe { state::free(component, FMUstate) })
}

/// `fmi2SerializedFMUstateSize`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SerializedFMUstateSize(c: Instance, FMUstate: SavedState, size: *mut usize) -> Status {
    // SAFETY: NULL or valid, by the importer's obligations in `fmi3`.
    call(c, "fmi2SerializedFMUstateSize", |component| unsafe { state::serialised_size(component, FMUstate, size) })
}

/// `fmi2SerializeFMUstate`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SerializeFMUstate(
    c: Instance,
    FMUstate: SavedState,
    serializedState: *mut u8,
    size: usize,
) -> Status {
    // SAFETY: NULL or valid, by the importer's obligations in `fmi3`.
    call(c, "fmi2SerializeFMUstate", |component| unsafe {
        state::serialise(component, FMUstate, serializedState, size)
    })
}

/// `fmi2DeSerializeFMUstate`: also of a state that another process has written.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2DeSerializeFMUstate(
    c: Instance,
    serializedState: *const u8,
    size: usize,
    FMUstate: *mut SavedState,
) -> Status {
    // SAFETY: NULL or valid, by the importer's obligations in `fmi3`.
    call(c, "fmi2DeSerializeFMUstate", |component| unsafe {
        state::deserialise(component, serializedState, size, FMUstate)
    })
}

/// `fmi2GetDirectionalDerivative`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetDirectionalDerivative(
    c: Instance,
    vUnknown_ref: *const u32,
    nUnknown: usize,
    vKnown_ref: *const u32,
    nKnown: usize,
    dvKnown: *const f64,
    dvUnknown: *mut f64,
) -> Status {
    call(c, "fmi2GetDirectionalDerivative", |component| {
        // SAFETY: NULL or valid, by the importer's obligations in `fmi3`.
        let (unknowns, knowns, seed, places) = unsafe {
            (
                list("vUnknown_ref", vUnknown_ref, nUnknown)?,
                list("vKnown_ref", vKnown_ref, nKnown)?,
                list("dvKnown", dvKnown, nKnown)?,
                Places::new("dvUnknown", dvUnknown, nUnknown)?,
            )
        };
        let mut result = vec![0.0; nUnknown];
        component.lifecycle.partial(Direction::Forward, unknowns, knowns, seed, &mut result)?;
        result.iter().enumerate().for_each(|(place, value)| places.put(place, *value));
        Ok(())
    })
}
