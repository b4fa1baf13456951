//! Comparing the model with measurements.
//!
//! [`compare`] runs the model on an experiment's inputs and returns measured, modelled and residual values beside the
//! scatter between repeats, on request after a calibration of the soil; [`diagnose()`] looks for the effect that is missing.
//!
//! What differs between kinds of experiment stands in `kinds`, every constant of judgement in `thresholds`.

mod bounded_quadratic;
mod bounds;
mod calibrate;
#[cfg(test)]
mod certified;
mod compare;
mod curves;
mod diagnose;
mod effort;
mod failure;
mod fit;
mod found_soil;
mod free;
mod gauss_newton;
mod given;
mod guide;
mod halt;
mod identified;
mod information;
#[cfg(feature = "report")]
mod json;
mod kinds;
mod layout;
mod least_squares;
mod linear_algebra;
mod local_line;
mod motion;
mod noise;
mod precedence;
mod prediction;
mod prior_rows;
mod problem;
mod readings;
mod recorded;
mod replay;
mod responses;
mod sensitivity;
mod separate;
mod shift;
mod thresholds;
mod unanswered;
mod uncounted;
mod undetermined;
mod weighted;
mod windows;
mod workbench;

pub use crate::carriage::{Rig, SteadyError, SteadyPoint, steady_point};
pub use calibrate::{CalibratedParameter, Calibration, STANDARD_ERROR};
pub use compare::{CompareError, CompareOptions, Comparison, compare};
#[cfg(feature = "report")]
pub(crate) use curves::set_points;
pub use curves::{Axis, Curve, CurveGroup, Curves, ModelCurves};
pub use diagnose::{
    CandidateResult, Control, DiagnoseOptions, Diagnosis, FinalParameter, LackOfFit, Noise, Outcome, PairResult,
    ParameterResult, Progress, Share, Spread, Step, Task, Threads, TriedFit, Verdict, WholeDrive, diagnose, fit_task,
};
#[cfg(feature = "report")]
pub(crate) use failure::failures;
#[cfg(feature = "report")]
pub(crate) use failure::levels_of;
pub use failure::{Failure, Level, levels};
pub use fit::{Fit, RunFit, SignalFit};
pub use given::Given;
pub use identified::{Determined, Identified, determined_in_words};
pub use kinds::{PlatePlan, ShearPlan, SingleWheelPlan, TraversePlan};
#[cfg(feature = "report")]
pub(crate) use local_line::LocalLine;
pub use motion::Motion;
pub use noise::{FloorSource, NoiseFloor, NoiseModel, Pooled, Scale};
pub use prediction::{Derivatives, PredictionError};
pub use problem::plain_effect;
pub use replay::{Replay, ReplayError};
pub use responses::{Response, interpolation_weights};
pub use sensitivity::{Sensitivity, modelled, sensitivity};
pub use separate::{
    Addition, AssumedNoise, EffectSight, Likeness, NoiseSource, PairSight, PlanError, SeparateOptions, Separation,
    SmallestStrength, Suggestion, separate, separate_unless,
};
pub use unanswered::UnansweredRows;
pub use uncounted::{Uncounted, UncountedGroup, UncountedRows};
pub use windows::{Moving, Window};
pub use workbench::{Adjustable, Calibrated, Trial, Workbench};
