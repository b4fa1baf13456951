//! Handles that cross the C border in place of addresses.
//!
//! An importer may pass any pointer, also one that it has freed. So a handle is a number that is given
//! out once and looked up, never an address that is followed: a wrong one is found out without harm.

use std::collections::BTreeMap;
use std::ffi::c_void;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, PoisonError, RwLock};

/// Distance of two handles: as if they were aligned addresses, should an importer look.
const STRIDE: usize = 16;

static NEXT: AtomicUsize = AtomicUsize::new(STRIDE);

/// A handle that was never given out before; never NULL.
pub fn fresh() -> usize {
    NEXT.fetch_add(STRIDE, Ordering::Relaxed)
}

/// The pointer that the importer receives.
pub fn to_pointer(handle: usize) -> *mut c_void {
    std::ptr::without_provenance_mut(handle)
}

/// Things that importers refer to by handle.
pub struct Registry<T>(RwLock<BTreeMap<usize, Arc<Mutex<T>>>>);

impl<T> Registry<T> {
    /// An empty registry.
    pub const fn new() -> Self {
        Self(RwLock::new(BTreeMap::new()))
    }

    /// Keeps `thing` and returns its handle.
    pub fn insert(&self, thing: T) -> *mut c_void {
        let handle = fresh();
        // A poisoned lock means a panic between two map operations, each of which is whole or not at all.
        self.0.write().unwrap_or_else(PoisonError::into_inner).insert(handle, Arc::new(Mutex::new(thing)));
        to_pointer(handle)
    }

    /// The value of a handle, if this registry has issued it and it is not removed.
    pub fn get(&self, pointer: *mut c_void) -> Option<Arc<Mutex<T>>> {
        self.0.read().unwrap_or_else(PoisonError::into_inner).get(&pointer.addr()).cloned()
    }

    /// Forgets the thing behind a pointer; whether there was one.
    pub fn remove(&self, pointer: *mut c_void) -> bool {
        self.0.write().unwrap_or_else(PoisonError::into_inner).remove(&pointer.addr()).is_some()
    }
}
