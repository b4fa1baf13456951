//! The number of one rover, without derivatives.

use super::{Plain, Scalar, functions};

/// 1.5 2^52: numbers added to it are rounded to whole ones, which then stand in its low bits.
pub(super) const ROUNDING: f64 = 6_755_399_441_055_744.0;

/// Added to the bits of a positive number, it carries into the exponent where the fraction is above that of sqrt 2.
pub(super) const SPLIT_SHIFT: u64 = (0x3ff0_0000 - 0x3fe6_a09e) << 32;
pub(super) const SPLIT_FRACTION: u64 = 0x000f_ffff_ffff_ffff;
/// Bits of a number just below sqrt(1/2).
pub(super) const SPLIT_ROOT: u64 = 0x3fe6_a09e << 32;
/// Bits of 2^52: a whole number below 2^52 in their low part is that much more.
pub(super) const SPLIT_MAGIC: u64 = 0x4330_0000_0000_0000;
pub(super) const SPLIT_BIAS: f64 = 4_503_599_627_370_496.0 + 1023.0;

impl Scalar for f64 {
    type Mask = bool;
    type Plain = f64;
    type Part = f64;

    #[inline(always)]
    fn part(self, _: usize) -> f64 {
        self
    }

    #[inline(always)]
    fn with_part(self, _: usize, part: f64) -> f64 {
        part
    }

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
