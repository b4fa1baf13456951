//! The number that the physics computes with: `f64`, or a dual number that carries exact derivatives.

use num_dual::{DualNum, DualSVec64};

/// A real number for the physics. With `f64` nothing is added; with [`Dual`] every result carries its
/// exact derivatives (forward mode).
pub trait Scalar: DualNum<Primitive = f64> + Copy + Send + Sync {
    /// `self` to the power `exponent`, for `self >= 0`; zero stays zero.
    #[must_use]
    fn power(self, exponent: Self) -> Self;

    /// The real part.
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

    /// The smaller of two numbers, by their real parts.
    #[must_use]
    fn smaller(self, other: Self) -> Self {
        if other < self { other } else { self }
    }

    /// The larger of two numbers, by their real parts.
    #[must_use]
    fn larger(self, other: Self) -> Self {
        if other > self { other } else { self }
    }
}

/// A number with `N` exact partial derivatives.
pub type Dual<const N: usize> = DualSVec64<N>;

impl Scalar for f64 {
    #[inline]
    fn power(self, exponent: f64) -> f64 {
        // The thesis's soil has n = 1; libm's pow takes longer than the rest of the node there.
        if exponent == 1.0 { self } else { self.powf(exponent) }
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

impl<const N: usize> Scalar for Dual<N> {
    fn power(self, exponent: Self) -> Self {
        // The limit at zero: x^n and its derivatives in n vanish, and no node of a quadrature lies there.
        if self.re <= 0.0 { Self::from(0.0) } else { (self.ln() * exponent).exp() }
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
pub fn smooth_step<S: Scalar>(x: S) -> S {
    if x.value() <= 0.0 {
        S::from(0.0)
    } else if x.value() >= 1.0 {
        S::from(1.0)
    } else {
        x * x * (S::from(3.0) - x * 2.0)
    }
}

/// Derivative of [`smooth_step`].
#[must_use]
pub fn smooth_step_slope<S: Scalar>(x: S) -> S {
    if x.value() <= 0.0 || x.value() >= 1.0 { S::from(0.0) } else { x * (S::from(1.0) - x) * 6.0 }
}
