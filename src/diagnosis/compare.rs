//! The comparison of a model with an experiment.

use super::bounds::believable;
use super::calibrate::{Calibration, Free, Prior, calibrate};
use super::failure::{Failure, failures};
use super::fit::Fit;
use super::layout::Layout;
use super::noise::{NoiseFloor, noise_floors};
use super::prediction::{Predict, PredictionError, SingleWheelPrediction};
use super::single_wheel::Rig;
use super::traverse::TraversePrediction;
use crate::effects::DefinitionError;
use crate::measurement::{Experiment, Kind};
use crate::model::Model;
use bekker_modeldescription::{Lookup, ParameterError, Parameters, Role};
use std::collections::BTreeMap;

/// How to compare.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CompareOptions {
    /// Whether to calibrate the free parameters first.
    pub calibrate: bool,
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
    /// The model cannot compute a measured row.
    #[error(transparent)]
    Prediction(#[from] PredictionError),
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
}

/// A model beside an experiment. Arrays are by run and signal, in SI units.
#[derive(Clone, Debug, PartialEq)]
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
/// With `options.calibrate` the free parameters are calibrated first: those with [`Role::Calibrated`] unless the
/// experiment states their value, and all that have a prior.
///
/// # Errors
/// [`CompareError`].
pub fn compare(model: &Model, experiment: &Experiment, options: &CompareOptions) -> Result<Comparison, CompareError> {
    let layout = Layout::new(experiment);
    let mut model = model.clone();
    model.define_effects(experiment.effects.clone())?;
    let mut known = with_parameters(&model, &experiment.parameters, "experiment.toml, [parameters]")?;
    let models = experiment
        .runs
        .iter()
        .map(|run| with_parameters(&known, &run.parameters, &format!("experiment.toml, run {}", run.name)))
        .collect::<Result<Vec<_>, _>>()?;
    let free = free_parameters(&mut known, experiment)?;
    let names: Vec<String> = free.iter().map(|free| free.variable.name.clone()).collect();
    match experiment.kind {
        Kind::SingleWheel => {
            let rigs = models.iter().map(|model| Rig::of(&model.rover)).collect();
            let predict = SingleWheelPrediction::new(experiment, &layout, rigs, &names);
            evaluate(&predict, experiment, &layout, &free, options)
        }
        Kind::Traverse => {
            let predict = TraversePrediction::new(experiment, &layout, models, &free)?;
            evaluate(&predict, experiment, &layout, &free, options)
        }
    }
}

/// The model with the given parameters and, on request, calibrated.
fn evaluate(
    predict: &dyn Predict,
    experiment: &Experiment,
    layout: &Layout,
    free: &[Free],
    options: &CompareOptions,
) -> Result<Comparison, CompareError> {
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
            let found = calibrate(predict, layout, free, &weights(layout, &floors));
            let Some(calibration) = found else {
                return Err(given.err().map_or_else(no_measurements(layout, free), CompareError::NoStart));
            };
            modelled = predict.values(&calibration.parameters.iter().map(|p| p.value).collect::<Vec<_>>())?;
            floors = noise_floors(experiment, layout, &modelled);
            calibrated = Some((calibration, Fit::new(experiment, layout, &modelled)));
        }
    }
    let given = given.map(|values| Fit::new(experiment, layout, &values));
    let best = Fit::new(experiment, layout, &modelled);
    let failures = failures(experiment, &best, &floors);
    Ok(Comparison { experiment: experiment.clone(), given, calibrated, noise_floor: floors, failures, best })
}

fn no_measurements(layout: &Layout, free: &[Free]) -> impl FnOnce() -> CompareError {
    let (values, free) = (layout.present(), free.len());
    move || CompareError::TooFewMeasurements { values, free }
}

fn with_parameters<M: Clone + Parameters<f64>>(
    model: &M,
    parameters: &BTreeMap<String, f64>,
    place: &str,
) -> Result<M, CompareError> {
    let mut model = model.clone();
    for (name, value) in parameters {
        let set = model.set(name, *value);
        set.map_err(|source| CompareError::Parameter { place: place.to_owned(), source })?;
    }
    Ok(model)
}

/// What a default calibration moves: parameters with the role, unless the experiment states their value, and all that
/// have a prior. At a single wheel width k_c and k_phi act as one, and k_c stays.
fn free_parameters(model: &mut dyn Parameters<f64>, experiment: &Experiment) -> Result<Vec<Free>, CompareError> {
    let listed = model.list();
    for name in experiment.priors.keys() {
        if !listed.iter().any(|(variable, _)| variable.name == *name) {
            let place = "experiment.toml, [priors]".to_owned();
            return Err(CompareError::Parameter { place, source: model.unknown(name) });
        }
    }
    let widths = experiment.runs.iter().filter_map(|run| run.parameters.get("wheel.width"));
    let many_widths = widths.collect::<Vec<_>>().windows(2).any(|pair| pair[0] != pair[1]);
    let is_free = |name: &str, role: Role| {
        experiment.priors.contains_key(name)
            || (role == Role::Calibrated
                && !experiment.parameters.contains_key(name)
                && (name != "soil.k_c" || many_widths))
    };
    let chosen = listed.into_iter().filter(|(variable, _)| is_free(&variable.name, variable.role));
    Ok(chosen
        .map(|(mut variable, start)| {
            let deviation = experiment.priors.get(&variable.name).copied();
            if let Some((low, high)) = believable(&variable.name) {
                // A value that the experiment states stays reachable.
                variable.min = variable.min.max(low.min(start));
                variable.max = variable.max.min(high.max(start));
            }
            Free { prior: deviation.map(|deviation| Prior { mean: start, deviation }), variable, start }
        })
        .collect())
}

/// Standard deviation by signal: the noise floor, or where it is unknown the signal's own scatter, which weighs the
/// signals evenly.
fn weights(layout: &Layout, floors: &BTreeMap<String, NoiseFloor>) -> BTreeMap<String, f64> {
    let own_scatter = |signal: &str| {
        let blocks = layout.blocks.iter().filter(|block| block.signal == signal);
        let values: Vec<f64> =
            blocks.flat_map(|block| layout.measured[block.range.clone()].to_vec()).filter(|v| !v.is_nan()).collect();
        let mean = values.iter().sum::<f64>() / values.len() as f64;
        let variance = values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / values.len() as f64;
        // A signal that never changes still needs a scale.
        [variance.sqrt(), mean.abs(), 1.0].into_iter().find(|scale| *scale > 0.0).unwrap_or(1.0)
    };
    floors
        .iter()
        .map(|(signal, floor)| {
            (signal.clone(), floor.value().filter(|v| *v > 0.0).unwrap_or_else(|| own_scatter(signal)))
        })
        .collect()
}
