//! Where the baseline fails, and what the final model leaves.

use super::words::{listed, percent};
use super::{begin, noise};
use crate::diagnosis::{Diagnosis, Failure, Fit, Verdict};
use crate::report::page::{Page, escape};
use crate::report::plots::{Condition, Samples, conditions, residuals};
use crate::report::units::spoken;
use crate::report::words::sentence;

/// Sentences on where the model fails.
const MOST_SENTENCES: usize = 4;
/// Plots that stand open; the rest is folded away.
const OPEN_PLOTS: usize = 6;
/// Runs differ in their conditions, so that a misfit along those shows along the runs too; a drift shows along nothing else.
const RUN_WEIGHT: f64 = 0.5;

/// What the plots of residuals show.
const RESIDUALS: &str = "Residuals (measured less model) against the conditions, a colour a group of repeats where these are few. The grey \
                         band is two standard deviations of the noise of one sample. Diamonds are means at set-points; where a condition takes values all along, the line is a smooth \
                         (local lines over three quarters of the samples). Bars and band of the mean are two standard errors, as if samples were \
                         independent: a mean that stays away from zero is structure, not noise.";

/// Where the calibrated baseline fails.
pub(super) fn add_failures(page: &mut Page, diagnosis: &Diagnosis) {
    begin(page, "fails", RESIDUALS);
    page.html(&sentences(&diagnosis.failures));
    let samples = all_samples(diagnosis, &diagnosis.baseline().fit);
    let plots: Vec<_> =
        samples.iter().map(|own| (title(own), residuals(own, deviation(diagnosis, &own.signal), None))).collect();
    let open = OPEN_PLOTS.min(plots.len());
    page.plots(&plots[..open]);
    if plots.len() > open {
        page.html(&format!("<details><summary>{} more conditions, smaller means</summary>", plots.len() - open));
        page.plots(&plots[open..]);
        page.html("</details>");
    }
}

/// Residuals of the final model, the baseline's means beside them.
pub(super) fn add_residuals_left(page: &mut Page, diagnosis: &Diagnosis) {
    let before = all_samples(diagnosis, &diagnosis.baseline().fit);
    let plots: Vec<_> = before
        .iter()
        .take(OPEN_PLOTS)
        .filter_map(|before| {
            let left = Samples::new(&diagnosis.experiment, &diagnosis.last().fit, &before.signal, &before.condition)?;
            Some((title(&left), residuals(&left, deviation(diagnosis, &left.signal), Some(before))))
        })
        .collect();
    page.html("<h3>Residuals left</h3>");
    page.plots(&plots);
}

/// What the final model leaves.
pub(super) fn add_remains(page: &mut Page, diagnosis: &Diagnosis) {
    let left = diagnosis.last().left;
    let lead = match diagnosis.verdict {
        Verdict::Explained => "Only noise, as far as this experiment shows.".to_owned(),
        Verdict::Undetermined if diagnosis.steps.len() == 1 => {
            "Nothing that stands out from the noise; see the cautions on what could hide in it.".to_owned()
        }
        _ if diagnosis.steps.len() == 1 => "All of it: no effect was added.".to_owned(),
        Verdict::Unexplained => format!(
            "Of what could be explained the final model leaves {}. It follows the conditions, so it is no noise, and no effect of the library \
             has its shape.",
            percent(left)
        ),
        _ => format!(
            "Of what could be explained the final model leaves {}. An effect in nature has another form than in the library: a few per cent \
             left is form error of the same effect, not a second one.",
            percent(left)
        ),
    };
    begin(page, "remains", &lead);
    page.html(&sentences(&diagnosis.failures_left));
    if !diagnosis.confused_with.is_empty() {
        let pairs: Vec<String> = diagnosis.confused_with.iter().map(|pair| listed(pair, "and")).collect();
        page.html(&format!("<p>This experiment hardly tells apart: {}.</p>", escape(&pairs.join("; "))));
    }
}

/// The failures that exceed the noise of one sample, in words.
fn sentences(failures: &[Failure]) -> String {
    let clear = |failure: &&Failure| failure.ratio().is_none_or(|ratio| ratio > 1.0);
    let item = |failure: &Failure| format!("<li>{}</li>", escape(&sentence(failure)));
    let items: String = failures.iter().filter(clear).take(MOST_SENTENCES).map(item).collect();
    if items.is_empty() {
        "<p>No mean residual exceeds the noise of one sample.</p>".to_owned()
    } else {
        format!("<ul>{items}</ul>")
    }
}

fn title(samples: &Samples) -> String {
    format!("{} against {}", spoken(&samples.signal), samples.condition.name())
}

/// Standard deviation of one sample, as the diagnosis weighs it; for a quantity of all wheels the largest.
fn deviation(diagnosis: &Diagnosis, signal: &str) -> Option<f64> {
    let own = |name: &str| name == signal || name.rsplit('.').next() == Some(signal);
    noise(diagnosis).into_iter().filter(|(name, _)| own(name)).map(|(_, own)| own).reduce(f64::max)
}

/// Every signal against every condition, the largest mean residual against the noise first.
fn all_samples(diagnosis: &Diagnosis, fit: &Fit) -> Vec<Samples> {
    let experiment = &diagnosis.experiment;
    let all = conditions(experiment, diagnosis.improved.rover.wheel.radius);
    let samples = all.iter().filter_map(|(signal, condition)| Samples::new(experiment, fit, signal, condition));
    let weight = |own: &Samples| if own.condition == Condition::Run { RUN_WEIGHT } else { 1.0 };
    let size = |own: &Samples| weight(own) * own.worst() / scale(diagnosis, &own.signal);
    let mut samples: Vec<(f64, Samples)> = samples.map(|own| (size(&own), own)).collect();
    samples.sort_by(|a, b| b.0.total_cmp(&a.0));
    samples.into_iter().map(|(_, own)| own).collect()
}

/// The noise of one sample, or where it is unknown the baseline's error.
fn scale(diagnosis: &Diagnosis, signal: &str) -> f64 {
    let rmse = || diagnosis.baseline().rmse.get(signal).copied();
    deviation(diagnosis, signal).or_else(rmse).filter(|scale| *scale > 0.0).unwrap_or(1.0)
}
