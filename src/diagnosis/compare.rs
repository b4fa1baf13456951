//! The comparison of a model with an experiment.

use super::calibrate::{Calibration, calibrate};
use super::effort::Effort;
use super::failure::{Failure, failures};
use super::fit::Fit;
use super::given::Given;
use super::layout::Layout;
use super::noise::{NoiseFloor, NoiseModel, Whitening, noise_floors};
use super::prediction::{Predict, PredictionError};
use super::problem::Problem;
use super::weighted::Weighted;
use crate::effects::DefinitionError;
use crate::measurement::Experiment;
use crate::model::Model;
use bekker_modeldescription::ParameterError;
use std::collections::BTreeMap;

/// How to compare.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CompareOptions {
    /// Whether to calibrate the free parameters first.
    pub calibrate: bool,
    /// Effects switched on: their parameters join those that a calibration moves.
    pub added: Vec<String>,
}

/// Why a comparison is impossible.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum CompareError {
    /// The experiment sets a parameter that the model does not have, or to a value that it may not have.
    #[error("{place}: {source}")]
    Parameter {
        /// Where it is set.
        place: String,
        /// What is wrong.
        source: ParameterError,
    },
    /// The experiment adds an effect whose id the model uses otherwise.
    #[error("experiment.toml: {0}")]
    Effect(#[from] DefinitionError),
    /// The vehicle is not known, or cannot be used.
    #[error("{0}")]
    Vehicle(String),
    /// The model cannot compute a measured row.
    #[error(transparent)]
    Prediction(#[from] PredictionError),
    /// A plan has nothing to compare with.
    #[error("nothing is measured yet: a planned experiment can be asked what it tells apart, not be compared")]
    NothingMeasured,
    /// There are not enough measurements for a calibration.
    #[error("{values} measured values cannot determine {free} free parameters")]
    TooFewMeasurements {
        /// Measured values.
        values: usize,
        /// Free parameters.
        free: usize,
    },
    /// No parameters were found with which the model can compute every measured row.
    #[error("no parameters within their bounds let the model compute every row; with the given ones: {0}")]
    NoStart(PredictionError),
    /// A fit found no finite cost, or a signal has no scale.
    #[error("the fit found no answer from any start")]
    NoFit,
    /// An effect is named twice.
    #[error("effect `{id}` is named twice")]
    EffectTwice {
        /// The name.
        id: String,
    },
    /// An effect is not known, or is part of the model already.
    #[error("no candidate effect `{id}`; those that can be added are {known}")]
    UnknownEffect {
        /// The name asked for.
        id: String,
        /// Names of the candidates.
        known: String,
    },
}

/// A model beside an experiment. Arrays are by run and signal, in SI units.
#[derive(Clone, Debug)]
pub struct Comparison {
    /// The experiment.
    pub experiment: Experiment,
    /// The model with the given parameters, or why it cannot compute the experiment (then a calibration was needed).
    pub given: Result<Fit, PredictionError>,
    /// The model after calibration, if that was asked for.
    pub calibrated: Option<(Calibration, Fit)>,
    /// Noise by signal.
    pub noise_floor: BTreeMap<String, NoiseFloor>,
    /// Where the model fails most, by signal and condition, the worst first.
    pub failures: Vec<Failure>,
    /// What was taken from where, in words, where two places disagree; priors of a class of soil. See [`Given`].
    pub sources: Vec<String>,
    /// The model of [`fit`](Self::fit), which states all its values: compared with the same experiment it gives the same
    /// errors. A wheel on a carriage where a single wheel was measured and no rover is named. What the experiment says of
    /// single runs is not part of it.
    pub model: Model,
    best: Fit,
}

impl Comparison {
    /// The best fit: after calibration where there was one.
    #[must_use]
    pub fn fit(&self) -> &Fit {
        &self.best
    }
}

/// Runs the model on the inputs of an experiment, of either kind, and compares it with what was measured.
///
/// With `options.calibrate` the free parameters are calibrated first: those with
/// [`Role::Calibrated`](bekker_modeldescription::Role) unless they are held, all that have a prior, and those of the effects
/// named in `options.added`. Where values come from is said at [`Given`]; a plain model is one that is named.
///
/// # Errors
/// [`CompareError`].
pub fn compare(
    given: impl Into<Given>,
    experiment: &Experiment,
    options: &CompareOptions,
) -> Result<Comparison, CompareError> {
    let problem = Problem::new(given, experiment, &options.added)?;
    if problem.layout.present() == 0 {
        return Err(CompareError::NothingMeasured);
    }
    problem.predict(&problem.base, |predict| evaluate(predict, &problem, options))?
}

/// The model with the given parameters and, on request, calibrated.
fn evaluate(predict: &dyn Predict, problem: &Problem, options: &CompareOptions) -> Result<Comparison, CompareError> {
    let (experiment, layout, free) = (&*problem.experiment, &problem.layout, &problem.base);
    let start: Vec<f64> = free.iter().map(|free| free.start).collect();
    let given = predict.values(&start);
    let mut modelled = match (&given, options.calibrate) {
        (Err(error), false) => return Err(error.clone().into()),
        // Without an answer the repeats are compared without the model's share in them; refined below.
        (Err(_), true) => vec![0.0; layout.len()],
        (Ok(values), _) => values.clone(),
    };
    let mut floors = noise_floors(experiment, layout, &modelled);
    let mut calibrated = None;
    if options.calibrate {
        if layout.present() <= free.len() {
            return Err(CompareError::TooFewMeasurements { values: layout.present(), free: free.len() });
        }
        // Twice: the second time with the noise floor of the calibrated model.
        for _ in 0..2 {
            let Some(calibration) = calibrated_with(predict, problem, &weights(layout, &floors)) else {
                return Err(given.err().map_or(CompareError::NoFit, CompareError::NoStart));
            };
            modelled = predict.values(&calibration.values())?;
            floors = noise_floors(experiment, layout, &modelled);
            calibrated = Some((calibration, Fit::new(experiment, layout, &modelled)));
        }
    }
    let given = given.map(|values| Fit::new(experiment, layout, &values));
    let best = Fit::new(experiment, layout, &modelled);
    let failures = failures(experiment, &best, &floors);
    let values = calibrated.as_ref().map_or(start, |(calibration, _)| calibration.values());
    let model = problem.saved(free, &values);
    let (experiment, sources) = (experiment.clone(), problem.sources.clone());
    Ok(Comparison { experiment, given, calibrated, noise_floor: floors, failures, sources, model, best })
}

/// A calibration with independent samples of the given standard deviations.
fn calibrated_with(predict: &dyn Predict, problem: &Problem, weights: &BTreeMap<String, f64>) -> Option<Calibration> {
    let noise = weights.iter().map(|(signal, deviation)| (signal.clone(), NoiseModel::white(*deviation))).collect();
    let whitening = Whitening::new(&problem.layout, &noise, &|_, _| true)?;
    let (layout, free) = (&problem.layout, &problem.base);
    let weighted = Weighted { predict, layout, free, whitening: &whitening, robust: f64::INFINITY, whole: true };
    calibrate(&weighted, weights, Effort::of(problem.experiment.kind))
}

/// Standard deviation by signal: the noise floor, or where it is unknown the signal's own scatter, which weighs the
/// signals evenly.
fn weights(layout: &Layout, floors: &BTreeMap<String, NoiseFloor>) -> BTreeMap<String, f64> {
    let weight = |signal: &String, floor: &NoiseFloor| {
        floor.value().filter(|v| *v > 0.0).unwrap_or_else(|| own_scatter(layout, signal))
    };
    floors.iter().map(|(signal, floor)| (signal.clone(), weight(signal, floor))).collect()
}

/// Standard deviation of a signal over the whole experiment.
pub(crate) fn own_scatter(layout: &Layout, signal: &str) -> f64 {
    let blocks = layout.blocks.iter().filter(|block| block.signal == signal);
    let values: Vec<f64> =
        blocks.flat_map(|block| layout.measured[block.range.clone()].to_vec()).filter(|v| !v.is_nan()).collect();
    let mean = values.iter().sum::<f64>() / values.len() as f64;
    let variance = values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / values.len() as f64;
    // A signal that never changes still needs a scale.
    [variance.sqrt(), mean.abs(), 1.0].into_iter().find(|scale| *scale > 0.0).unwrap_or(1.0)
}
