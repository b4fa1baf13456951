//! Odd stretches of a drive: what is wrong only there must not decide on the rest.
//!
//! A stretch is odd where the calibrated baseline misses much there, next to nothing elsewhere, and no effect accounts for
//! it. What a repeat of the run shows as well at the same rows is no oddity but the model's error, unless it is the start of
//! runs, and neither is what other runs show at the same place. Odd stretches are left out of every fit, and the result says so.

use super::prepare::Prepared;
use super::stage::{Stage, StageContext};
use crate::diagnosis::compare::CompareError;
use crate::diagnosis::problem::Problem;
use crate::diagnosis::thresholds::{ODD, ODD_ELSEWHERE, ODD_EXPLAINED, ODD_SHARE, ODD_START};
use crate::measurement::{Kind, Run};
use std::collections::BTreeMap;
use std::ops::Range;

/// Length of a stretch, s.
const LENGTH: f64 = 3.0;
/// Places this near are one, m: half a wheelbase of a small rover.
const SAME_PLACE: f64 = 0.3;

/// A piece of a run.
#[derive(Clone, Debug)]
struct Stretch {
    run: usize,
    rows: Range<usize>,
    /// Number of it in the run.
    number: usize,
    /// Sum of squares of the whitened residual, and how many there are.
    squares: f64,
    count: f64,
    /// Where the rover was, least and largest x, m.
    place: Option<[f64; 2]>,
}

impl Stretch {
    fn mean(&self) -> f64 {
        self.squares / self.count.max(1.0)
    }
}

/// What is odd: rows (run, row), and words about them. Empty where nothing is.
pub(crate) struct Odd {
    pub rows: Vec<(usize, usize)>,
    pub words: Vec<String>,
}

/// Looks for odd stretches.
///
/// # Errors
/// [`CompareError`] where the model has no answer at the baseline.
pub(crate) fn odd(problem: &Problem, prepared: &Prepared) -> Result<Option<Odd>, CompareError> {
    if !problem.is_cut() {
        return Ok(None);
    }
    let all = stretches(problem, prepared)?;
    let mut means: Vec<f64> = all.iter().map(Stretch::mean).collect();
    means.sort_by(f64::total_cmp);
    let usual = means.get(means.len() / 2).copied().unwrap_or(1.0).max(1.0);
    let (bad, rest): (Vec<&Stretch>, Vec<&Stretch>) = all.iter().partition(|stretch| stretch.mean() > ODD * usual);
    let starts = bad.iter().all(|stretch| stretch.number == 0);
    let sum = |stretches: &[&Stretch], f: &dyn Fn(&Stretch) -> f64| stretches.iter().map(|s| f(s)).sum::<f64>();
    let share = sum(&bad, &|s| s.count) / (sum(&bad, &|s| s.count) + sum(&rest, &|s| s.count)).max(1.0);
    let elsewhere = sum(&rest, &|s| s.squares) / sum(&rest, &|s| s.count).max(1.0);
    let most = if starts { ODD_START } else { ODD_SHARE };
    if bad.is_empty() || share > most || elsewhere > ODD_ELSEWHERE {
        return Ok(None);
    }
    if bad.iter().any(|stretch| stretch.number > 0 && is_of_the_model(problem, stretch, &bad)) {
        return Ok(None);
    }
    let excess = sum(&bad, &|s| s.squares - s.count);
    if best_gain(problem, prepared)? > ODD_EXPLAINED * excess {
        return Ok(None);
    }
    let rows = bad.iter().flat_map(|stretch| stretch.rows.clone().map(|row| (stretch.run, row))).collect();
    Ok(Some(Odd { rows, words: words(problem, &bad) }))
}

fn stretches(problem: &Problem, prepared: &Prepared) -> Result<Vec<Stretch>, CompareError> {
    let whitening = prepared.noise.whitening(problem, &|_, _| true).ok_or(CompareError::NoFit)?;
    let layout = &problem.layout;
    let difference: Vec<f64> = prepared.modelled.iter().zip(&layout.measured).map(|(m, y)| m - y).collect();
    let mut squares: BTreeMap<(usize, usize), (f64, f64)> = BTreeMap::new();
    for (value, at) in whitening.apply(&difference).iter().zip(whitening.places()) {
        let Some(block) = layout.blocks.iter().find(|block| block.range.contains(&at)) else { continue };
        let entry = squares.entry((block.run, at - block.range.start)).or_default();
        *entry = (entry.0 + value * value, entry.1 + 1.0);
    }
    let mut all: Vec<Stretch> = Vec::new();
    let drives = |(k, _): &(usize, &Run)| problem.experiment.kind_of_run(*k) == Kind::Traverse;
    for (k, run) in problem.experiment.runs.iter().enumerate().filter(drives) {
        let time = run.data.column("time").unwrap_or_default();
        let place =
            layout.of_run(k).find(|block| block.is_place()).map(|block| &prepared.modelled[block.range.clone()]);
        for (row, t) in time.iter().enumerate() {
            let number = ((t - time[0]) / LENGTH) as usize;
            let new = all.last().is_none_or(|last| (last.run, last.number) != (k, number));
            if new {
                all.push(Stretch { run: k, rows: row..row, number, squares: 0.0, count: 0.0, place: None });
            }
            let Some(stretch) = all.last_mut() else { continue };
            stretch.rows.end = row + 1;
            if let Some((sum, count)) = squares.get(&(k, row)) {
                stretch.squares += sum;
                stretch.count += count;
            }
            if let Some(x) = place.map(|x| x[row]).filter(|x| !x.is_nan()) {
                let [low, high] = stretch.place.unwrap_or([x, x]);
                stretch.place = Some([low.min(x), high.max(x)]);
            }
        }
    }
    all.retain(|stretch| stretch.count > 0.0);
    Ok(all)
}

/// Whether a repeat is odd at the same time, or another run at the same place.
fn is_of_the_model(problem: &Problem, stretch: &Stretch, bad: &[&Stretch]) -> bool {
    let runs = &problem.experiment.runs;
    bad.iter().any(|other| {
        let group = runs[stretch.run].group.is_some() && runs[stretch.run].group == runs[other.run].group;
        let near = match (stretch.place, other.place) {
            (Some(a), Some(b)) => a[0] < b[1] + SAME_PLACE && b[0] < a[1] + SAME_PLACE,
            _ => false,
        };
        let same_ground = runs[stretch.run].terrain == runs[other.run].terrain;
        other.run != stretch.run && (group && other.number == stretch.number || same_ground && near)
    })
}

/// The largest gain that a single effect promises, by the sensitivities.
fn best_gain(problem: &Problem, prepared: &Prepared) -> Result<f64, CompareError> {
    let whitening = prepared.noise.whitening(problem, &|_, _| true).ok_or(CompareError::NoFit)?;
    let context = StageContext::new(problem, prepared, &whitening, 0);
    let control = super::control::Control::default();
    let stage = Stage::new(&context, &[], prepared.baseline.clone(), &control)?;
    Ok(stage.gains.singles.iter().map(|(gain, ..)| *gain).fold(0.0, f64::max))
}

fn words(problem: &Problem, bad: &[&Stretch]) -> Vec<String> {
    let runs = &problem.experiment.runs;
    let starts: Vec<usize> = bad.iter().filter(|stretch| stretch.number == 0).map(|stretch| stretch.run).collect();
    let mut words = Vec::new();
    if starts.len() * 2 > runs.len() && runs.len() > 1 {
        words.push(format!(
            "the first {LENGTH:.0} s of {} of {} runs differ from the rest: contacts at the start; not counted",
            starts.len(),
            runs.len()
        ));
    } else {
        words.extend(starts.iter().map(|run| {
            format!(
                "the first {LENGTH:.0} s of run {} differ from the rest: contacts at the start; not counted",
                runs[*run].name
            )
        }));
    }
    for stretch in bad.iter().filter(|stretch| stretch.number > 0) {
        let run = &runs[stretch.run];
        let time = run.data.column("time").unwrap_or_default();
        words.push(format!(
            "run {} differs from the rest from {:.1} to {:.1} s, by {:.0} times the noise, and no effect accounts for it: not counted",
            run.name,
            time[stretch.rows.start],
            time[stretch.rows.end - 1],
            stretch.mean().sqrt()
        ));
    }
    words
}
