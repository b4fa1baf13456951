//! The number that the physics computes with: `f64`, a dual number that carries exact derivatives, or the same quantity
//! of eight rovers side by side.
//!
//! There is one physics for all of them. What differs from number to number within the eight is written as a choice
//! ([`Scalar::select`]) instead of a branch; `f64` takes the same choices and calls the same elementary functions
//! ([`functions`]), without fused multiply-adds, so a rover in a batch follows the single rover to the last bit, with
//! any instruction set.

#[cfg(feature = "batch")]
mod arch;
mod beside;
pub mod functions;
#[cfg(feature = "batch")]
mod lanes;

use num_dual::{DualNum, DualSVec64};
use std::ops::{BitAnd, BitOr, Not};

#[cfg(feature = "batch")]
pub(crate) use arch::{Arch, Arrays, WIDTH};
#[cfg(all(feature = "batch", target_arch = "x86_64"))]
pub(crate) use arch::{Avx2, Avx512};
#[cfg(feature = "batch")]
pub(crate) use beside::Beside;
pub(crate) use beside::beside;
#[cfg(feature = "batch")]
pub(crate) use lanes::Lanes;

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

/// The closure itself. An attribute `#[inline(always)]` may stand before an argument, not before a value of `let`; what is not
/// inlined is not compiled for the instructions of [`Scalar::wide`].
#[inline(always)]
pub(crate) fn always<F>(f: F) -> F {
    f
}

/// A number with `N` exact partial derivatives.
pub type Dual<const N: usize> = DualSVec64<N>;

/// 1.5 2^52: numbers added to it are rounded to whole ones, which then stand in its low bits.
pub(crate) const ROUNDING: f64 = 6_755_399_441_055_744.0;

/// Added to the bits of a positive number, it carries into the exponent where the fraction is above that of sqrt 2.
const SPLIT_SHIFT: u64 = (0x3ff0_0000 - 0x3fe6_a09e) << 32;
const SPLIT_FRACTION: u64 = 0x000f_ffff_ffff_ffff;
/// Bits of a number just below sqrt(1/2).
const SPLIT_ROOT: u64 = 0x3fe6_a09e << 32;
/// Bits of 2^52: a whole number below 2^52 in their low part is that much more.
const SPLIT_MAGIC: u64 = 0x4330_0000_0000_0000;
const SPLIT_BIAS: f64 = 4_503_599_627_370_496.0 + 1023.0;

impl Scalar for f64 {
    type Mask = bool;
    type Plain = f64;

    #[inline(always)]
    fn plain(self) -> f64 {
        self
    }

    #[inline(always)]
    fn from_plain(plain: f64) -> f64 {
        plain
    }

    #[inline(always)]
    fn select(mask: bool, yes: f64, no: f64) -> f64 {
        if mask { yes } else { no }
    }

    #[inline]
    fn power(self, exponent: f64) -> f64 {
        functions::power(self, exponent)
    }

    #[inline]
    fn exponential(self) -> f64 {
        functions::exp(self)
    }

    #[inline]
    fn sine_cosine(self) -> (f64, f64) {
        functions::sin_cos(self)
    }

    #[inline]
    fn arc_tangent(self) -> f64 {
        functions::atan(self)
    }

    #[inline]
    fn arc_cosine(self) -> f64 {
        functions::acos(self)
    }

    #[inline]
    fn is_exactly(self, x: f64) -> bool {
        self == x
    }

    #[inline]
    fn all_finite(self) -> bool {
        self.is_finite()
    }
}

impl Plain for f64 {
    const LANES: usize = 1;

    #[inline(always)]
    fn lane(self, _: usize) -> f64 {
        self
    }

    #[inline(always)]
    fn from_lanes(mut f: impl FnMut(usize) -> f64) -> f64 {
        f(0)
    }

    #[inline(always)]
    fn less(self, other: f64) -> bool {
        self < other
    }

    #[inline(always)]
    fn less_or_same(self, other: f64) -> bool {
        self <= other
    }

    #[inline(always)]
    fn same(self, other: f64) -> bool {
        self == other
    }

    #[inline(always)]
    fn power_of_two(self) -> f64 {
        f64::from_bits(self.to_bits().wrapping_add(1023) << 52)
    }

    #[inline(always)]
    fn bit(self, k: u32) -> bool {
        self.to_bits() >> k & 1 != 0
    }

    #[inline(always)]
    fn split(self) -> (f64, f64) {
        let shifted = self.to_bits().wrapping_add(SPLIT_SHIFT);
        let exponent = f64::from_bits(shifted >> 52 | SPLIT_MAGIC) - SPLIT_BIAS;
        (f64::from_bits((shifted & SPLIT_FRACTION).wrapping_add(SPLIT_ROOT)), exponent)
    }
}

impl<const N: usize> Scalar for Dual<N> {
    type Mask = bool;
    type Plain = f64;

    #[inline(always)]
    fn plain(self) -> f64 {
        self.re
    }

    #[inline(always)]
    fn from_plain(plain: f64) -> Self {
        Self::from(plain)
    }

    #[inline(always)]
    fn select(mask: bool, yes: Self, no: Self) -> Self {
        if mask { yes } else { no }
    }

    fn power(self, exponent: Self) -> Self {
        // The limit at zero: x^n and its derivatives in n vanish, and no node of a quadrature lies there.
        if self.re <= 0.0 {
            return Self::from(0.0);
        }
        let value = functions::power(self.re, exponent.re);
        let change = self.eps * (exponent.re / self.re) + exponent.eps * self.re.ln();
        Self::new(value, change * value)
    }

    fn exponential(self) -> Self {
        let value = functions::exp(self.re);
        Self::new(value, self.eps * value)
    }

    fn sine_cosine(self) -> (Self, Self) {
        let (sin, cos) = functions::sin_cos(self.re);
        (Self::new(sin, self.eps * cos), Self::new(cos, self.eps * -sin))
    }

    fn arc_tangent(self) -> Self {
        Self::new(functions::atan(self.re), self.eps * (self.re * self.re + 1.0).recip())
    }

    fn arc_cosine(self) -> Self {
        let slope = -(1.0 - self.re * self.re).sqrt().recip();
        Self::new(functions::acos(self.re), self.eps * slope)
    }

    fn is_exactly(self, x: f64) -> bool {
        self.re == x && self.eps.0.is_none()
    }

    fn all_finite(self) -> bool {
        self.re.is_finite() && self.eps.0.is_none_or(|all| all.iter().all(|part| part.is_finite()))
    }
}

/// A smooth step: 0 below 0, 1 above 1, with continuous first derivative.
#[must_use]
#[cfg_attr(feature = "batch", inline(always))]
pub fn smooth_step<S: Scalar>(x: S) -> S {
    let within = x * x * (S::from(3.0) - x * 2.0);
    let upper = S::select(x.at_most(S::from(0.0)), S::from(0.0), within);
    S::select(S::from(1.0).at_most(x), S::from(1.0), upper)
}

/// Derivative of [`smooth_step`].
#[must_use]
#[cfg_attr(feature = "batch", inline(always))]
pub fn smooth_step_slope<S: Scalar>(x: S) -> S {
    let outside = x.at_most(S::from(0.0)) | S::from(1.0).at_most(x);
    S::select(outside, S::from(0.0), x * (S::from(1.0) - x) * 6.0)
}
