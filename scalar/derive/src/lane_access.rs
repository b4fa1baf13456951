//! [`LaneAccess`](crate::LaneAccess).

use crate::fields;
use proc_macro2::TokenStream;
use quote::quote;
use syn::{DeriveInput, Error, Result};

pub fn expand(input: &DeriveInput) -> Result<TokenStream> {
    let name = &input.ident;
    if fields::scalar(input)?.is_none() {
        return Err(Error::new_spanned(name, "a struct over a scalar is expected"));
    }
    let moving = fields::moving(input)?;
    Ok(quote! {
        #[cfg(feature = "batch")]
        impl<A: ::bekker_scalar::Arch> ::bekker_scalar::LaneAccess<#name<f64>> for #name<::bekker_scalar::Lanes<A>> {
            fn put_in(&mut self, k: usize, one: &#name<f64>) {
                #(::bekker_scalar::LaneAccess::put_in(&mut self.#moving, k, &one.#moving);)*
            }

            fn take_out(&self, k: usize, one: &mut #name<f64>) {
                #(::bekker_scalar::LaneAccess::take_out(&self.#moving, k, &mut one.#moving);)*
            }
        }
    })
}
