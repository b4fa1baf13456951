//! Macros of Bekker's physics: an attribute for code that runs in SIMD lanes, and derives that write what would otherwise be
//! a list of a struct's fields (to put one rover's numbers into a SIMD lane, to save and load a state, to convert numbers).
//!
//! They are for the crates of this workspace: the code that they write names `bekker_scalar`, and the module `snapshot` of the
//! crate in which it stands.

mod fields;
mod lane_access;
mod lanes;
mod map_scalar;
mod moving;

use proc_macro::TokenStream;
use syn::{DeriveInput, parse_macro_input};

/// Marks code that must be inlined to run in SIMD lanes: a function, all functions of an `impl`, or the default functions of a
/// trait, each with the closures in it.
///
/// Eight rovers are stepped at once with the instructions that this processor has (`Scalar::wide`). The compiler uses these
/// instructions only in code that it inlines into the function with those target features, so all that `Scalar::wide` calls,
/// directly or not, is marked. A single rover is faster when inlined, too; so the feature `inlined`, which `batch` implies, turns
/// the mark into `inline(always)`. Without that feature the attribute has no effect: the library of an FMU is built so, because
/// it must be small.
///
/// `#[lanes(entry)]` is for a function that calls `Scalar::wide` itself: the closures in it are marked, and the function is
/// compiled once for each number and never inlined into its callers.
/// In a marked `impl`, a function that has this attribute or `inline` of its own is not marked again.
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
