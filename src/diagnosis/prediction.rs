//! What the model says where something was measured, and how that depends on parameters.

use super::layout::Layout;
use super::unanswered::Answers;
use crate::carriage::SteadyError;
use crate::model::RunError;
use crate::simulation::Event;
use crate::terrain::SamplesError;

/// What is said of [`PredictionError::Undetermined`].
const UNDETERMINED: &str = "the simulated value changes by more than a hundredth of its signal's RMS value where the parameters change by a millionth of \
                            their ranges";

/// Why the model could not compute a measured row.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum PredictionError {
    /// A steady point of a wheel on a carriage does not exist.
    #[error("run {run}, row {row}: {source}")]
    Steady {
        /// Name of the run.
        run: String,
        /// Row of the run, counted from 1.
        row: usize,
        /// Why.
        source: SteadyError,
    },
    /// The simulation of a traverse failed.
    #[error("run {run}: {source}")]
    Simulation {
        /// Name of the run.
        run: String,
        /// Why.
        source: Box<RunError>,
    },
    /// The simulation of a traverse ended before the measurements did.
    #[error("run {run}, at {time} s of its time: the rover is {event}")]
    Ended {
        /// Name of the run.
        run: String,
        /// Time in the run's file, s.
        time: f64,
        /// What happened.
        event: Event,
    },
    /// The run's commands do not fit the model.
    #[error("run {run}: commands for {commands} wheels, the model has {wheels}")]
    Wheels {
        /// Name of the run.
        run: String,
        /// Wheels that the commands name.
        commands: usize,
        /// Wheels of the model.
        wheels: usize,
    },
    /// A measured signal that this model does not have.
    #[error("run {run} measures `{signal}`, which the model does not have")]
    Signal {
        /// Name of the run.
        run: String,
        /// Name of the signal.
        signal: String,
    },
    /// The result of the simulation depends on the last digits of its parameters.
    #[error("run {run}: {}", UNDETERMINED)]
    Undetermined {
        /// Name of the run.
        run: String,
    },
    /// The caller asked to end.
    #[error("interrupted")]
    Interrupted,
    /// The run's profile cannot be used.
    #[error("run {run}: terrain: {source}")]
    Terrain {
        /// Name of the run.
        run: String,
        /// Why.
        source: SamplesError,
    },
}

impl PredictionError {
    /// Name of the run; none where the caller asked to end.
    #[must_use]
    pub fn run(&self) -> &str {
        match self {
            Self::Steady { run, .. }
            | Self::Simulation { run, .. }
            | Self::Ended { run, .. }
            | Self::Wheels { run, .. }
            | Self::Signal { run, .. }
            | Self::Undetermined { run }
            | Self::Terrain { run, .. } => run,
            Self::Interrupted => "",
        }
    }

    /// The same in a run that repeats the one it was found in.
    pub(crate) fn in_run(mut self, name: &str) -> Self {
        match &mut self {
            Self::Steady { run, .. }
            | Self::Simulation { run, .. }
            | Self::Ended { run, .. }
            | Self::Wheels { run, .. }
            | Self::Signal { run, .. }
            | Self::Undetermined { run }
            | Self::Terrain { run, .. } => name.clone_into(run),
            Self::Interrupted => {}
        }
        self
    }

    /// Whether the rover cannot be put on the ground or its equations of motion have no solution: physics of this run rather
    /// than something that is set wrongly.
    pub(crate) fn is_of_the_motion(&self) -> bool {
        use crate::simulation::StepError;
        let Self::Simulation { source, .. } = self else { return false };
        matches!(**source, RunError::Step(StepError::Settle(_) | StepError::Dynamics { .. }))
    }

    /// What is wrong, without the place where it stands.
    #[must_use]
    pub fn reason(&self) -> String {
        match self {
            Self::Steady { source, .. } => source.to_string(),
            Self::Simulation { source, .. } => source.to_string(),
            Self::Ended { time, event, .. } => format!("at {time} s the rover is {event}"),
            Self::Terrain { source, .. } => format!("terrain: {source}"),
            Self::Undetermined { .. } => UNDETERMINED.to_owned(),
            Self::Wheels { .. } | Self::Signal { .. } | Self::Interrupted => self.to_string(),
        }
    }
}

/// How derivatives in parameters were obtained.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Derivatives {
    /// By forward-mode differentiation through the model.
    Exact,
    /// By differences, in part or all: some run is driven by a feedback loop, or cut into windows.
    Differences,
}

/// Modelled values in the order of a [`Layout`], as a function of the free parameters. Rows that the model cannot answer
/// follow the rules of [`unanswered`](super::unanswered).
pub(crate) trait Predict: Sync {
    /// Where the values stand.
    fn layout(&self) -> &Layout;

    /// The modelled values row by row, and the rows without an answer.
    ///
    /// # Errors
    /// [`PredictionError`] where the model has no answer for another reason than what a row asks of it.
    fn answers(&self, free: &[f64]) -> Result<Answers, PredictionError>;

    /// The modelled values, where all rows that count have an answer; NaN in others without one.
    fn values(&self, free: &[f64]) -> Result<Vec<f64>, PredictionError> {
        self.answers(free)?.complete(self.layout())
    }

    /// [`values`](Predict::values) and, for each free parameter, their derivatives in it; 0 in rows without an answer.
    fn slopes(&self, free: &[f64]) -> Result<(Vec<f64>, Vec<Vec<f64>>), PredictionError>;

    /// The modelled values with what a search counts in the place of an answer that is missing.
    fn values_onward(&self, free: &[f64]) -> Result<Vec<f64>, PredictionError>;

    /// [`slopes`](Predict::slopes) of what [`values_onward`](Predict::values_onward) gives.
    fn slopes_onward(&self, free: &[f64]) -> Result<(Vec<f64>, Vec<Vec<f64>>), PredictionError>;

    /// Share of the cost below which a further fall of it means nothing to a fit.
    fn tolerance(&self) -> f64 {
        1e-12
    }

    /// How [`slopes`](Predict::slopes) obtains the derivatives.
    fn derivatives(&self) -> Derivatives {
        Derivatives::Exact
    }
}
