//! [`Moving`](crate::Moving).

use crate::fields;
use proc_macro2::TokenStream;
use quote::quote;
use syn::{DeriveInput, Result};

pub fn expand(input: &DeriveInput) -> Result<TokenStream> {
    let name = &input.ident;
    let over = fields::scalar(input)?.map(|_| quote!(<f64>));
    let moving = fields::moving(input)?;
    Ok(quote! {
        impl crate::snapshot::Moving for #name #over {
            fn save(&self, to: &mut crate::snapshot::Writer) {
                #(crate::snapshot::Moving::save(&self.#moving, to);)*
            }

            fn load(&mut self, from: &mut crate::snapshot::Reader) -> ::std::result::Result<(), crate::snapshot::SnapshotError> {
                #(crate::snapshot::Moving::load(&mut self.#moving, from)?;)*
                Ok(())
            }
        }
    })
}
