//! Saving and restoring the state of an instance, the same in both versions.

use super::arguments::{Places, list, list_mut};
use super::instance::Component;
use crate::handles::{fresh, to_pointer};
use crate::lifecycle::{Lifecycle, Refusal};
use std::ffi::c_void;

/// A handle of a saved state.
pub type SavedState = *mut c_void;

/// Saves: a new state where `*place` is NULL, else the state there is overwritten.
///
/// # Safety
/// As [`Places::new`], for this and the following functions.
pub(crate) unsafe fn save<X>(component: &mut Component<X>, place: *mut SavedState) -> Result<(), Refusal> {
    let now = component.lifecycle.clone();
    // SAFETY: by the safety section above.
    unsafe { keep(component, place, now) }
}

unsafe fn keep<X>(component: &mut Component<X>, place: *mut SavedState, state: Lifecycle) -> Result<(), Refusal> {
    // SAFETY: NULL or valid, by the importer's obligations in `fmi3`.
    let place = unsafe { Places::new("FMUState", place, 1) }?;
    let old = place.first();
    if old.is_null() {
        let handle = fresh();
        component.saved.insert(handle, state);
        place.put(0, to_pointer(handle));
    } else {
        *component.saved.get_mut(&old.addr()).ok_or_else(unknown)? = state;
    }
    Ok(())
}

/// Restores.
pub(crate) fn restore<X>(component: &mut Component<X>, state: SavedState) -> Result<(), Refusal> {
    component.lifecycle = found(component, state)?.clone();
    Ok(())
}

/// Frees and sets `*place` to NULL; a NULL state is ignored.
pub(crate) unsafe fn free<X>(component: &mut Component<X>, place: *mut SavedState) -> Result<(), Refusal> {
    if place.is_null() {
        return Ok(());
    }
    // SAFETY: valid, by the importer's obligations in `fmi3`.
    let place = unsafe { Places::new("FMUState", place, 1) }?;
    let state = place.first();
    if !state.is_null() {
        component.saved.remove(&state.addr()).ok_or_else(unknown)?;
        place.put(0, std::ptr::null_mut());
    }
    Ok(())
}

/// How many bytes [`serialise`] writes.
pub(crate) unsafe fn serialised_size<X>(
    component: &mut Component<X>,
    state: SavedState,
    size: *mut usize,
) -> Result<(), Refusal> {
    // SAFETY: NULL or valid, by the importer's obligations in `fmi3`.
    let place = unsafe { Places::new("size", size, 1) }?;
    place.put(0, found(component, state)?.to_bytes()?.len());
    Ok(())
}

/// Writes a state into `size` bytes.
pub(crate) unsafe fn serialise<X>(
    component: &mut Component<X>,
    state: SavedState,
    bytes: *mut u8,
    size: usize,
) -> Result<(), Refusal> {
    let state = found(component, state)?.to_bytes()?;
    // SAFETY: NULL or valid, by the importer's obligations in `fmi3`.
    let memory = unsafe { list_mut("serializedState", bytes, size) }?;
    let wrong = Refusal::Memory { needed: state.len(), given: size };
    memory.get_mut(..state.len()).ok_or(wrong)?.copy_from_slice(&state);
    Ok(())
}

/// Reads a state back; it becomes a saved one as with [`save`].
pub(crate) unsafe fn deserialise<X>(
    component: &mut Component<X>,
    bytes: *const u8,
    size: usize,
    place: *mut SavedState,
) -> Result<(), Refusal> {
    // SAFETY: NULL or valid, by the importer's obligations in `fmi3`.
    let bytes = unsafe { list("serializedState", bytes, size) }?;
    let state = component.lifecycle.from_bytes(bytes)?;
    // SAFETY: as above.
    unsafe { keep(component, place, state) }
}

fn found<X>(component: &Component<X>, state: SavedState) -> Result<&Lifecycle, Refusal> {
    component.saved.get(&state.addr()).ok_or_else(unknown)
}

fn unknown() -> Refusal {
    Refusal::Unsupported("FMUState is NULL, freed, or not a state of this instance".into())
}
