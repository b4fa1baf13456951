//! The numbers that the physics computes with: plain, with exact derivatives, or of eight rovers in SIMD lanes.
//!
//! They are defined in the crate `bekker-scalar`. Its SIMD lanes are not given on: they may be used only on a processor that
//! has their instructions, which the batch checks.

pub use bekker_scalar::{Both, Dual, Mask, Part, PartDual, Plain, Scalar, functions, smooth_step, smooth_step_slope};

#[cfg(all(feature = "batch", any(all(feature = "every-kernel", not(test)), not(target_arch = "x86_64"))))]
pub(crate) use bekker_scalar::Arrays;
#[cfg(feature = "batch")]
pub(crate) use bekker_scalar::MOST_LANES;
#[cfg(feature = "batch")]
pub(crate) use bekker_scalar::{Arch, Lanes, WIDTH};
#[cfg(all(feature = "batch", target_arch = "x86_64"))]
pub(crate) use bekker_scalar::{Avx2, Avx512};
#[cfg(all(feature = "batch", test))]
pub(crate) use bekker_scalar::{Counted, Operations, operations};
pub(crate) use bekker_scalar::{LaneAccess, MapScalar, Moving, lanes};
