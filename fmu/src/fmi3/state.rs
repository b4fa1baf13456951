//! Saving and restoring the state of an instance.

use super::instances::call;
use crate::border::Status;
use crate::border::instance::Instance;
use crate::border::state::{self, SavedState};

/// `fmi3GetFMUState`: a new state where `*FMUState` is NULL, else the state there is overwritten.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3GetFMUState(instance: Instance, FMUState: *mut SavedState) -> Status {
    // SAFETY: NULL or valid, by the importer's obligations in `fmi3`.
    call(instance, "fmi3GetFMUState", |component| unsafe { state::save(component, FMUState) })
}

/// `fmi3SetFMUState`.
#[unsafe(no_mangle)]
pub extern "C" fn fmi3SetFMUState(instance: Instance, FMUState: SavedState) -> Status {
    call(instance, "fmi3SetFMUState", |component| state::restore(component, FMUState))
}

/// `fmi3FreeFMUState`: sets `*FMUState` to NULL; a NULL state is ignored.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3FreeFMUState(instance: Instance, FMUState: *mut SavedState) -> Status {
    // SAFETY: NULL or valid, by the importer's obligations in `fmi3`.
    call(instance, "fmi3FreeFMUState", |component| unsafe { state::free(component, FMUState) })
}

/// `fmi3SerializedFMUStateSize`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3SerializedFMUStateSize(
    instance: Instance,
    FMUState: SavedState,
    size: *mut usize,
) -> Status {
    // SAFETY: NULL or valid, by the importer's obligations in `fmi3`.
    call(instance, "fmi3SerializedFMUStateSize", |component| unsafe {
        state::serialised_size(component, FMUState, size)
    })
}

/// `fmi3SerializeFMUState`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3SerializeFMUState(
    instance: Instance,
    FMUState: SavedState,
    serializedState: *mut u8,
    size: usize,
) -> Status {
    // SAFETY: NULL or valid, by the importer's obligations in `fmi3`.
    call(instance, "fmi3SerializeFMUState", |component| unsafe {
        state::serialise(component, FMUState, serializedState, size)
    })
}

/// `fmi3DeserializeFMUState`: also of a state that another process has written.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3DeserializeFMUState(
    instance: Instance,
    serializedState: *const u8,
    size: usize,
    FMUState: *mut SavedState,
) -> Status {
    // SAFETY: NULL or valid, by the importer's obligations in `fmi3`.
    call(instance, "fmi3DeserializeFMUState", |component| unsafe {
        state::deserialise(component, serializedState, size, FMUState)
    })
}
