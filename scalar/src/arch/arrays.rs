//! Plain arrays.

use super::{Arch, Bits, WIDTH};
use crate::{Mask, Plain};

/// Plain arrays, which the compiler puts on whatever every processor of the target has.
#[derive(Clone, Copy, Debug)]
pub struct Arrays;

#[inline(always)]
fn each<const N: usize>(f: impl FnMut(usize) -> f64) -> [f64; N] {
    std::array::from_fn(f)
}

unsafe impl Arch for Arrays {
    type V = [f64; WIDTH];
    type M = Bits;

    fn there() -> bool {
        true
    }

    #[inline(always)]
    fn wide<T>(f: impl FnOnce() -> T) -> T {
        f()
    }

    #[inline(always)]
    fn splat(x: f64) -> Self::V {
        [x; WIDTH]
    }

    #[inline(always)]
    fn load(x: &[f64; WIDTH]) -> Self::V {
        *x
    }

    #[inline(always)]
    fn store(v: Self::V) -> [f64; WIDTH] {
        v
    }

    #[inline(always)]
    fn add(a: Self::V, b: Self::V) -> Self::V {
        each(|k| a[k] + b[k])
    }

    #[inline(always)]
    fn sub(a: Self::V, b: Self::V) -> Self::V {
        each(|k| a[k] - b[k])
    }

    #[inline(always)]
    fn mul(a: Self::V, b: Self::V) -> Self::V {
        each(|k| a[k] * b[k])
    }

    #[inline(always)]
    fn div(a: Self::V, b: Self::V) -> Self::V {
        each(|k| a[k] / b[k])
    }

    #[inline(always)]
    fn sqrt(a: Self::V) -> Self::V {
        each(|k| a[k].sqrt())
    }

    #[inline(always)]
    fn neg(a: Self::V) -> Self::V {
        each(|k| -a[k])
    }

    #[inline(always)]
    fn abs(a: Self::V) -> Self::V {
        each(|k| a[k].abs())
    }

    #[inline(always)]
    fn less(a: Self::V, b: Self::V) -> Self::M {
        Bits::from_lanes(|k| a[k] < b[k])
    }

    #[inline(always)]
    fn less_or_same(a: Self::V, b: Self::V) -> Self::M {
        Bits::from_lanes(|k| a[k] <= b[k])
    }

    #[inline(always)]
    fn same(a: Self::V, b: Self::V) -> Self::M {
        Bits::from_lanes(|k| a[k] == b[k])
    }

    #[inline(always)]
    fn select(mask: Self::M, yes: Self::V, no: Self::V) -> Self::V {
        each(|k| if mask.lane(k) { yes[k] } else { no[k] })
    }

    #[inline(always)]
    fn power_of_two(a: Self::V) -> Self::V {
        each(|k| Plain::power_of_two(a[k]))
    }

    #[inline(always)]
    fn bit(a: Self::V, k: u32) -> Self::M {
        Bits::from_lanes(|i| Plain::bit(a[i], k))
    }

    #[inline(always)]
    fn split(a: Self::V) -> (Self::V, Self::V) {
        let parts = a.map(Plain::split);
        (parts.map(|part| part.0), parts.map(|part| part.1))
    }
}
