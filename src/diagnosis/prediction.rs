//! What the model says where something was measured, and how that depends on parameters.

use super::layout::Layout;
use super::single_wheel::{Rig, SteadyError, SteadyPoint, partial, steady_point};
use crate::measurement::Experiment;
use crate::model::RunError;
use crate::scalar::{Dual, Scalar};
use crate::simulation::Event;
use crate::terrain::SamplesError;
use bekker_modeldescription::Parameters;

/// Derivatives that travel together. A baseline calibration has five free parameters, with one effect six or seven.
const CHUNK: usize = 6;

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

/// Modelled values in the order of a [`Layout`], as a function of the free parameters.
pub(crate) trait Predict: Sync {
    /// The modelled values.
    fn values(&self, free: &[f64]) -> Result<Vec<f64>, PredictionError>;

    /// The modelled values and, for each free parameter, their derivatives in it.
    fn slopes(&self, free: &[f64]) -> Result<(Vec<f64>, Vec<Vec<f64>>), PredictionError>;
}

/// Steady points of a wheel on a carriage.
pub(crate) struct SingleWheelPrediction<'a> {
    experiment: &'a Experiment,
    layout: &'a Layout,
    /// One a run, with what is known of that run.
    rigs: Vec<Rig>,
    names: &'a [String],
}

impl<'a> SingleWheelPrediction<'a> {
    /// `rigs` has one rig a run; `names` are the free parameters. A parameter that a run sets itself stays as it is.
    pub fn new(experiment: &'a Experiment, layout: &'a Layout, rigs: Vec<Rig>, names: &'a [String]) -> Self {
        Self { experiment, layout, rigs, names }
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

    /// Calls `point` with every row of every run and its steady point.
    fn each_point<S: Scalar>(
        &self,
        rig_of: &dyn Fn(usize) -> Rig<S>,
        store: &mut dyn FnMut(usize, S),
    ) -> Result<(), PredictionError> {
        for (k, run) in self.experiment.runs.iter().enumerate() {
            let rig = rig_of(k);
            let input = |name: &str, row: usize| run.data.value(name, row).unwrap_or(f64::NAN);
            for row in 0..run.data.rows() {
                let point = steady_point(&rig, input("load", row), input("slip", row), input("wheel_speed", row))
                    .map_err(|source| PredictionError::Steady { run: run.name.clone(), row: row + 1, source })?;
                for block in self.layout.of_run(k) {
                    store(block.range.start + row, signal(&point, &block.signal));
                }
            }
        }
        Ok(())
    }
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
        self.each_point(&rig_of, &mut |at, value| values[at] = value)?;
        Ok(values)
    }

    fn slopes(&self, free: &[f64]) -> Result<(Vec<f64>, Vec<Vec<f64>>), PredictionError> {
        let mut values = vec![f64::NAN; self.layout.len()];
        let mut slopes = vec![vec![0.0; self.layout.len()]; free.len()];
        for first in (0..free.len()).step_by(CHUNK) {
            let rig_of = |run: usize| {
                let mut rig = self.rigs[run].map(&|value| Dual::<CHUNK>::from(value));
                self.set_free(run, &mut rig, &|k, place| {
                    let value = Dual::from(free[k]);
                    *place = if (first..first + CHUNK).contains(&k) { value.derivative(k - first) } else { value };
                });
                rig
            };
            self.each_point(&rig_of, &mut |at, value| {
                values[at] = value.re;
                for (k, slope) in slopes[first..].iter_mut().take(CHUNK).enumerate() {
                    slope[at] = partial(&value, k);
                }
            })?;
        }
        Ok((values, slopes))
    }
}
