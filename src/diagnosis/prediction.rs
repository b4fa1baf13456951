//! What the model says where something was measured, and how that depends on parameters.

use super::layout::Layout;
use super::single_wheel::{Rig, SteadyError, SteadyPoint, partial, share_not_carried, steady_point};
use super::unanswered::{Answers, MISSED_BY, Unanswered, all_answered};
use crate::measurement::Experiment;
use crate::model::RunError;
use crate::scalar::{Dual, Scalar};
use crate::simulation::Event;
use crate::terrain::SamplesError;
use bekker_modeldescription::Parameters;
use std::collections::{BTreeMap, HashMap};

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
    /// Name of the run.
    #[must_use]
    pub fn run(&self) -> &str {
        match self {
            Self::Steady { run, .. }
            | Self::Simulation { run, .. }
            | Self::Ended { run, .. }
            | Self::Wheels { run, .. }
            | Self::Signal { run, .. }
            | Self::Terrain { run, .. } => run,
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
            | Self::Terrain { run, .. } => name.clone_into(run),
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
            Self::Wheels { .. } | Self::Signal { .. } => self.to_string(),
        }
    }
}

/// How derivatives in parameters were obtained.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Derivatives {
    /// By forward-mode differentiation through the model.
    Exact,
    /// By central differences: some run is driven by a feedback loop.
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

/// Steady points of a wheel on a carriage.
pub(crate) struct SingleWheelPrediction<'a> {
    experiment: &'a Experiment,
    layout: &'a Layout,
    /// One a run, with what is known of that run.
    rigs: Vec<Rig>,
    names: &'a [String],
    /// Steady points to be computed; rows that repeat one follow it.
    points: Vec<Point>,
    /// By signal, how far a search takes a value without an answer to be missed.
    missed_by: BTreeMap<String, f64>,
}

/// A set-point and the rows, by run and index, that were measured at it.
struct Point {
    /// Load (N), slip and wheel speed (rad/s).
    inputs: [f64; 3],
    rows: Vec<(usize, usize)>,
}

impl<'a> SingleWheelPrediction<'a> {
    /// `rigs` has one rig a run; `names` are the free parameters. A parameter that a run sets itself stays as it is.
    pub fn new(experiment: &'a Experiment, layout: &'a Layout, rigs: Vec<Rig>, names: &'a [String]) -> Self {
        let points = points(experiment, &rigs, names);
        let missed_by = |signal: String| (signal.clone(), MISSED_BY * layout.scatter(&signal));
        let missed_by = experiment.signals().into_iter().map(missed_by).collect();
        Self { experiment, layout, rigs, names, points, missed_by }
    }

    /// Sets the free parameters of a run's rig; `place` gets the index of the parameter and where it goes.
    fn set_free<S: Scalar>(&self, run: usize, rig: &mut Rig<S>, place: &dyn Fn(usize, &mut S)) {
        let own = &self.experiment.runs[run].parameters;
        rig.visit("", &mut |variable, value| {
            if let Some(k) = self.names.iter().position(|name| *name == variable.name)
                && !own.contains_key(&variable.name)
            {
                place(k, value);
            }
        });
    }

    /// Calls `store` with the place of every value that has an answer and what the model says there; where a search goes
    /// `onward` also with what it counts elsewhere. Returns the rows without an answer.
    fn each_value<S: Scalar>(
        &self,
        rig_of: &dyn Fn(usize) -> Rig<S>,
        onward: bool,
        store: &mut dyn FnMut(usize, S),
    ) -> Result<Vec<Unanswered>, PredictionError> {
        let rigs: Vec<Rig<S>> = (0..self.rigs.len()).map(rig_of).collect();
        let mut unanswered = Vec::new();
        for Point { inputs: [load, slip, wheel_speed], rows } in &self.points {
            let rig = &rigs[rows[0].0];
            let places = rows.iter().flat_map(|(run, row)| self.layout.of_run(*run).map(move |block| (block, *row)));
            match steady_point(rig, *load, *slip, *wheel_speed) {
                Ok(steady) => {
                    places.for_each(|(block, row)| store(block.range.start + row, signal(&steady, &block.signal)));
                }
                Err(source) => {
                    let without = |(run, row): &(usize, usize)| self.unanswered(*run, *row, source.clone());
                    if !source.is_of_the_row() {
                        return Err(without(&rows[0]).error);
                    }
                    unanswered.extend(rows.iter().map(without));
                    if onward {
                        let share = share_not_carried(rig, *load, *slip, *wheel_speed) + 1.0;
                        places.for_each(|(block, row)| {
                            let at = block.range.start + row;
                            store(at, share * self.missed_by[&block.signal] + self.layout.recorded[at]);
                        });
                    }
                }
            }
        }
        Ok(unanswered)
    }

    fn unanswered(&self, run: usize, row: usize, source: SteadyError) -> Unanswered {
        let name = self.experiment.runs[run].name.clone();
        Unanswered { run, rows: row..row + 1, error: PredictionError::Steady { run: name, row: row + 1, source } }
    }

    /// Values, NaN where there is no answer, unless the search goes `onward`; and the rows without one.
    fn values_by(&self, free: &[f64], onward: bool) -> Result<Answers, PredictionError> {
        let mut values = vec![f64::NAN; self.layout.len()];
        let rig_of = |run: usize| {
            let mut rig = self.rigs[run].clone();
            self.set_free(run, &mut rig, &|k, place| *place = free[k]);
            rig
        };
        let unanswered = self.each_value(&rig_of, onward, &mut |at, value| values[at] = value)?;
        Ok(Answers { values, unanswered })
    }

    fn slopes_by<const N: usize>(
        &self,
        free: &[f64],
        onward: bool,
    ) -> Result<(Vec<f64>, Vec<Vec<f64>>), PredictionError> {
        let mut values = vec![f64::NAN; self.layout.len()];
        let mut slopes = vec![vec![0.0; self.layout.len()]; free.len()];
        for first in (0..free.len().max(1)).step_by(N) {
            let rig_of = |run: usize| {
                let mut rig = self.rigs[run].map(&|value| Dual::<N>::from(value));
                self.set_free(run, &mut rig, &|k, place| {
                    let value = Dual::from(free[k]);
                    *place = if (first..first + N).contains(&k) { value.derivative(k - first) } else { value };
                });
                rig
            };
            let unanswered = self.each_value(&rig_of, onward, &mut |at, value| {
                values[at] = value.re;
                for (k, slope) in slopes[first..].iter_mut().take(N).enumerate() {
                    slope[at] = partial(&value, k);
                }
            })?;
            if !onward {
                all_answered(&unanswered, self.layout)?;
            }
        }
        Ok((values, slopes))
    }

    fn all_slopes(&self, free: &[f64], onward: bool) -> Result<(Vec<f64>, Vec<Vec<f64>>), PredictionError> {
        // Derivatives that travel together. A baseline calibration has five free parameters, each effect one or two.
        match free.len() {
            0..=6 => self.slopes_by::<6>(free, onward),
            7..=8 => self.slopes_by::<8>(free, onward),
            _ => self.slopes_by::<10>(free, onward),
        }
    }
}

/// Set-points of an experiment. Runs share them where their rigs and what they leave free are the same.
fn points(experiment: &Experiment, rigs: &[Rig], names: &[String]) -> Vec<Point> {
    let own = |run: usize| names.iter().map(move |name| experiment.runs[run].parameters.contains_key(name));
    let alike = |a: usize, b: usize| rigs[a] == rigs[b] && own(a).eq(own(b));
    let first_alike: Vec<usize> = (0..rigs.len()).map(|k| (0..k).find(|j| alike(*j, k)).unwrap_or(k)).collect();
    let mut points: Vec<Point> = Vec::new();
    let mut known: HashMap<(usize, [u64; 3]), usize> = HashMap::new();
    for (k, run) in experiment.runs.iter().enumerate() {
        for row in 0..run.data.rows() {
            let inputs = ["load", "slip", "wheel_speed"].map(|name| run.data.value(name, row).unwrap_or(f64::NAN));
            let at = *known.entry((first_alike[k], inputs.map(f64::to_bits))).or_insert(points.len());
            match points.get_mut(at) {
                Some(point) => point.rows.push((k, row)),
                None => points.push(Point { inputs, rows: vec![(k, row)] }),
            }
        }
    }
    points
}

/// The signals that `measurement` knows for a single wheel.
fn signal<S: Copy>(point: &SteadyPoint<S>, name: &str) -> S {
    match name {
        "drawbar_pull" => point.drawbar_pull,
        "torque" => point.torque,
        _ => point.sinkage,
    }
}

impl Predict for SingleWheelPrediction<'_> {
    fn layout(&self) -> &Layout {
        self.layout
    }

    fn answers(&self, free: &[f64]) -> Result<Answers, PredictionError> {
        self.values_by(free, false)
    }

    fn slopes(&self, free: &[f64]) -> Result<(Vec<f64>, Vec<Vec<f64>>), PredictionError> {
        self.all_slopes(free, false)
    }

    fn values_onward(&self, free: &[f64]) -> Result<Vec<f64>, PredictionError> {
        Ok(self.values_by(free, true)?.values)
    }

    fn slopes_onward(&self, free: &[f64]) -> Result<(Vec<f64>, Vec<Vec<f64>>), PredictionError> {
        self.all_slopes(free, true)
    }
}
