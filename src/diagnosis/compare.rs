//! The comparison of a model with an experiment.

use super::calibrate::Calibration;
use super::curves::{Curves, curves_of_calibration};
use super::diagnose::{WINDOWS, calibrated_baseline, information, left_prior};
use super::failure::{Failure, failures};
use super::fit::Fit;
use super::found_soil::{found_soil, moved};
use super::given::Given;
use super::identified::{Identified, identified};
use super::noise::{NoiseFloor, noise_floors};
use super::prediction::PredictionError;
use super::problem::Problem;
use super::unanswered::{Answers, UnansweredRows, listed};
use super::uncounted::{UncountedRows, uncounted};
use super::workbench::Workbench;
use crate::effects::DefinitionError;
use crate::known_soil::KnownSoil;
use crate::measurement::Experiment;
use crate::model::Model;
use bekker_modeldescription::ParameterError;
use std::collections::BTreeMap;

/// How to compare.
#[derive(Clone, Debug, PartialEq)]
pub struct CompareOptions {
    /// Whether to calibrate the free parameters first.
    pub calibrate: bool,
    /// Effects switched on: their parameters join those that a calibration moves.
    pub added: Vec<String>,
    /// Different windows of a drive that a calibration uses, evenly spread.
    pub windows: usize,
}

impl Default for CompareOptions {
    fn default() -> Self {
        Self { calibrate: false, added: Vec::new(), windows: WINDOWS }
    }
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
    /// Under the best parameters too few measured rows have an answer.
    #[error(
        "too few rows have an answer: {answered} of {rows} with the best parameters found, expected at least half of them and more measured values than the {free} free parameters; the first without one: {first}"
    )]
    TooFewAnswers {
        /// Measured rows with an answer.
        answered: usize,
        /// Measured rows.
        rows: usize,
        /// Free parameters.
        free: usize,
        /// Why the first of the others has none.
        first: Box<PredictionError>,
    },
    /// No parameters were found with which the model can compute every measured row.
    #[error("no parameters within their bounds let the model compute every row; with the given ones: {0}")]
    NoStart(PredictionError),
    /// A fit found no finite cost, or a signal has no scale.
    #[error("the fit found no answer from any start")]
    NoFit,
    /// The caller asked to end before there was anything to tell.
    #[error("interrupted before the baseline was calibrated and compared with its noise: nothing is known")]
    Interrupted,
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

impl CompareError {
    /// The same where it was found in one of several experiments.
    pub(super) fn of_part(self, name: &str) -> Self {
        match self {
            Self::Parameter { place, source } => Self::Parameter { place: format!("{name}: {place}"), source },
            Self::Vehicle(words) => Self::Vehicle(format!("{name}: {words}")),
            other => other,
        }
    }
}

/// A model beside an experiment. Arrays are by run and signal, in SI units.
#[derive(Clone, Debug)]
pub struct Comparison {
    /// The experiment.
    pub experiment: Experiment,
    /// The model with the given parameters, or why it has no answer anywhere (then a calibration was needed).
    pub given: Result<Fit, PredictionError>,
    /// Rows that the given parameters leave without an answer; their errors do not count in `given`.
    pub given_unanswered: Vec<UnansweredRows>,
    /// The model after calibration, if that was asked for.
    pub calibrated: Option<(Calibration, Fit)>,
    /// Noise by signal.
    pub noise_floor: BTreeMap<String, NoiseFloor>,
    /// Where the model fails most, by signal and condition, the worst first.
    pub failures: Vec<Failure>,
    /// The model as curves over the inputs that were varied, as given and, as step 0, after calibration; none for a traverse.
    pub curves: Vec<Curves>,
    /// Rows that the [best fit](Comparison::fit) leaves without an answer: left out of its errors, of the noise and of the
    /// calibration. In the search for that fit they counted as missed by three times the scatter of their signals or more.
    pub unanswered: Vec<UnansweredRows>,
    /// All rows that the best fit does not count, and why: starts of runs, what follows a gap, and rows without an answer.
    pub uncounted: Vec<UncountedRows>,
    /// What the reader of a calibration should beware of, in words.
    pub cautions: Vec<String>,
    /// What was taken from where, in words, where two places disagree; priors of a class of soil; what drives the rover where no
    /// command was recorded. See [`Given`].
    pub sources: Vec<String>,
    /// The model of [`fit`](Self::fit), which states all its values: compared with the same experiment it gives the same
    /// errors. A wheel on a carriage where a single wheel was measured and no rover is named. What the experiment says of
    /// single runs is not part of it, nor are errors of its sensors.
    pub model: Model,
    /// Of several experiments the model of each, by its name; empty for one experiment.
    pub part_models: Vec<(String, Model)>,
    /// The experiment with this model, on which others can be tried.
    pub workbench: Workbench,
    /// What a calibration found of the soil, with its covariance, for other experiments; `None` without one, or where no parameter of the
    /// soil was free.
    pub soil: Option<KnownSoil>,
    /// Which parameters a calibration determines, which only together with others, and which not; those on a bound are left out. Empty
    /// without one.
    pub identified: Vec<Identified>,
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
/// named in `options.added`. Where values come from is said at [`Given`]; a plain model is one that is named. Noise, bad samples
/// and the steps of the simulation are those of [`diagnose`](super::diagnose()), so that this calibration is the baseline of a
/// diagnosis to the bit.
///
/// Rows that the model cannot answer are left out and listed, see [`Comparison::unanswered`].
///
/// # Errors
/// [`CompareError`]: where the experiment does not fit the model, or too few rows have an answer.
pub fn compare(
    given: impl Into<Given>,
    experiment: &Experiment,
    options: &CompareOptions,
) -> Result<Comparison, CompareError> {
    let problem = Problem::new(given, experiment, &options.added)?;
    if problem.layout.present() == 0 {
        return Err(CompareError::NothingMeasured);
    }
    let given = as_it_is(&problem)?;
    if options.calibrate { calibrated(problem, given, options.windows) } else { as_given(&problem, given?) }
}

/// What the given parameters give, or why they give nothing where something was measured.
fn as_it_is(problem: &Problem) -> Result<Result<Answers, PredictionError>, CompareError> {
    let start: Vec<f64> = problem.base.iter().map(|free| free.start).collect();
    let answers = problem.predict(&problem.base, |predict| predict.answers(&start))?;
    Ok(answers.and_then(|answers| match answers.unanswered.first() {
        Some(rows) if !answers.any(&problem.layout) => Err(rows.error.clone()),
        _ => Ok(answers),
    }))
}

/// The comparison without a calibration.
fn as_given(problem: &Problem, given: Answers) -> Result<Comparison, CompareError> {
    let (experiment, layout) = (&*problem.experiment, &problem.layout);
    let noise_floor = noise_floors(experiment, layout, &given.values);
    let start: Vec<f64> = problem.base.iter().map(|free| free.start).collect();
    let best = Fit::new(experiment, layout, &given.values).in_motion(problem, &[], &start)?;
    let unanswered = listed(given.missing(layout));
    Ok(Comparison {
        experiment: experiment.clone(),
        given: Ok(best.clone()),
        given_unanswered: unanswered.clone(),
        calibrated: None,
        failures: failures(experiment, &best, &noise_floor),
        noise_floor,
        curves: curves_of_calibration(problem, None),
        uncounted: uncounted(problem, &[], &unanswered),
        unanswered,
        cautions: Vec::new(),
        sources: problem.sources.clone(),
        model: problem.saved(&problem.base, &start),
        part_models: problem.saved_parts(&problem.base, &start),
        workbench: Workbench::given(problem, noise_floors(experiment, layout, &given.values)),
        soil: None,
        identified: Vec::new(),
        best,
    })
}

/// The comparison after a calibration.
fn calibrated(
    problem: Problem,
    given: Result<Answers, PredictionError>,
    windows: usize,
) -> Result<Comparison, CompareError> {
    let mut posed = problem.clone();
    posed.coarsen();
    posed.cut();
    _ = posed.spare(windows);
    let mut prepared = calibrated_baseline(&mut posed)?;
    prepared.cautions.extend(prepared.baseline.parameters.iter().filter_map(left_prior));
    prepared.cautions.extend(moved(posed.joint.as_ref(), &prepared.baseline));
    let experiment = &*problem.experiment;
    let values = prepared.baseline.values();
    let modelled = posed.with_spared(&[], &values, prepared.modelled.clone())?;
    let best = Fit::new(experiment, &posed.layout, &modelled).in_motion(&posed, &[], &values)?;
    let start: Vec<f64> = problem.base.iter().map(|free| free.start).collect();
    let unanswered = given.as_ref().map_or_else(|_| Vec::new(), |given| listed(given.missing(&problem.layout)));
    let information = information(&posed, &prepared.noise, &prepared.baseline);
    let workbench = Workbench::prepared(&posed, &prepared);
    Ok(Comparison {
        experiment: experiment.clone(),
        workbench,
        given: match given {
            Ok(given) => Ok(Fit::new(experiment, &problem.layout, &given.values).in_motion(&problem, &[], &start)?),
            Err(error) => Err(error),
        },
        given_unanswered: unanswered,
        calibrated: Some((prepared.baseline.clone(), best.clone())),
        failures: failures(experiment, &best, &prepared.floors),
        noise_floor: prepared.floors,
        curves: curves_of_calibration(&problem, Some(&prepared.baseline)),
        uncounted: uncounted(&posed, &[], &prepared.unanswered),
        unanswered: prepared.unanswered,
        cautions: prepared.cautions,
        sources: problem.sources.clone(),
        model: problem.saved(&problem.base, &values),
        part_models: problem.saved_parts(&problem.base, &values),
        soil: information.as_ref().and_then(|all| found_soil(&posed, &prepared.baseline, all)),
        identified: information.map_or_else(Vec::new, |all| identified(&posed, &prepared.baseline, &all)),
        best,
    })
}
