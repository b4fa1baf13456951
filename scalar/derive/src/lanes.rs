//! [`lanes`](macro@crate::lanes).

use proc_macro2::TokenStream;
use quote::{ToTokens, quote};
use syn::visit_mut::{VisitMut, visit_expr_call_mut, visit_expr_method_call_mut, visit_local_mut};
use syn::{
    Attribute, Block, Error, Expr, ExprCall, ExprMethodCall, ImplItem, ImplItemFn, Item, ItemImpl, ItemTrait, Local,
    Result, TraitItem, parse_quote, parse2,
};

pub fn expand(arguments: TokenStream, item: TokenStream) -> Result<TokenStream> {
    let entry = match arguments.to_string().as_str() {
        "" => false,
        "entry" => true,
        _ => return Err(Error::new_spanned(arguments, "nothing or `entry` is expected")),
    };
    // Free functions too: a function of an `impl` is one that may have a receiver.
    if let Ok(mut function) = parse2::<ImplItemFn>(item.clone()) {
        mark_body(&mut function.block);
        function.attrs.push(if entry { compiled_once() } else { inlined() });
        return Ok(function.into_token_stream());
    }
    match parse2::<Item>(item)? {
        item if entry => Err(Error::new_spanned(item, "`entry` is for a function")),
        Item::Impl(mut item) => {
            mark_impl(&mut item);
            Ok(item.into_token_stream())
        }
        Item::Trait(mut item) => {
            mark_trait(&mut item);
            Ok(item.into_token_stream())
        }
        other => Err(Error::new_spanned(other, "a function, an `impl` or a trait is expected")),
    }
}

fn inlined() -> Attribute {
    parse_quote!(#[cfg_attr(feature = "inlined", inline(always))])
}

/// An entry is large, and the compiler would copy it into each of its callers.
fn compiled_once() -> Attribute {
    parse_quote!(#[inline(never)])
}

fn mark_impl(item: &mut ItemImpl) {
    for member in &mut item.items {
        if let ImplItem::Fn(function) = member
            && !function.attrs.iter().any(says_how_it_is_inlined)
        {
            mark_body(&mut function.block);
            function.attrs.push(inlined());
        }
    }
}

fn says_how_it_is_inlined(attribute: &Attribute) -> bool {
    attribute.path().is_ident("lanes") || attribute.path().is_ident("inline")
}

fn mark_trait(item: &mut ItemTrait) {
    for member in &mut item.items {
        if let TraitItem::Fn(function) = member
            && let Some(body) = &mut function.default
        {
            mark_body(body);
            function.attrs.push(inlined());
        }
    }
}

fn mark_body(body: &mut Block) {
    Closures.visit_block_mut(body);
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
