//! Reading and setting variables: numbers and enumerations, and a refusal for every other type.

use super::types::{Boolean, call};
use crate::border::Status;
use crate::border::arguments::{Places, list};
use crate::border::instance::Instance;
use crate::lifecycle::Type;
use std::ffi::{c_char, c_int};

/// `fmi2GetReal`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetReal(c: Instance, vr: *const u32, nvr: usize, value: *mut f64) -> Status {
    call(c, "fmi2GetReal", |component| {
        // SAFETY: NULL or valid, by the importer's obligations in `fmi3`.
        let (references, values) = unsafe { (list("vr", vr, nvr)?, Places::new("value", value, nvr)?) };
        component.lifecycle.get(references, Type::Real, &mut |place, value| values.put(place, value))
    })
}

/// `fmi2GetInteger`, also for enumerations.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2GetInteger(c: Instance, vr: *const u32, nvr: usize, value: *mut c_int) -> Status {
    call(c, "fmi2GetInteger", |component| {
        // SAFETY: NULL or valid, by the importer's obligations in `fmi3`.
        let (references, values) = unsafe { (list("vr", vr, nvr)?, Places::new("value", value, nvr)?) };
        component.lifecycle.get(references, Type::Whole, &mut |place, value| values.put(place, value as c_int))
    })
}

/// `fmi2SetReal`: all values are set or, with an error, none.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SetReal(c: Instance, vr: *const u32, nvr: usize, value: *const f64) -> Status {
    call(c, "fmi2SetReal", |component| {
        // SAFETY: NULL or valid, by the importer's obligations in `fmi3`.
        let (references, values) = unsafe { (list("vr", vr, nvr)?, list("value", value, nvr)?) };
        component.lifecycle.set(references, Type::Real, values)
    })
}

/// `fmi2SetInteger`, also for enumerations.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi2SetInteger(c: Instance, vr: *const u32, nvr: usize, value: *const c_int) -> Status {
    call(c, "fmi2SetInteger", |component| {
        // SAFETY: NULL or valid, by the importer's obligations in `fmi3`.
        let (references, values) = unsafe { (list("vr", vr, nvr)?, list("value", value, nvr)?) };
        let values: Vec<f64> = values.iter().map(|value| f64::from(*value)).collect();
        component.lifecycle.set(references, Type::Whole, &values)
    })
}

/// Functions for types that no variable has: correct only for an empty list.
macro_rules! other_types {
    ($($function:ident($value:ty), $word:literal;)*) => {$(
        #[doc = concat!("`", stringify!($function), "`: no variable has this type.")]
        #[unsafe(no_mangle)]
        pub unsafe extern "C" fn $function(c: Instance, vr: *const u32, nvr: usize, _value: $value) -> Status {
            call(c, stringify!($function), |component| {
                // SAFETY: NULL or valid, by the importer's obligations in `fmi3`.
                let references = unsafe { list("vr", vr, nvr) }?;
                component.lifecycle.expect(references, Type::Other($word))
            })
        }
    )*};
}

other_types! {
    fmi2GetBoolean(*mut Boolean), "a Boolean";
    fmi2GetString(*mut *const c_char), "a string";
    fmi2SetBoolean(*const Boolean), "a Boolean";
    fmi2SetString(*const *const c_char), "a string";
}
