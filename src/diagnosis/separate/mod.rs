//! Before and after an experiment: what it can tell apart ([`separate`]), plans of experiments ([`SingleWheelPlan`],
//! [`TraversePlan`]), and which experiment would tell more ([`Suggestion`]).

pub(crate) mod additions;
mod answer;
#[cfg(feature = "report")]
mod json;
mod look;
mod noise;
pub(crate) mod plan;
mod separation;
mod special;
mod strength;
mod suggest;
pub(crate) mod variation;

pub use additions::Addition;
pub(crate) use answer::rounded;
pub use noise::{AssumedNoise, NoiseSource};
pub use plan::PlanError;
pub use separation::{EffectSight, Likeness, PairSight, SeparateOptions, Separation, separate, separate_unless};
pub use strength::SmallestStrength;
pub(crate) use suggest::{Question, suggest};

use serde::Serialize;

/// An experiment worth making.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Suggestion {
    /// What to do, in one sentence.
    pub text: String,
    /// Effects that it would tell apart or make visible.
    pub effects: Vec<String>,
}
