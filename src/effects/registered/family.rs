//! A group of parameters with hooks, over the scalars that a part of a number may have.

use crate::effects::Effect;
use crate::scalar::{Both, Part, PartDual};
use bekker_modeldescription::Over;
use std::cell::Cell;
use std::marker::PhantomData;

/// What can be registered: a group of parameters, declared with [`parameters!`](bekker_modeldescription::parameters), with
/// hooks over any scalar. Every such group is.
pub trait Registrable: Effect<f64> + Default + 'static {
    /// Calls `f` with the group, whose numbers have these values.
    fn with_plain(value: &dyn Fn(usize) -> f64, f: &mut dyn FnMut(&dyn Effect<f64>));

    /// The same over numbers with derivatives.
    fn with_dual(value: &dyn Fn(usize) -> PartDual, f: &mut dyn FnMut(&dyn Effect<PartDual>));
}

impl<G, D> Registrable for G
where
    G: Effect<f64> + Over<f64, f64, Output = G> + Over<f64, PartDual, Output = D> + Default + 'static,
    D: Effect<PartDual>,
{
    fn with_plain(value: &dyn Fn(usize) -> f64, f: &mut dyn FnMut(&dyn Effect<f64>)) {
        let group: G = filled(&G::default(), value);
        f(&group);
    }

    fn with_dual(value: &dyn Fn(usize) -> PartDual, f: &mut dyn FnMut(&dyn Effect<PartDual>)) {
        let group: D = filled(&G::default(), value);
        f(&group);
    }
}

/// The group over another scalar, with these values in the order of its numbers.
fn filled<T, G: Over<f64, T>>(group: &G, value: &dyn Fn(usize) -> T) -> G::Output {
    let next = Cell::new(0);
    group.over(&|_| value(next.replace(next.get() + 1)))
}

/// An effect over one scalar of parts.
pub(super) trait Hooks<P: Part>: Send + Sync {
    /// Calls `f` with the effect, whose parameters have these values.
    fn call(&self, value: &dyn Fn(usize) -> P, f: &mut dyn FnMut(&dyn Effect<P>));
}

/// The group `G` as a type only.
struct Of<G>(PhantomData<fn() -> G>);

impl<G: Registrable> Hooks<f64> for Of<G> {
    fn call(&self, value: &dyn Fn(usize) -> f64, f: &mut dyn FnMut(&dyn Effect<f64>)) {
        G::with_plain(value, f);
    }
}

impl<G: Registrable> Hooks<PartDual> for Of<G> {
    fn call(&self, value: &dyn Fn(usize) -> PartDual, f: &mut dyn FnMut(&dyn Effect<PartDual>)) {
        G::with_dual(value, f);
    }
}

/// An effect over both scalars of parts.
pub(super) struct Family {
    plain: Box<dyn Hooks<f64>>,
    dual: Box<dyn Hooks<PartDual>>,
}

impl Family {
    pub fn of<G: Registrable>() -> Self {
        Self { plain: Box::new(Of::<G>(PhantomData)), dual: Box::new(Of::<G>(PhantomData)) }
    }
}

impl Both for Family {
    type Over<P: Part> = dyn Hooks<P>;

    fn plain(&self) -> &(dyn Hooks<f64> + 'static) {
        &*self.plain
    }

    fn dual(&self) -> &(dyn Hooks<PartDual> + 'static) {
        &*self.dual
    }
}
