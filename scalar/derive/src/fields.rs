//! What the derives read of a struct.

use syn::{Data, DeriveInput, Error, Field, Fields, Ident, Result, TypeParam};

/// The named fields of a struct.
pub fn named(input: &DeriveInput) -> Result<Vec<&Field>> {
    match &input.data {
        Data::Struct(data) => match &data.fields {
            Fields::Named(fields) => Ok(fields.named.iter().collect()),
            _ => Err(Error::new_spanned(input, "a struct with named fields is expected")),
        },
        _ => Err(Error::new_spanned(input, "a struct is expected, not an enumeration or a union")),
    }
}

/// The names of the fields that move: those that are not under `#[not_moving]`.
pub fn moving(input: &DeriveInput) -> Result<Vec<&Ident>> {
    let fields = named(input)?.into_iter();
    let moves = |field: &&Field| !field.attrs.iter().any(|attribute| attribute.path().is_ident("not_moving"));
    Ok(fields.filter(moves).filter_map(|field| field.ident.as_ref()).collect())
}

/// The type parameter of a struct over one scalar; none where it has no parameter.
pub fn scalar(input: &DeriveInput) -> Result<Option<&TypeParam>> {
    let mut parameters = input.generics.type_params();
    let first = parameters.next();
    if let Some(second) = parameters.next() {
        return Err(Error::new_spanned(second, "at most one type parameter, the scalar, is expected"));
    }
    Ok(first)
}
