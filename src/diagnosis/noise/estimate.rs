//! The noise model from repeats, by maximum likelihood.
//!
//! Runs of one group share the model's error, so contrasts between them hold noise alone: with m runs, m - 1 orthonormal
//! (Helmert) contrasts of their rows are independent draws with the covariance of a single run. Samples of one label count
//! as [`labels`](super::labels) says. Runs whose parameters differ do not repeat each other.

use super::NoiseModel;
use super::labels::{LabelContrasts, Labelled};
use crate::diagnosis::layout::Layout;
use crate::diagnosis::thresholds::ENOUGH_REPEATS;
use crate::measurement::{Experiment, Sample};
use std::borrow::Cow;
use std::collections::BTreeMap;

/// Contrasts of fewer rows tell nothing of the correlation along a run.
const LEAST_ROWS: usize = 4;

/// Largest share and correlation: a process beyond is a drift, which no repeat determines.
const LARGEST: f64 = 0.98;

/// One draw of noise along a run: rows, values, and what the common part of a run counts in each (empty: one).
#[derive(Clone, Debug)]
struct Strand {
    rows: Vec<usize>,
    values: Vec<f64>,
    weights: Vec<f64>,
}

/// The sets of repeats of an experiment, ready for contrasts.
#[derive(Clone, Debug)]
pub(crate) struct Repeats {
    /// Runs of a group, whose rows pair by index.
    groups: Vec<Vec<usize>>,
    /// Other repeats: samples of one condition.
    sets: Vec<Vec<Sample>>,
}

impl Repeats {
    pub fn new(experiment: &Experiment) -> Self {
        let mut groups: BTreeMap<(&str, usize), Vec<usize>> = BTreeMap::new();
        for (k, (run, rig)) in experiment.runs.iter().zip(experiment.rigs()).enumerate() {
            if let Some(group) = &run.group {
                groups.entry((group, rig)).or_default().push(k);
            }
        }
        let mut groups: Vec<_> = groups.into_values().filter(|runs| runs.len() > 1).collect();
        groups.sort();
        let grouped = |sample: &Sample| groups.iter().any(|runs| runs.contains(&sample.run));
        let sets = experiment.replicates().into_iter().filter(|set| !grouped(&set[0])).collect();
        Self { groups, sets }
    }

    /// Contrasts of one signal over groups of runs; `residual` is measured minus modelled (or measured alone) in the layout's order.
    fn contrasts(&self, layout: &Layout, signal: &str, residual: &[f64]) -> Vec<Strand> {
        let block = |run: usize| layout.of_run(run).find(|block| block.signal == signal).map(|b| b.range.clone());
        let mut strands = Vec::new();
        for runs in &self.groups {
            let blocks: Vec<_> = runs.iter().filter_map(|run| block(*run)).collect();
            for k in 1..blocks.len() {
                let length = blocks.iter().map(ExactSizeIterator::len).min().unwrap_or(0);
                let value = |row: usize| helmert(k, &|j| residual[blocks[j].start + row]);
                let rows: Vec<usize> = (0..length).filter(|row| !value(*row).is_nan()).collect();
                let weight = |row: usize| -> f64 {
                    let own = |j: usize| helmert(k, &|other| if other == j { 1.0 } else { 0.0 });
                    let of_run = |j: usize| own(j) * layout.scale[blocks[j].start + row].weight;
                    (0..=k).map(|j| of_run(j).powi(2)).sum::<f64>().sqrt()
                };
                let weighted = rows.iter().filter(|_| !layout.scale.is_empty());
                strands.push(Strand {
                    values: rows.iter().map(|row| value(*row)).collect(),
                    weights: weighted.map(|row| weight(*row)).collect(),
                    rows,
                });
            }
        }
        strands.retain(|strand| !strand.rows.is_empty());
        strands
    }

    /// The same over labels.
    fn labels(&self, layout: &Layout, signal: &str, residual: &[f64]) -> LabelContrasts {
        let value = |sample: &Sample| {
            let block = layout.of_run(sample.run).find(|block| block.signal == signal)?;
            let place = block.range.start + sample.row;
            let weight = layout.scale.get(place).map_or(1.0, |scale| scale.weight);
            Some(Labelled { run: sample.run, value: residual[place], weight }).filter(|sample| !sample.value.is_nan())
        };
        let sets: Vec<Vec<Labelled>> = self.sets.iter().map(|set| set.iter().filter_map(value).collect()).collect();
        LabelContrasts::new(&sets)
    }

    /// Independent values behind the estimate of a signal's noise.
    pub fn degrees_of_freedom(&self, layout: &Layout, signal: &str) -> usize {
        let groups = self.contrasts(layout, signal, &layout.measured);
        groups.iter().map(|strand| strand.rows.len()).sum::<usize>()
            + self.labels(layout, signal, &layout.measured).count()
    }
}

/// The `k`-th orthonormal contrast: the mean of the first k against number k.
fn helmert(k: usize, value: &dyn Fn(usize) -> f64) -> f64 {
    let mean = (0..k).map(value).sum::<f64>() / k as f64;
    (mean - value(k)) * (k as f64 / (k as f64 + 1.0)).sqrt()
}

/// Noise of one signal from its repeats; `None` where there are none.
pub(crate) fn estimate(repeats: &Repeats, layout: &Layout, signal: &str, residual: &[f64]) -> Option<NoiseModel> {
    let residual = &scaled(layout, residual);
    Search::WIDE.run(&repeats.contrasts(layout, signal, residual), &repeats.labels(layout, signal, residual))
}

/// Values in units of the noise of each, where these differ.
fn scaled<'r>(layout: &Layout, values: &'r [f64]) -> Cow<'r, [f64]> {
    if layout.scale.is_empty() { Cow::Borrowed(values) } else { Cow::Owned(layout.by_scale(values.to_vec())) }
}

/// Noise of one signal from residuals themselves, in units of the noise of each, where there are no repeats: all of them count as noise,
/// `lost` degrees of freedom being spent on the model. There is no telling a run's own scatter from the model's error there.
pub(crate) fn estimate_alone(layout: &Layout, signal: &str, residual: &[f64], lost: f64) -> Option<NoiseModel> {
    let strands: Vec<Strand> = layout
        .blocks
        .iter()
        .filter(|block| block.signal == signal)
        .map(|block| {
            let rows: Vec<usize> =
                (0..block.range.len()).filter(|r| !residual[block.range.start + r].is_nan()).collect();
            let values = rows.iter().map(|row| residual[block.range.start + row]).collect();
            Strand { values, rows, weights: Vec::new() }
        })
        .collect();
    let count: usize = strands.iter().map(|strand| strand.rows.len()).sum();
    let scale = (count as f64 / (count as f64 - lost).max(1.0)).sqrt();
    let noise = Search { with_share: false, ..Search::WIDE }.run(&strands, &LabelContrasts::default())?;
    Some(NoiseModel { deviation: noise.deviation * scale, ..noise })
}

/// The same as [`estimate`] searched near a known model, for repeated draws from it.
pub(crate) fn estimate_near(
    repeats: &Repeats,
    layout: &Layout,
    signal: &str,
    residual: &[f64],
    near: &NoiseModel,
) -> Option<NoiseModel> {
    let search =
        Search { centre: [near.run_share, near.correlation], half: 0.3, points: 4, rounds: 3, with_share: true };
    let residual = &scaled(layout, residual);
    search.run(&repeats.contrasts(layout, signal, residual), &repeats.labels(layout, signal, residual))
}

/// Maximum likelihood over share and correlation, the variance being profiled out, on grids that shrink.
struct Search {
    /// Middle of the first grid: share, correlation.
    centre: [f64; 2],
    half: f64,
    points: usize,
    rounds: usize,
    /// Whether the share is searched; else it is zero.
    with_share: bool,
}

impl Search {
    const WIDE: Self =
        Self { centre: [LARGEST / 2.0; 2], half: LARGEST / 2.0, points: 11, rounds: 4, with_share: true };

    fn run(&self, strands: &[Strand], labels: &LabelContrasts) -> Option<NoiseModel> {
        let count = strands.iter().map(|strand| strand.rows.len()).sum::<usize>() + labels.count();
        let own: f64 = strands.iter().flat_map(|strand| &strand.values).map(|value| value * value).sum();
        let squares = own + labels.squares();
        if count == 0 || squares <= 0.0 {
            return None;
        }
        // What is not determined stays zero.
        let long = strands.iter().any(|strand| strand.rows.len() >= LEAST_ROWS);
        let with_share = self.with_share && (long || labels.tell_the_share());
        if !long && !with_share {
            return Some(NoiseModel::white((squares / count as f64).sqrt()));
        }
        let few = with_share && strands.len() + labels.count() < ENOUGH_REPEATS;
        let (mut centre, mut half) = (self.centre, self.half);
        let mut best = (f64::INFINITY, NoiseModel::white(1.0));
        for _ in 0..self.rounds {
            let at = |axis: usize, k: usize| {
                (centre[axis] + half * (2.0 * k as f64 / (self.points - 1) as f64 - 1.0)).clamp(0.0, LARGEST)
            };
            for i in 0..if with_share { self.points } else { 1 } {
                for k in 0..if long { self.points } else { 1 } {
                    let run_share = if with_share { at(0, i) } else { 0.0 };
                    let correlation = if long { at(1, k) } else { 0.0 };
                    let trial = NoiseModel { deviation: 1.0, run_share, correlation };
                    let (deviance, deviation) = deviance(&trial, strands, labels, count);
                    let penalised = deviance + if few { away_from_zero(run_share) } else { 0.0 };
                    if penalised < best.0 {
                        best = (penalised, NoiseModel { deviation, ..trial });
                    }
                }
            }
            centre = [best.1.run_share, best.1.correlation];
            half *= 2.0 / (self.points - 1) as f64;
        }
        Some(best.1)
    }
}

/// Penalty on -2 ln likelihood that keeps the share of a run off zero: -2 ln of the standard deviation that runs have in common
/// (Chung, Rabe-Hesketh, Dorie, Gelman and Liu 2013, Psychometrika 78, a gamma(2, 0) prior). With few repeated runs the most likely
/// share is zero by chance now and then; the means of runs then count as exact, and any difference between them as misfit. The penalty
/// moves a share by about its own standard error at most. It is used where fewer than [`ENOUGH_REPEATS`] contrasts tell the share.
fn away_from_zero(run_share: f64) -> f64 {
    -run_share.max(f64::MIN_POSITIVE).ln()
}

/// -2 ln likelihood up to a constant, and the most likely standard deviation.
fn deviance(trial: &NoiseModel, strands: &[Strand], labels: &LabelContrasts, count: usize) -> (f64, f64) {
    let (mut squares, mut determinant) = labels.length_and_determinant(trial);
    for strand in strands {
        let (length, own) = trial.length_and_determinant(&strand.rows, &strand.weights, &strand.values);
        squares += length;
        determinant += own;
    }
    let variance = squares / count as f64;
    (count as f64 * variance.ln() + determinant, variance.sqrt())
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a test may fail by panicking")]

    use super::{NoiseModel, Repeats, estimate};
    use crate::diagnosis::layout::Layout;
    use crate::diagnosis::noise::Scale;
    use crate::measurement::Experiment;
    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;
    use std::fmt::Write;

    const RUNS: usize = 150;
    const ROWS: usize = 20;
    /// Three standard errors of a variance that so many runs tell, as a share of the whole.
    const FOUND: f64 = 0.06;

    /// Plate tests in one group; what is measured does not matter here.
    fn repeated() -> Experiment {
        let rows: String = (1..=ROWS).map(|row| format!("{},1\n", 0.001 * row as f64)).collect();
        let mut toml =
            "name = \"plates\"\nkind = \"plate_sinkage\"\n[parameters]\n\"plate.diameter\" = 0.1\n".to_owned();
        let mut files = vec![];
        for run in 0..RUNS {
            write!(toml, "[[run]]\nfile = \"{run}.csv\"\ngroup = \"a\"\n").unwrap();
            files.push((format!("{run}.csv"), format!("sinkage,force\n{rows}")));
        }
        files.push(("experiment.toml".to_owned(), toml));
        Experiment::from_texts(&files.into_iter().collect()).unwrap()
    }

    #[test]
    fn property_the_scatter_of_runs_is_found_where_it_counts_little_in_the_first_rows() {
        let experiment = repeated();
        let mut layout = Layout::new(&experiment);
        let drawn = NoiseModel { deviation: 2.0, run_share: 0.8, correlation: 0.5 };
        // A force that grows from next to nothing, under a cell with noise of its own.
        let scale = |row: usize| {
            let expected = (row as f64 / ROWS as f64).powi(2);
            let own = expected.hypot(0.05);
            Scale { row: own, weight: expected / own }
        };
        layout.scale = (0..layout.len()).map(|at| scale(at % ROWS)).collect();
        let mut rng = ChaCha8Rng::seed_from_u64(7);
        for block in layout.blocks.clone() {
            let scale = layout.scale[block.range.clone()].to_vec();
            drawn.draw(&mut rng, &scale, &mut layout.measured[block.range]);
        }
        let found = estimate(&Repeats::new(&experiment), &layout, "force", &layout.measured).unwrap();
        assert!((found.run_share - drawn.run_share).abs() < FOUND, "{found:?}");
        assert!((found.correlation - drawn.correlation).abs() < FOUND, "{found:?}");
        assert!((found.deviation / drawn.deviation - 1.0).abs() < 2.0 * FOUND, "{found:?}");
        // Where the scatter of a run counts fully in every row it is not found.
        layout.scale.iter_mut().for_each(|scale| scale.weight = 1.0);
        let all_alike = estimate(&Repeats::new(&experiment), &layout, "force", &layout.measured).unwrap();
        assert!(all_alike.run_share < drawn.run_share - FOUND, "{all_alike:?}");
    }
}
