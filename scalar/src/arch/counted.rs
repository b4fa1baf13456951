//! Plain arrays that count what is done with them: how much arithmetic a step of eight rovers takes.

use super::{Arch, Arrays, Bits, WIDTH};
use std::cell::Cell;

/// Operations on eight numbers side by side, each counted once for all eight.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Operations {
    /// Sums, differences and products, one floating-point operation of each number.
    pub sums_and_products: u64,
    /// Quotients and square roots, which take many times as long.
    pub quotients_and_roots: u64,
    /// Comparisons, choices, signs, and the bit operations of the elementary functions.
    pub choices: u64,
}

thread_local! {
    static DONE: Cell<Operations> = Cell::default();
}

/// What `f` does on this thread.
pub fn operations<T>(f: impl FnOnce() -> T) -> (T, Operations) {
    let before = DONE.replace(Operations::default());
    let result = f();
    (result, DONE.replace(before))
}

fn count(one: impl FnOnce(&mut Operations) -> &mut u64) {
    let mut done = DONE.get();
    *one(&mut done) += 1;
    DONE.set(done);
}

/// [`Arrays`], counted.
#[derive(Clone, Copy, Debug)]
pub struct Counted;

/// Operations of [`Arrays`] under a count.
macro_rules! counted {
    ($($count:ident { $($name:ident($($argument:ident: $kind:ty),*) -> $result:ty;)* })*) => {$($(
        fn $name($($argument: $kind),*) -> $result {
            count(|done| &mut done.$count);
            Arrays::$name($($argument),*)
        }
    )*)*};
}

type V = [f64; WIDTH];

// SAFETY: numbers lie in memory as those of `Arrays` do.
unsafe impl Arch for Counted {
    type V = V;
    type M = Bits;

    fn there() -> bool {
        true
    }

    fn wide<T>(f: impl FnOnce() -> T) -> T {
        f()
    }

    fn splat(x: f64) -> V {
        Arrays::splat(x)
    }

    fn load(x: &[f64; WIDTH]) -> V {
        Arrays::load(x)
    }

    fn store(v: V) -> [f64; WIDTH] {
        Arrays::store(v)
    }

    counted! {
        sums_and_products {
            add(a: V, b: V) -> V;
            sub(a: V, b: V) -> V;
            mul(a: V, b: V) -> V;
        }
        quotients_and_roots {
            div(a: V, b: V) -> V;
            sqrt(a: V) -> V;
        }
        choices {
            neg(a: V) -> V;
            abs(a: V) -> V;
            less(a: V, b: V) -> Bits;
            less_or_same(a: V, b: V) -> Bits;
            same(a: V, b: V) -> Bits;
            select(mask: Bits, yes: V, no: V) -> V;
            power_of_two(a: V) -> V;
            bit(a: V, k: u32) -> Bits;
            split(a: V) -> (V, V);
        }
    }
}
