//! The noise: how well any model could do ([`NoiseFloor`]), how noise hangs together along a run ([`NoiseModel`]), and
//! the transform that makes it white ([`Whitening`]).

mod decide;
mod estimate;
mod floor;
mod labels;
mod model;
mod scale;
mod whitening;

pub(crate) use decide::{Decided, FittedResidual, decide};
pub(crate) use estimate::{Repeats, estimate, estimate_alone, estimate_near};
pub(crate) use floor::noise_floors;
pub use floor::{FloorSource, NoiseFloor, Pooled};
pub(crate) use model::LocalWhite;
pub use model::NoiseModel;
pub use scale::Scale;
pub(crate) use whitening::Whitening;
