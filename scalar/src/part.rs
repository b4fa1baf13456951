//! Numbers taken apart into parts over few scalars, for code that cannot be generic: what another crate gives as an
//! object is compiled for these scalars once, and serves all others part by part.

use super::{Dual, Scalar};

/// Derivatives that a part carries; a number with more of them has several parts.
pub(crate) const PART: usize = 12;

/// A number with derivatives as code of other crates is compiled for it.
pub type PartDual = Dual<PART>;

/// A scalar that parts are over: `f64`, or [`PartDual`].
pub trait Part: Scalar<Part = Self> {
    /// The one of both that is over this scalar.
    fn choose<B: Both + ?Sized>(both: &B) -> &B::Over<Self>;
}

/// Something that exists over both scalars of parts.
pub trait Both {
    /// What exists over one of them.
    type Over<P: Part>: ?Sized;

    /// Over numbers without derivatives.
    fn plain(&self) -> &Self::Over<f64>;

    /// Over numbers with derivatives.
    fn dual(&self) -> &Self::Over<PartDual>;
}

impl Part for f64 {
    fn choose<B: Both + ?Sized>(both: &B) -> &B::Over<f64> {
        both.plain()
    }
}

impl Part for PartDual {
    fn choose<B: Both + ?Sized>(both: &B) -> &B::Over<PartDual> {
        both.dual()
    }
}
