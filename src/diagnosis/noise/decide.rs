//! Which noise a diagnosis rests on, signal by signal.
//!
//! Repeats come first; a stated noise gives its size unless they contradict it. Without repeats a stated noise is taken as it
//! is. A smooth curve along the conditions that scatters more than was stated is a caution and no more, since it may be too
//! stiff to follow the model's error. Where nothing is repeated or stated, the scatter about that curve stands in for the
//! noise, if the curve leaves rows enough; else the noise of the signal is unknown.

use super::{NoiseModel, Repeats, estimate, estimate_alone};
use crate::diagnosis::layout::Layout;
use crate::diagnosis::linear_algebra::Basis;
use crate::diagnosis::thresholds::{ENOUGH_REPEATS, LEAST_LEFT, LEAST_SHARE_LEFT, NOISE_CONTRADICTED};
use crate::measurement::Experiment;
use std::collections::BTreeMap;

/// Smallest share of a signal's scatter over the experiment that stands in for an unknown noise: no instrument resolves a
/// millionth of its range, and residuals of the size of rounding errors do not measure the noise.
const RESOLUTION: f64 = 1e-6;

/// A calibrated model against the measurements, and functions along the conditions.
pub(crate) struct FittedResidual<'a> {
    pub experiment: &'a Experiment,
    pub layout: &'a Layout,
    pub repeats: &'a Repeats,
    /// Measured minus modelled, in the layout's order.
    pub residual: &'a [f64],
    /// Smooth functions of the conditions, by run and row, the smoothest first.
    pub smooth: &'a [Vec<Vec<f64>>],
    /// Columns of a flexible curve in the layout's order, the least smooth first, each nonzero in one signal.
    pub flexible: &'a [Vec<f64>],
    /// Number of calibrated parameters.
    pub calibrated: usize,
    /// Standard deviation of a whole run, as a share of what is measured, by signal, where no repeat tells it.
    pub assumed_scatter: BTreeMap<String, f64>,
}

/// The noise of all signals.
#[derive(Clone, Debug, Default)]
pub(crate) struct Decided {
    pub models: BTreeMap<String, NoiseModel>,
    /// Signals whose repeats contradict what is stated and are taken.
    pub contradicted: Vec<String>,
    /// Signals of whose noise nothing is known: not repeated, not stated, and too few rows to judge by their scatter.
    pub unknown: Vec<String>,
    pub cautions: Vec<String>,
}

/// Decides on the noise of every signal.
pub(crate) fn decide(fitted: &FittedResidual) -> Decided {
    let mut decided = Decided::default();
    for signal in fitted.experiment.signals() {
        let stated = fitted.experiment.noise.get(&signal).copied().filter(|deviation| *deviation > 0.0);
        let model = match (stated, fitted.by_repeats(&signal)) {
            (Some(stated), Some(seen)) => fitted.stated_and_repeated(&signal, stated, seen, &mut decided),
            (None, Some(seen)) => seen,
            (Some(stated), None) => fitted.stated(&signal, stated, &mut decided.cautions),
            (None, None) => fitted.about_a_curve(&signal).unwrap_or_else(|| {
                decided.unknown.push(signal.clone());
                fitted.about_the_model(&signal)
            }),
        };
        let repeated = fitted.repeats.degrees_of_freedom(fitted.layout, &signal) > 0;
        let model = match fitted.assumed_scatter.get(&signal).filter(|_| !repeated) {
            Some(share) => fitted.with_scatter(&signal, model, *share, &mut decided.cautions),
            None => model,
        };
        decided.models.insert(signal, model);
    }
    decided
}

impl FittedResidual<'_> {
    /// Noise from repeats. Where the inputs of repeats differ the residual has the model's share of that taken off; where only
    /// their recording differs it adds scatter. What remains is an upper bound either way, so the smaller is taken.
    fn by_repeats(&self, signal: &str) -> Option<NoiseModel> {
        let plain = estimate(self.repeats, self.layout, signal, &self.layout.measured);
        let corrected = estimate(self.repeats, self.layout, signal, self.residual);
        match (plain, corrected) {
            (Some(plain), Some(corrected)) if corrected.deviation < plain.deviation => Some(corrected),
            (plain, _) => plain,
        }
    }

    fn stated_and_repeated(&self, signal: &str, stated: f64, seen: NoiseModel, decided: &mut Decided) -> NoiseModel {
        let ratio = seen.deviation / stated;
        let freedom = self.repeats.degrees_of_freedom(self.layout, signal);
        if freedom < ENOUGH_REPEATS || (1.0 / NOISE_CONTRADICTED..=NOISE_CONTRADICTED).contains(&ratio) {
            return NoiseModel { deviation: stated, ..seen };
        }
        decided.contradicted.push(signal.to_owned());
        decided.cautions.push(format!(
            "the stated noise of {signal}, {stated:.3e}, is contradicted by the repeats, which scatter by {:.3e}; the repeats are taken",
            seen.deviation
        ));
        seen
    }

    /// A stated noise without repeats. How neighbouring rows hang together is not stated: it is taken from the scatter about the
    /// curve where that agrees; a larger scatter holds the model's error too, which hangs together by itself.
    fn stated(&self, signal: &str, stated: f64, cautions: &mut Vec<String>) -> NoiseModel {
        let Some(own) = self.about_a_curve(signal) else { return NoiseModel::white(stated) };
        let scatter =
            format!("measurements scatter by {:.3e} about a smooth curve along the conditions", own.deviation);
        if own.deviation > NOISE_CONTRADICTED * stated {
            cautions.push(format!(
                "the stated noise of {signal}, {stated:.3e}, may be too small: {scatter}; it is taken as stated, since that curve may be too stiff to follow what the model lacks; repeats would tell"
            ));
            return NoiseModel::white(stated);
        }
        if own.deviation * NOISE_CONTRADICTED < stated {
            cautions.push(format!(
                "the stated noise of {signal}, {stated:.3e}, looks too large: {scatter}; weak effects stay hidden"
            ));
        }
        NoiseModel { deviation: stated, ..own }
    }

    /// Scatter about a curve along the conditions that leaves enough of the values; `None` where there are too few.
    fn about_a_curve(&self, signal: &str) -> Option<NoiseModel> {
        let values = self.values(signal);
        let left = LEAST_LEFT.max(LEAST_SHARE_LEFT * values as f64);
        let most = values as f64 - self.calibrated_share() - left;
        // A level and the smooth functions are the least that can be called a curve.
        let smooth = self.smooth.iter().filter(|function| self.varies(signal, function)).count();
        if most < 1.0 + smooth as f64 {
            return None;
        }
        let basis = self.curve(signal, most as usize);
        let outside = basis.outside(&self.blank(signal, self.residual));
        let mut rest = vec![f64::NAN; outside.len()];
        self.places(signal).for_each(|at| rest[at] = outside[at]);
        let lost = basis.rank() as f64 + self.calibrated_share();
        let noise = estimate_alone(self.layout, signal, &rest, lost)?;
        Some(NoiseModel { deviation: noise.deviation.max(RESOLUTION * self.layout.scatter(signal)), ..noise })
    }

    /// The same noise with runs that differ by a share of what is measured besides.
    fn with_scatter(&self, signal: &str, own: NoiseModel, share: f64, cautions: &mut Vec<String>) -> NoiseModel {
        cautions.push(format!(
            "no test of {signal} is repeated: the soil is taken to resist {:.0} % more or less from one preparation to the next; repeats would tell",
            100.0 * share
        ));
        let modelled: Vec<f64> = self.places(signal).map(|at| self.layout.measured[at] - self.residual[at]).collect();
        let mean_square = modelled.iter().map(|value| value * value).sum::<f64>() / modelled.len().max(1) as f64;
        own.with_runs_apart(share * mean_square.sqrt())
    }

    /// What the calibrated model misses a signal by, which weighs the signals where nothing is known of their noise.
    fn about_the_model(&self, signal: &str) -> NoiseModel {
        let scatter = self.layout.scatter(signal);
        let squares: f64 = self.blank(signal, self.residual).iter().map(|e| e * e).sum();
        let left = self.values(signal) as f64 - self.calibrated_share();
        let missed = if left >= 1.0 { (squares / left).sqrt() } else { scatter };
        NoiseModel::white(missed.max(RESOLUTION * scatter))
    }

    /// At most so many directions along the conditions: a level, the smooth functions, then of the flexible curve the smoothest
    /// first.
    fn curve(&self, signal: &str, most: usize) -> Basis {
        let shape = |value: &dyn Fn(usize, usize) -> f64| {
            let mut column = vec![0.0; self.layout.len()];
            for block in &self.layout.blocks {
                for row in 0..block.range.len() {
                    column[block.range.start + row] = value(block.run, row);
                }
            }
            column
        };
        let smooth = self.smooth.iter().map(|function| shape(&|run, row| function[run][row]));
        let columns = std::iter::once(shape(&|_, _| 1.0)).chain(smooth).chain(self.flexible.iter().rev().cloned());
        let mut basis = Basis::default();
        for column in columns {
            if basis.rank() == most {
                break;
            }
            basis.add(&self.blank(signal, &column));
        }
        basis
    }

    /// Whether a function of the conditions is one of those of a signal at all: in a joint experiment it is zero in other parts.
    fn varies(&self, signal: &str, function: &[Vec<f64>]) -> bool {
        let mut blocks = self.layout.blocks.iter().filter(|block| block.signal == signal);
        blocks.any(|block| function[block.run].iter().any(|value| *value != 0.0))
    }

    /// The values of one signal where it has a residual that counts, in units of the noise of each; 0 elsewhere.
    fn blank(&self, signal: &str, values: &[f64]) -> Vec<f64> {
        let mut all = vec![0.0; values.len()];
        self.places(signal).for_each(|at| all[at] = values[at]);
        self.layout.by_scale(all)
    }

    /// Number of values of a signal.
    fn values(&self, signal: &str) -> usize {
        self.places(signal).count()
    }

    /// Where a signal has a residual that counts: not at the start of a run, which no fit counts.
    fn places(&self, signal: &str) -> impl Iterator<Item = usize> {
        let blocks = self.layout.blocks.iter().filter(move |block| block.signal == signal);
        let rows = blocks.flat_map(|block| block.range.clone().enumerate().map(move |(row, at)| (block.run, row, at)));
        let settled = rows.filter(move |(run, row, _)| !self.layout.is_unsettled(*run, *row));
        settled.map(|(.., at)| at).filter(move |at| !self.residual[*at].is_nan())
    }

    /// Degrees of freedom of one signal that the calibration took.
    fn calibrated_share(&self) -> f64 {
        self.calibrated as f64 / self.experiment.signals().len().max(1) as f64
    }
}
