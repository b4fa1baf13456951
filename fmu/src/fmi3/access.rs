//! Reading and setting variables: numbers, integers and enumerations, and a refusal for every other type.

use super::instances::call;
use super::types::Boolean;
use crate::border::Status;
use crate::border::arguments::{Places, list};
use crate::border::instance::Instance;
use crate::lifecycle::{Lifecycle, Refusal, Type};
use std::borrow::Cow;
use std::ffi::{c_char, c_void};

/// `fmi3GetFloat64`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3GetFloat64(
    instance: Instance,
    valueReferences: *const u32,
    nValueReferences: usize,
    values: *mut f64,
    nValues: usize,
) -> Status {
    call(instance, "fmi3GetFloat64", |component| {
        // SAFETY: NULL or valid, by the importer's obligations in `fmi3`.
        let (references, values) =
            unsafe { read(&component.lifecycle, valueReferences, nValueReferences, values, nValues) }?;
        component.lifecycle.get(&references, Type::Real, &mut |place, value| values.put(place, value))
    })
}

/// `fmi3SetFloat64`: all values are set or, with an error, none.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3SetFloat64(
    instance: Instance,
    valueReferences: *const u32,
    nValueReferences: usize,
    values: *const f64,
    nValues: usize,
) -> Status {
    call(instance, "fmi3SetFloat64", |component| {
        // SAFETY: NULL or valid, by the importer's obligations in `fmi3`.
        let references = unsafe { list("valueReferences", valueReferences, nValueReferences) }?;
        // SAFETY: as above.
        let values = unsafe { list("values", values, nValues) }?;
        let references = component.lifecycle.elements(references)?;
        component.lifecycle.set(&references, Type::Real, values)
    })
}

/// Functions that read and set integers of one size.
macro_rules! integers {
    ($($get:ident, $set:ident, $number:ty = $type:expr, $about:literal;)*) => {$(
        #[doc = concat!("`", stringify!($get), "`, for ", $about, ".")]
        #[unsafe(no_mangle)]
        pub unsafe extern "C" fn $get(
            instance: Instance,
            valueReferences: *const u32,
            nValueReferences: usize,
            values: *mut $number,
            nValues: usize,
        ) -> Status {
            call(instance, stringify!($get), |component| {
                // SAFETY: NULL or valid, by the importer's obligations in `fmi3`.
                let (references, values) =
                    unsafe { read(&component.lifecycle, valueReferences, nValueReferences, values, nValues) }?;
                component.lifecycle.get(&references, $type, &mut |place, value| values.put(place, value as $number))
            })
        }

        #[doc = concat!("`", stringify!($set), "`, for ", $about, ".")]
        #[unsafe(no_mangle)]
        pub unsafe extern "C" fn $set(
            instance: Instance,
            valueReferences: *const u32,
            nValueReferences: usize,
            values: *const $number,
            nValues: usize,
        ) -> Status {
            call(instance, stringify!($set), |component| {
                // SAFETY: NULL or valid, by the importer's obligations in `fmi3`.
                let references = unsafe { list("valueReferences", valueReferences, nValueReferences) }?;
                // SAFETY: as above.
                let values = unsafe { list("values", values, nValues) }?;
                let values: Vec<f64> = values.iter().map(|value| *value as f64).collect();
                let references = component.lifecycle.elements(references)?;
                component.lifecycle.set(&references, $type, &values)
            })
        }
    )*};
}

integers! {
    fmi3GetInt32, fmi3SetInt32, i32 = Type::Integer, "integers";
    fmi3GetInt64, fmi3SetInt64, i64 = Type::Enumeration, "enumerations";
}

/// References of entries, those of arrays by element, and places for as many values.
unsafe fn read<'a, T: Copy>(
    lifecycle: &Lifecycle,
    references: *const u32,
    count: usize,
    values: *mut T,
    places_given: usize,
) -> Result<(Cow<'a, [u32]>, Places<T>), Refusal> {
    // SAFETY: NULL or valid, by the importer's obligations in `fmi3`.
    let references = lifecycle.elements(unsafe { list("valueReferences", references, count) }?)?;
    if references.len() != places_given {
        return Err(Refusal::Length { references: references.len(), values: places_given });
    }
    // SAFETY: as above.
    let places = unsafe { Places::new("values", values, places_given) }?;
    Ok((references, places))
}

/// Functions for types that no variable has: correct only for an empty list.
macro_rules! other_types {
    ($($function:ident($($argument:ident: $type:ty),*), $word:literal;)*) => {$(
        #[doc = concat!("`", stringify!($function), "`: no variable has this type.")]
        #[unsafe(no_mangle)]
        pub unsafe extern "C" fn $function(
            instance: Instance,
            valueReferences: *const u32,
            nValueReferences: usize,
            $($argument: $type),*
        ) -> Status {
            let _ = ($($argument,)*);
            call(instance, stringify!($function), |component| {
                // SAFETY: NULL or valid, by the importer's obligations in `fmi3`.
                let references = unsafe { list("valueReferences", valueReferences, nValueReferences) }?;
                component.lifecycle.expect(references, Type::Other($word))
            })
        }
    )*};
}

other_types! {
    fmi3GetFloat32(values: *mut f32, nValues: usize), "a 32 bit floating point number";
    fmi3GetInt8(values: *mut i8, nValues: usize), "an 8 bit integer";
    fmi3GetUInt8(values: *mut u8, nValues: usize), "an unsigned 8 bit integer";
    fmi3GetInt16(values: *mut i16, nValues: usize), "a 16 bit integer";
    fmi3GetUInt16(values: *mut u16, nValues: usize), "an unsigned 16 bit integer";
    fmi3GetUInt32(values: *mut u32, nValues: usize), "an unsigned 32 bit integer";
    fmi3GetUInt64(values: *mut u64, nValues: usize), "an unsigned 64 bit integer";
    fmi3GetBoolean(values: *mut Boolean, nValues: usize), "a Boolean";
    fmi3GetString(values: *mut *const c_char, nValues: usize), "a string";
    fmi3GetBinary(valueSizes: *mut usize, values: *mut *const u8, nValues: usize), "binary";
    fmi3GetClock(values: *mut Boolean), "a clock";
    fmi3SetFloat32(values: *const f32, nValues: usize), "a 32 bit floating point number";
    fmi3SetInt8(values: *const i8, nValues: usize), "an 8 bit integer";
    fmi3SetUInt8(values: *const u8, nValues: usize), "an unsigned 8 bit integer";
    fmi3SetInt16(values: *const i16, nValues: usize), "a 16 bit integer";
    fmi3SetUInt16(values: *const u16, nValues: usize), "an unsigned 16 bit integer";
    fmi3SetUInt32(values: *const u32, nValues: usize), "an unsigned 32 bit integer";
    fmi3SetUInt64(values: *const u64, nValues: usize), "an unsigned 64 bit integer";
    fmi3SetBoolean(values: *const Boolean, nValues: usize), "a Boolean";
    fmi3SetString(values: *const *const c_char, nValues: usize), "a string";
    fmi3SetBinary(valueSizes: *const usize, values: *const *const u8, nValues: usize), "binary";
    fmi3SetClock(values: *const Boolean), "a clock";
    fmi3GetIntervalDecimal(intervals: *mut f64, qualifiers: *mut c_void), "a clock";
    fmi3GetIntervalFraction(counters: *mut u64, resolutions: *mut u64, qualifiers: *mut c_void), "a clock";
    fmi3GetShiftDecimal(shifts: *mut f64), "a clock";
    fmi3GetShiftFraction(counters: *mut u64, resolutions: *mut u64), "a clock";
    fmi3SetIntervalDecimal(intervals: *const f64), "a clock";
    fmi3SetIntervalFraction(counters: *const u64, resolutions: *const u64), "a clock";
    fmi3SetShiftDecimal(shifts: *const f64), "a clock";
    fmi3SetShiftFraction(counters: *const u64, resolutions: *const u64), "a clock";
}
