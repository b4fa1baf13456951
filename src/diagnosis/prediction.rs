//! What the model says where something was measured, and how that depends on parameters.

use super::layout::Layout;
use crate::carriage::{Rig, SteadyError, SteadyPoint, partial, steady_point};
use crate::measurement::Experiment;
use crate::model::RunError;
use crate::scalar::{Dual, Scalar};
use crate::simulation::Event;
use crate::terrain::SamplesError;
use bekker_modeldescription::Parameters;
use std::collections::HashMap;

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

/// How derivatives in parameters were obtained.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Derivatives {
    /// By forward-mode differentiation through the model.
    Exact,
    /// By central differences: some run is driven by a feedback loop.
    Differences,
}

/// Modelled values in the order of a [`Layout`], as a function of the free parameters.
pub(crate) trait Predict: Sync {
    /// The modelled values.
    fn values(&self, free: &[f64]) -> Result<Vec<f64>, PredictionError>;

    /// The modelled values and, for each free parameter, their derivatives in it.
    fn slopes(&self, free: &[f64]) -> Result<(Vec<f64>, Vec<Vec<f64>>), PredictionError>;

    /// As [`values`](Predict::values), but a run that ends early, a rover that is stuck say, stays as it was at the last row
    /// that it reached: what a search may cross on its way, whose end has to have values.
    fn values_onward(&self, free: &[f64]) -> Result<Vec<f64>, PredictionError> {
        self.values(free)
    }

    /// [`slopes`](Predict::slopes) of what [`values_onward`](Predict::values_onward) gives.
    fn slopes_onward(&self, free: &[f64]) -> Result<(Vec<f64>, Vec<Vec<f64>>), PredictionError> {
        self.slopes(free)
    }

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
        Self { experiment, layout, rigs, names, points }
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

    /// Calls `store` with the place of every measured value and what the model says there.
    fn each_value<S: Scalar>(
        &self,
        rig_of: &dyn Fn(usize) -> Rig<S>,
        store: &mut dyn FnMut(usize, S),
    ) -> Result<(), PredictionError> {
        let rigs: Vec<Rig<S>> = (0..self.rigs.len()).map(rig_of).collect();
        for Point { inputs: [load, slip, wheel_speed], rows } in &self.points {
            let (first, row) = rows[0];
            let steady = steady_point(&rigs[first], *load, *slip, *wheel_speed).map_err(|source| {
                PredictionError::Steady { run: self.experiment.runs[first].name.clone(), row: row + 1, source }
            })?;
            for (run, row) in rows {
                for block in self.layout.of_run(*run) {
                    store(block.range.start + row, signal(&steady, &block.signal));
                }
            }
        }
        Ok(())
    }

    fn slopes_by<const N: usize>(&self, free: &[f64]) -> Result<(Vec<f64>, Vec<Vec<f64>>), PredictionError> {
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
            self.each_value(&rig_of, &mut |at, value| {
                values[at] = value.re;
                for (k, slope) in slopes[first..].iter_mut().take(N).enumerate() {
                    slope[at] = partial(&value, k);
                }
            })?;
        }
        Ok((values, slopes))
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
    fn values(&self, free: &[f64]) -> Result<Vec<f64>, PredictionError> {
        let mut values = vec![f64::NAN; self.layout.len()];
        let rig_of = |run: usize| {
            let mut rig = self.rigs[run].clone();
            self.set_free(run, &mut rig, &|k, place| *place = free[k]);
            rig
        };
        self.each_value(&rig_of, &mut |at, value| values[at] = value)?;
        Ok(values)
    }

    fn slopes(&self, free: &[f64]) -> Result<(Vec<f64>, Vec<Vec<f64>>), PredictionError> {
        // Derivatives that travel together. A baseline calibration has five free parameters, each effect one or two.
        match free.len() {
            0..=6 => self.slopes_by::<6>(free),
            7..=8 => self.slopes_by::<8>(free),
            _ => self.slopes_by::<10>(free),
        }
    }
}
