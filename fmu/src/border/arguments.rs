//! Arguments from C, checked.

use crate::lifecycle::Refusal;
use std::ffi::{CStr, c_char};

/// `count` values at `pointer`.
///
/// # Safety
/// `pointer` is NULL or valid for `count` values while the result lives.
pub(crate) unsafe fn list<'a, T>(name: &'static str, pointer: *const T, count: usize) -> Result<&'a [T], Refusal> {
    if count == 0 {
        return Ok(&[]);
    }
    check(name, pointer, count)?;
    // SAFETY: neither NULL nor unaligned nor too long; valid by the safety section above.
    Ok(unsafe { std::slice::from_raw_parts(pointer, count) })
}

/// Places of the importer, written one by one through the pointer: C code may let them overlap.
pub(crate) struct Places<T>(*mut T, usize);

impl<T: Copy> Places<T> {
    /// # Safety
    /// `pointer` is NULL or valid for `count` values while the result lives.
    pub(crate) unsafe fn new(name: &'static str, pointer: *mut T, count: usize) -> Result<Self, Refusal> {
        if count > 0 {
            check(name, pointer, count)?;
        }
        Ok(Self(pointer, count))
    }

    /// Writes a value; `place` is below the count.
    pub(crate) fn put(&self, place: usize, value: T) {
        assert!(place < self.1, "place {place} of {}", self.1);
        // SAFETY: inside the places, which are valid by the promise of `new`.
        unsafe { self.0.add(place).write(value) };
    }

    /// Reads the first value; the count is not 0.
    pub(crate) fn first(&self) -> T {
        assert!(self.1 > 0, "no place");
        // SAFETY: inside the places, which are valid by the promise of `new`.
        unsafe { self.0.read() }
    }
}

/// `count` places of the importer as a slice: for memory that only this call writes.
///
/// # Safety
/// `pointer` is NULL or valid for `count` values, and nothing else reads or writes them while the result lives.
pub(crate) unsafe fn list_mut<'a, T>(
    name: &'static str,
    pointer: *mut T,
    count: usize,
) -> Result<&'a mut [T], Refusal> {
    if count == 0 {
        return Ok(&mut []);
    }
    check(name, pointer, count)?;
    // SAFETY: neither NULL nor unaligned nor too long; valid by the safety section above.
    Ok(unsafe { std::slice::from_raw_parts_mut(pointer, count) })
}

/// The text at `pointer`; `None` for NULL.
///
/// # Safety
/// `pointer` is NULL or a NUL-terminated text that lives as long as the result.
pub(crate) unsafe fn text<'a>(pointer: *const c_char) -> Option<&'a CStr> {
    // SAFETY: not NULL; a text by the safety section above.
    (!pointer.is_null()).then(|| unsafe { CStr::from_ptr(pointer) })
}

fn check<T>(name: &'static str, pointer: *const T, count: usize) -> Result<(), Refusal> {
    let fits = count.checked_mul(size_of::<T>()).is_some_and(|bytes| isize::try_from(bytes).is_ok());
    if pointer.is_null() || !pointer.is_aligned() || !fits { Err(Refusal::Pointer(name)) } else { Ok(()) }
}
