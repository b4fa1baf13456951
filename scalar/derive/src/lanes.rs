//! [`lanes`](macro@crate::lanes).

use proc_macro2::TokenStream;
use quote::{ToTokens, quote};
use syn::visit_mut::{VisitMut, visit_expr_call_mut, visit_expr_method_call_mut, visit_local_mut};
use syn::{
    Attribute, Error, Expr, ExprCall, ExprMethodCall, ImplItem, ImplItemFn, Item, ItemFn, ItemImpl, ItemTrait, Local,
    Result, TraitItem, parse_quote, parse2,
};

pub fn expand(arguments: TokenStream, item: TokenStream) -> Result<TokenStream> {
    let entry = match arguments.to_string().as_str() {
        "" => false,
        "entry" => true,
        _ => return Err(Error::new_spanned(arguments, "nothing or `entry` is expected")),
    };
    // A function of an `impl` has a receiver, which a free function may not have.
    if let Ok(mut function) = parse2::<ImplItemFn>(item.clone()) {
        mark_method(&mut function, entry);
        return Ok(function.into_token_stream());
    }
    match parse2::<Item>(item)? {
        Item::Impl(mut item) => {
            mark_impl(&mut item, entry);
            Ok(item.into_token_stream())
        }
        Item::Trait(mut item) => {
            mark_trait(&mut item, entry);
            Ok(item.into_token_stream())
        }
        Item::Fn(mut item) => {
            mark_function(&mut item, entry);
            Ok(item.into_token_stream())
        }
        other => Err(Error::new_spanned(other, "a function, an `impl` or a trait is expected")),
    }
}

fn inlined() -> Attribute {
    parse_quote!(#[cfg_attr(feature = "inlined", inline(always))])
}

fn mark_function(function: &mut ItemFn, entry: bool) {
    if !entry {
        function.attrs.push(inlined());
    }
    Closures.visit_block_mut(&mut function.block);
}

fn mark_method(function: &mut ImplItemFn, entry: bool) {
    if !entry {
        function.attrs.push(inlined());
    }
    Closures.visit_block_mut(&mut function.block);
}

fn mark_impl(item: &mut ItemImpl, entry: bool) {
    for member in &mut item.items {
        if let ImplItem::Fn(function) = member
            && !function.attrs.iter().any(decides)
        {
            mark_method(function, entry);
        }
    }
}

/// Whether a function says by itself how it is inlined.
fn decides(attribute: &Attribute) -> bool {
    attribute.path().is_ident("lanes") || attribute.path().is_ident("inline")
}

fn mark_trait(item: &mut ItemTrait, entry: bool) {
    for member in &mut item.items {
        if let TraitItem::Fn(function) = member
            && let Some(body) = &mut function.default
        {
            Closures.visit_block_mut(body);
            if !entry {
                function.attrs.push(inlined());
            }
        }
    }
}

/// Marks the closures that stand as an argument or as the value of `let`. Rust takes an attribute before an argument, not
/// before a value, which therefore becomes the argument of a function that gives it back.
struct Closures;

impl Closures {
    fn mark<'e>(arguments: impl Iterator<Item = &'e mut Expr>) {
        for argument in arguments {
            if let Expr::Closure(closure) = argument {
                closure.attrs.push(inlined());
            }
        }
    }
}

impl VisitMut for Closures {
    fn visit_expr_call_mut(&mut self, call: &mut ExprCall) {
        visit_expr_call_mut(self, call);
        Self::mark(call.args.iter_mut());
    }

    fn visit_expr_method_call_mut(&mut self, call: &mut ExprMethodCall) {
        visit_expr_method_call_mut(self, call);
        Self::mark(call.args.iter_mut());
    }

    fn visit_local_mut(&mut self, local: &mut Local) {
        visit_local_mut(self, local);
        if let Some(value) = local.init.as_mut().map(|init| &mut init.expr)
            && let Expr::Closure(closure) = value.as_mut()
        {
            closure.attrs.push(inlined());
            let marked = quote!(::bekker_scalar::always(#closure));
            **value = Expr::Verbatim(marked);
        }
    }
}
