//! Numbers with exact derivatives.

use super::part::{PART, PartDual};
use super::{Scalar, functions};
use nalgebra::SVector;
use num_dual::{Derivative, DualSVec64};

/// A number with `N` exact partial derivatives.
pub type Dual<const N: usize> = DualSVec64<N>;

impl<const N: usize> Scalar for Dual<N> {
    type Mask = bool;
    type Plain = f64;
    type Part = PartDual;

    fn parts() -> usize {
        N.div_ceil(PART).max(1)
    }

    fn part(self, k: usize) -> PartDual {
        let some =
            |all: SVector<f64, N>| SVector::<f64, PART>::from_fn(|i, _| all.get(k * PART + i).copied().unwrap_or(0.0));
        PartDual::new(self.re, Derivative::new(self.eps.0.map(some)))
    }

    fn with_part(self, k: usize, part: PartDual) -> Self {
        let mut all = self.eps.0;
        if part.eps.0.is_some() || all.is_some() {
            let some = part.eps.0.unwrap_or_else(SVector::zeros);
            let places = all.get_or_insert_with(SVector::zeros).iter_mut().skip(k * PART);
            places.zip(&some).for_each(|(place, derivative)| *place = *derivative);
        }
        Self::new(part.re, Derivative::new(all))
    }

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
