//! Eight numbers side by side on the instruction sets that a program may meet: AVX-512, AVX2, and plain arrays for all
//! others. Every operation is the one of IEEE 754, so the bits are the same on each.

mod arrays;
#[cfg(target_arch = "x86_64")]
mod avx2;
#[cfg(target_arch = "x86_64")]
mod avx512;
#[cfg(test)]
mod counted;

pub(crate) use arrays::Arrays;
#[cfg(test)]
pub(crate) use counted::{Counted, Operations, operations};
#[cfg(target_arch = "x86_64")]
pub(crate) use {avx2::Avx2, avx512::Avx512};

use super::{MOST_LANES, Mask};
use std::fmt::Debug;
use std::ops::{BitAnd, BitOr, Not};

/// Numbers side by side.
pub(crate) const WIDTH: usize = MOST_LANES;

/// An instruction set. A value of [`Self::V`] is made only where [`Self::there`] has said yes.
///
/// # Safety
/// [`Self::V`] lies in memory as `[f64; 8]` does.
pub(crate) unsafe trait Arch: Copy + Debug + Send + Sync + 'static {
    /// Eight numbers.
    type V: Copy + Send + Sync;
    /// Eight yes or no.
    type M: Mask + Send + Sync;

    /// Whether this processor has it.
    fn there() -> bool;
    /// Calls `f`, compiled for it.
    fn wide<T>(f: impl FnOnce() -> T) -> T;

    fn splat(x: f64) -> Self::V;
    fn load(x: &[f64; WIDTH]) -> Self::V;
    fn store(v: Self::V) -> [f64; WIDTH];
    fn add(a: Self::V, b: Self::V) -> Self::V;
    fn sub(a: Self::V, b: Self::V) -> Self::V;
    fn mul(a: Self::V, b: Self::V) -> Self::V;
    fn div(a: Self::V, b: Self::V) -> Self::V;
    fn sqrt(a: Self::V) -> Self::V;
    fn neg(a: Self::V) -> Self::V;
    fn abs(a: Self::V) -> Self::V;
    fn less(a: Self::V, b: Self::V) -> Self::M;
    fn less_or_same(a: Self::V, b: Self::V) -> Self::M;
    fn same(a: Self::V, b: Self::V) -> Self::M;
    fn select(mask: Self::M, yes: Self::V, no: Self::V) -> Self::V;
    fn power_of_two(a: Self::V) -> Self::V;
    fn bit(a: Self::V, k: u32) -> Self::M;
    fn split(a: Self::V) -> (Self::V, Self::V);
}

/// A mask of one bit a number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Bits(u8);

impl Mask for Bits {
    #[inline(always)]
    fn any(self) -> bool {
        self.0 != 0
    }

    #[inline(always)]
    fn lane(self, k: usize) -> bool {
        self.0 >> k & 1 != 0
    }

    #[inline(always)]
    fn from_lanes(mut f: impl FnMut(usize) -> bool) -> Self {
        Self((0..WIDTH).fold(0, |bits, k| bits | u8::from(f(k)) << k))
    }
}

macro_rules! bit_operators {
    ($($mask:ty),*) => {$(
        impl BitAnd for $mask {
            type Output = Self;
            #[inline(always)]
            fn bitand(self, other: Self) -> Self {
                Self(self.0 & other.0)
            }
        }

        impl BitOr for $mask {
            type Output = Self;
            #[inline(always)]
            fn bitor(self, other: Self) -> Self {
                Self(self.0 | other.0)
            }
        }

        impl Not for $mask {
            type Output = Self;
            #[inline(always)]
            fn not(self) -> Self {
                Self(!self.0)
            }
        }
    )*};
}
bit_operators!(Bits);
