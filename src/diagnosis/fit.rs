//! Measured, modelled and residual values by run and signal.

use super::layout::Layout;
use super::motion::{Motion, motions};
use super::prediction::PredictionError;
use super::problem::Problem;
use crate::measurement::{Experiment, Part, Run};
use serde::{Serialize, Serializer};
use std::collections::BTreeMap;
use std::ops::Range;

/// One signal of one run, one entry a row; NaN where nothing was measured.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SignalFit {
    /// Name of the signal.
    #[serde(skip)]
    pub signal: String,
    /// Measured values.
    pub measured: Vec<f64>,
    /// Modelled values, also where nothing was measured; NaN where the model has no answer.
    pub modelled: Vec<f64>,
    /// Measured minus modelled; NaN also in rows that are left out of the comparison, such as the start of a drive.
    pub residual: Vec<f64>,
}

/// All measured signals of one run.
#[derive(Clone, Debug, PartialEq)]
pub struct RunFit {
    /// Name of the run.
    pub run: String,
    /// One entry a measured signal.
    pub signals: Vec<SignalFit>,
}

/// The name of the run, and its signals by name in their order.
impl Serialize for RunFit {
    fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        (&self.run, BySignal(&self.signals)).serialize(to)
    }
}

struct BySignal<'a>(&'a [SignalFit]);

impl Serialize for BySignal<'_> {
    fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        to.collect_map(self.0.iter().map(|fit| (&fit.signal, fit)))
    }
}

impl RunFit {
    /// The signal called `name`, if this run measures it.
    #[must_use]
    pub fn signal(&self, name: &str) -> Option<&SignalFit> {
        self.signals.iter().find(|signal| signal.signal == name)
    }
}

/// The model beside the measurements, for one set of parameters.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Fit {
    /// One entry a run of the experiment, in its order.
    pub runs: Vec<RunFit>,
    /// Root mean square of the residual by signal, in the signal's unit, over the rows that are compared; without the
    /// signals of which no row is.
    pub rmse: BTreeMap<String, f64>,
    /// How the model's rover moves in each run of a traverse; empty where it was not asked for, or the work was interrupted.
    #[serde(skip)]
    pub motion: Vec<Motion>,
}

impl Fit {
    pub(crate) fn new(experiment: &Experiment, layout: &Layout, modelled: &[f64]) -> Self {
        let mut runs: Vec<RunFit> =
            experiment.runs.iter().map(|run| RunFit { run: run.name.clone(), signals: Vec::new() }).collect();
        let mut squares: BTreeMap<String, (f64, usize)> = BTreeMap::new();
        for block in &layout.blocks {
            let (counted, modelled) = (&layout.measured[block.range.clone()], &modelled[block.range.clone()]);
            let settled = |row: usize| !layout.is_unsettled(block.run, row);
            let difference = |(row, (y, m)): (usize, (&f64, &f64))| if settled(row) { y - m } else { f64::NAN };
            let residual: Vec<f64> = counted.iter().zip(modelled).enumerate().map(difference).collect();
            let (sum, count) = squares.entry(block.signal.clone()).or_default();
            for e in residual.iter().filter(|e| !e.is_nan()) {
                *sum += e * e;
                *count += 1;
            }
            runs[block.run].signals.push(SignalFit {
                signal: block.signal.clone(),
                measured: layout.recorded[block.range.clone()].to_vec(),
                modelled: modelled.to_vec(),
                residual,
            });
        }
        squares.retain(|_, (_, count)| *count > 0);
        let rmse = squares.into_iter().map(|(name, (sum, count))| (name, (sum / count as f64).sqrt())).collect();
        Self { runs, rmse, motion: Vec::new() }
    }

    /// What it says of one of several experiments, whose runs stand at `runs`: under names of its own.
    pub(crate) fn of_part(&self, part: &Part, runs: Range<usize>) -> Self {
        let own = |signal: &SignalFit| {
            let name = part.own(&signal.signal).unwrap_or(&signal.signal).to_owned();
            SignalFit { signal: name, ..signal.clone() }
        };
        let of_run = |(fit, run): (&RunFit, &Run)| RunFit {
            run: run.name.clone(),
            signals: fit.signals.iter().map(own).collect(),
        };
        let rmse = self.rmse.iter().filter_map(|(signal, error)| Some((part.own(signal)?.to_owned(), *error)));
        Self {
            runs: self.runs[runs].iter().zip(&part.experiment.runs).map(of_run).collect(),
            rmse: rmse.collect(),
            motion: Vec::new(),
        }
    }

    /// The same with the motion of the model's rover, at `values` of the parameters that are free with `effects`.
    ///
    /// # Errors
    /// [`PredictionError`] where the model cannot be placed on the experiment's runs.
    pub(crate) fn in_motion(
        self,
        problem: &Problem,
        effects: &[String],
        values: &[f64],
    ) -> Result<Self, PredictionError> {
        Ok(Self { motion: motions(problem, effects, values)?, ..self })
    }
}
