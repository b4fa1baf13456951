//! [`MapScalar`](crate::MapScalar).

use crate::fields;
use proc_macro2::{TokenStream, TokenTree};
use quote::{ToTokens, quote};
use syn::{DeriveInput, Error, GenericArgument, Ident, PathArguments, Result, Type};

pub fn expand(input: &DeriveInput) -> Result<TokenStream> {
    let (name, visibility) = (&input.ident, &input.vis);
    let Some(scalar) = fields::scalar(input)? else {
        return Err(Error::new_spanned(name, "a struct over a scalar is expected"));
    };
    let (number, bounds) = (&scalar.ident, &scalar.bounds);
    let entries = fields::named(input)?.into_iter().map(|field| {
        let field_name = &field.ident;
        let mapped = mapped(&field.ty, number, &quote!(self.#field_name));
        quote!(#field_name: #mapped)
    });
    Ok(quote! {
        impl<#number: ::std::marker::Copy + #bounds> #name<#number> {
            /// The same over another scalar.
            #[must_use]
            #visibility fn map<T: #bounds>(&self, f: &dyn Fn(#number) -> T) -> #name<T> {
                #name { #(#entries,)* }
            }
        }
    })
}

/// The value of type `kind` at `place` over the other scalar: numbers by `f`, lists entry by entry, what has no numbers as it
/// is, and all else by its own `map`.
fn mapped(kind: &Type, number: &Ident, place: &TokenStream) -> TokenStream {
    if is(kind, number) {
        return quote!(f(#place));
    }
    if !mentions(kind.to_token_stream(), number) {
        return quote!(::std::clone::Clone::clone(&#place));
    }
    let Some(entry) = entry_of_list(kind) else { return quote!(#place.map(f)) };
    let value = if is(entry, number) { quote!(*entry) } else { quote!(entry) };
    let mapped = mapped(entry, number, &value);
    quote!(#place.iter().map(|entry| #mapped).collect())
}

fn is(kind: &Type, number: &Ident) -> bool {
    matches!(kind, Type::Path(path) if path.path.is_ident(number))
}

fn mentions(tokens: TokenStream, number: &Ident) -> bool {
    tokens.into_iter().any(|token| match token {
        TokenTree::Ident(ident) => ident == *number,
        TokenTree::Group(group) => mentions(group.stream(), number),
        _ => false,
    })
}

/// `T` of `Vec<T>`.
fn entry_of_list(kind: &Type) -> Option<&Type> {
    let Type::Path(path) = kind else { return None };
    let last = path.path.segments.last().filter(|segment| segment.ident == "Vec")?;
    let PathArguments::AngleBracketed(arguments) = &last.arguments else { return None };
    match arguments.args.first()? {
        GenericArgument::Type(entry) => Some(entry),
        _ => None,
    }
}
