//! What Bekker's physics says once for all numbers: which code runs in SIMD lanes, which fields of a struct hold a number for
//! each rover, and which of them a saved state needs.
//!
//! These are for the crates of this workspace: what is generated names `bekker_scalar`, and the module `snapshot` of the crate
//! in which it stands.

mod fields;
mod lane_access;
mod lanes;
mod map_scalar;
mod moving;

use proc_macro::TokenStream;
use syn::{DeriveInput, parse_macro_input};

/// Marks physics that runs in SIMD lanes too: a function, all functions of an `impl`, or the bodies that a trait gives.
///
/// Eight rovers are stepped at once with the instructions that this processor has (`Scalar::wide`). The compiler uses them
/// only in what it inlines there, whatever its size; so every function that `Scalar::wide` leads to is marked, with the
/// closures in it. A single rover is faster by it too (feature `inlined`, which `batch` implies); without that feature, as in the
/// library of an FMU, which must be small, the attribute changes nothing.
///
/// `#[lanes(entry)]` marks a function that calls `Scalar::wide` itself: the closures in it, not the function. A function of a
/// marked `impl` that has this attribute, or `inline`, is left to it.
#[proc_macro_attribute]
pub fn lanes(arguments: TokenStream, item: TokenStream) -> TokenStream {
    lanes::expand(arguments.into(), item.into()).unwrap_or_else(syn::Error::into_compile_error).into()
}

/// Implements `LaneAccess`: one rover of those in the lanes is put in and taken out field by field.
///
/// A field under `#[not_moving]` is left as it is.
#[proc_macro_derive(LaneAccess, attributes(not_moving))]
pub fn lane_access(input: TokenStream) -> TokenStream {
    derived(&parse_macro_input!(input as DeriveInput), lane_access::expand)
}

/// Implements `Moving`: the fields are saved and loaded in their order, over `f64` where the struct has a type parameter.
///
/// A field under `#[not_moving]` is not saved: it follows from the model or from fields that are.
#[proc_macro_derive(Moving, attributes(not_moving))]
pub fn moving(input: TokenStream) -> TokenStream {
    derived(&parse_macro_input!(input as DeriveInput), moving::expand)
}

/// Gives a struct over one scalar the method `map`: the same over another scalar, by a function of each number.
#[proc_macro_derive(MapScalar)]
pub fn map_scalar(input: TokenStream) -> TokenStream {
    derived(&parse_macro_input!(input as DeriveInput), map_scalar::expand)
}

fn derived(input: &DeriveInput, expand: fn(&DeriveInput) -> syn::Result<proc_macro2::TokenStream>) -> TokenStream {
    expand(input).unwrap_or_else(syn::Error::into_compile_error).into()
}
