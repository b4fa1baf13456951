//! The number that Bekker's physics computes with: `f64`, a dual number that carries exact derivatives, or the same quantity
//! of eight rovers in SIMD lanes (feature `batch`).
//!
//! There is one physics for all of them. What differs from number to number within the eight is written as a choice
//! ([`Scalar::select`]) instead of a branch; `f64` takes the same choices and calls the same elementary functions
//! ([`functions`]), without fused multiply-adds, so a rover in a batch follows the single rover to the last bit, with
//! any instruction set.
//!
//! This crate is for the crates of this workspace. Numbers over an instruction set (`Lanes`, `Arch`) may be made only where
//! `Arch::there` says that the processor has it; the functions are not `unsafe`, because every operation of the physics would be.

#[cfg(feature = "batch")]
mod arch;
mod dual;
pub mod functions;
#[cfg(feature = "batch")]
mod lane_access;
#[cfg(feature = "batch")]
mod lanes;
mod part;
mod plain;
mod smooth;

use num_dual::DualNum;
use std::ops::{BitAnd, BitOr, Not};

#[cfg(feature = "batch")]
pub use arch::{Arch, Arrays, WIDTH};
#[cfg(all(feature = "batch", target_arch = "x86_64"))]
pub use arch::{Avx2, Avx512};
#[cfg(feature = "counted")]
pub use arch::{Counted, Operations, operations};
pub use bekker_derive::{LaneAccess, MapScalar, Moving, lanes};
pub use dual::Dual;
#[cfg(feature = "batch")]
pub use lane_access::LaneAccess;
#[cfg(feature = "batch")]
pub use lanes::Lanes;
pub use part::{Both, Part, PartDual};
use plain::ROUNDING;
#[cfg(all(feature = "batch", target_arch = "x86_64"))]
use plain::{SPLIT_BIAS, SPLIT_FRACTION, SPLIT_MAGIC, SPLIT_ROOT, SPLIT_SHIFT};
pub use smooth::{smooth_step, smooth_step_slope};

/// Most numbers side by side.
pub const MOST_LANES: usize = 8;

/// Yes or no, for each of the numbers side by side.
pub trait Mask: Copy + BitAnd<Output = Self> + BitOr<Output = Self> + Not<Output = Self> {
    /// Whether it is yes for any.
    fn any(self) -> bool;
    /// Whether it is yes for all.
    fn all(self) -> bool {
        !(!self).any()
    }
    /// Yes or no for number `k`.
    fn lane(self, k: usize) -> bool;
    /// Yes for number `k` of those side by side where `f` says so.
    fn from_lanes(f: impl FnMut(usize) -> bool) -> Self;
}

impl Mask for bool {
    #[inline(always)]
    fn any(self) -> bool {
        self
    }

    #[inline(always)]
    fn all(self) -> bool {
        self
    }

    #[inline(always)]
    fn lane(self, _: usize) -> bool {
        self
    }

    #[inline(always)]
    fn from_lanes(mut f: impl FnMut(usize) -> bool) -> Self {
        f(0)
    }
}

/// A real number for the physics. With `f64` nothing is added; with [`Dual`] every result carries its
/// exact derivatives (forward mode).
pub trait Scalar: DualNum<Primitive = f64> + Copy + Send + Sync {
    /// Yes or no for what a choice hangs on.
    type Mask: Mask;
    /// The same without derivatives.
    type Plain: Plain<Mask = Self::Mask>;
    /// What its parts are over, see [`Part`].
    type Part: Part;

    /// How many parts it has: one, or as many as there are numbers side by side, or groups of derivatives.
    #[must_use]
    fn parts() -> usize {
        1
    }

    /// Part `k`.
    #[must_use]
    fn part(self, k: usize) -> Self::Part;

    /// The same number with part `k` replaced.
    #[must_use]
    fn with_part(self, k: usize, part: Self::Part) -> Self;

    /// The real part, or the real parts side by side.
    #[must_use]
    fn plain(self) -> Self::Plain;

    /// A constant.
    #[must_use]
    fn from_plain(plain: Self::Plain) -> Self;

    /// `yes` where the mask says so, `no` elsewhere.
    #[must_use]
    fn select(mask: Self::Mask, yes: Self, no: Self) -> Self;

    /// `self` to the power `exponent`, for `self >= 0`; zero stays zero. [`functions::power`].
    #[must_use]
    fn power(self, exponent: Self) -> Self;

    /// e^x by [`functions::exp`].
    #[must_use]
    fn exponential(self) -> Self;

    /// Sine and cosine by [`functions::sin_cos`].
    #[must_use]
    fn sine_cosine(self) -> (Self, Self);

    /// Arc tangent by [`functions::atan`].
    #[must_use]
    fn arc_tangent(self) -> Self;

    /// Arc cosine by [`functions::acos`].
    #[must_use]
    fn arc_cosine(self) -> Self;

    /// The real part; of numbers side by side the first one's, which decides nothing.
    #[must_use]
    fn value(self) -> f64 {
        self.re()
    }

    /// Whether this is the constant `x`, with no derivative either: an effect whose parameter is exactly
    /// neutral may be skipped, one that is being differentiated may not.
    #[must_use]
    fn is_exactly(self, x: f64) -> bool;

    /// Whether the number and all its derivatives are finite.
    #[must_use]
    fn all_finite(self) -> bool;

    /// Whether it is less than another, by their real parts.
    #[must_use]
    #[inline(always)]
    fn below(self, other: Self) -> Self::Mask {
        self.plain().less(other.plain())
    }

    /// Whether it is no more than another, by their real parts.
    #[must_use]
    #[inline(always)]
    fn at_most(self, other: Self) -> Self::Mask {
        self.plain().less_or_same(other.plain())
    }

    /// Whether it is less than a constant.
    #[must_use]
    #[inline(always)]
    fn under(self, limit: f64) -> Self::Mask {
        self.plain().less(limit.into())
    }

    /// Whether it is more than a constant.
    #[must_use]
    #[inline(always)]
    fn over(self, limit: f64) -> Self::Mask {
        Self::Plain::from(limit).less(self.plain())
    }

    /// The smaller of two numbers, by their real parts.
    #[must_use]
    #[inline(always)]
    fn smaller(self, other: Self) -> Self {
        Self::select(other.below(self), other, self)
    }

    /// The larger of two numbers, by their real parts.
    #[must_use]
    #[inline(always)]
    fn larger(self, other: Self) -> Self {
        Self::select(self.below(other), other, self)
    }

    /// `self`, or its negative where the mask says so.
    #[must_use]
    #[inline(always)]
    fn negative_where(self, mask: Self::Mask) -> Self {
        Self::select(mask, -self, self)
    }

    /// Calls `f`, compiled for the instructions that numbers side by side live on.
    #[inline(always)]
    fn wide<T>(f: impl FnOnce() -> T) -> T {
        f()
    }
}

/// A number without derivatives, or several side by side.
pub trait Plain: Scalar<Plain = Self> {
    /// How many there are side by side.
    const LANES: usize;

    /// Number `k`.
    #[must_use]
    fn lane(self, k: usize) -> f64;

    /// Numbers side by side from a function of their place.
    #[must_use]
    fn from_lanes(f: impl FnMut(usize) -> f64) -> Self;

    /// Whether `self < other`; false for NaN.
    #[must_use]
    fn less(self, other: Self) -> Self::Mask;

    /// Whether `self <= other`; false for NaN.
    #[must_use]
    fn less_or_same(self, other: Self) -> Self::Mask;

    /// Whether `self == other`; false for NaN.
    #[must_use]
    fn same(self, other: Self) -> Self::Mask;

    /// 2^k for a whole number k in -1022..=1024 held in the low bits of `self` = 1.5 2^52 + k (infinity for 1024).
    #[must_use]
    fn power_of_two(self) -> Self;

    /// Whether bit `k` of the number's representation is set.
    #[must_use]
    fn bit(self, k: u32) -> Self::Mask;

    /// (m, k) with `self` = m 2^k and m in about sqrt(1/2)..sqrt 2, for positive normal numbers.
    #[must_use]
    fn split(self) -> (Self, Self);

    /// `f` of each number.
    #[must_use]
    #[inline(always)]
    fn each(self, mut f: impl FnMut(f64) -> f64) -> Self {
        Self::from_lanes(|k| f(self.lane(k)))
    }
}

/// The closure itself, for closures that are values of `let`: an attribute, with which [`lanes`](macro@lanes) marks a closure,
/// may stand before an argument only.
#[inline(always)]
pub fn always<F>(f: F) -> F {
    f
}
