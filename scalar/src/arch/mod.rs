//! Eight numbers side by side on the instruction sets that a program may meet: AVX-512, AVX2, and plain arrays for all
//! others. Every operation is the one of IEEE 754, so the bits are the same on each.

mod arrays;
#[cfg(target_arch = "x86_64")]
mod avx2;
#[cfg(target_arch = "x86_64")]
mod avx512;
#[cfg(feature = "counted")]
mod counted;

pub use arrays::Arrays;
#[cfg(feature = "counted")]
pub use counted::{Counted, Operations, operations};
#[cfg(target_arch = "x86_64")]
pub use {avx2::Avx2, avx512::Avx512};

use super::{MOST_LANES, Mask};
use std::fmt::Debug;
use std::ops::{BitAnd, BitOr, Not};

/// Numbers side by side.
pub const WIDTH: usize = MOST_LANES;

/// An instruction set. A value of [`Self::V`] is made only where [`Self::there`] has said yes.
///
/// # Safety
/// [`Self::V`] lies in memory as `[f64; 8]` does.
pub unsafe trait Arch: Copy + Debug + Send + Sync + 'static {
    /// Eight numbers.
    type V: Copy + Send + Sync;
    /// Eight yes or no.
    type M: Mask + Send + Sync;

    /// Whether this processor has it.
    fn there() -> bool;
    /// Calls `f`, compiled for it.
    fn wide<T>(f: impl FnOnce() -> T) -> T;

    /// `x` in every lane.
    fn splat(x: f64) -> Self::V;
    /// Eight numbers from memory.
    fn load(x: &[f64; WIDTH]) -> Self::V;
    /// Eight numbers into memory.
    fn store(v: Self::V) -> [f64; WIDTH];
    /// a + b.
    fn add(a: Self::V, b: Self::V) -> Self::V;
    /// a - b.
    fn sub(a: Self::V, b: Self::V) -> Self::V;
    /// a b.
    fn mul(a: Self::V, b: Self::V) -> Self::V;
    /// a / b.
    fn div(a: Self::V, b: Self::V) -> Self::V;
    /// Square root.
    fn sqrt(a: Self::V) -> Self::V;
    /// -a: the other sign, of zero and NaN too.
    fn neg(a: Self::V) -> Self::V;
    /// |a|: without the sign, of zero and NaN too.
    fn abs(a: Self::V) -> Self::V;
    /// Where a < b; not for NaN.
    fn less(a: Self::V, b: Self::V) -> Self::M;
    /// Where a <= b; not for NaN.
    fn less_or_same(a: Self::V, b: Self::V) -> Self::M;
    /// Where a = b; not for NaN.
    fn same(a: Self::V, b: Self::V) -> Self::M;
    /// `yes` where the mask says so, `no` elsewhere.
    fn select(mask: Self::M, yes: Self::V, no: Self::V) -> Self::V;
    /// [`Plain::power_of_two`](crate::Plain::power_of_two).
    fn power_of_two(a: Self::V) -> Self::V;
    /// [`Plain::bit`](crate::Plain::bit).
    fn bit(a: Self::V, k: u32) -> Self::M;
    /// [`Plain::split`](crate::Plain::split).
    fn split(a: Self::V) -> (Self::V, Self::V);
}

/// A mask of one bit a number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Bits(u8);

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
