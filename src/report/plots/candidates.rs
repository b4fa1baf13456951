//! The candidates side by side, as bars that need no script.

use super::figure::GREY;
use crate::diagnosis::Diagnosis;
use crate::report::page::escape;
use crate::report::units::spoken;

/// Candidates drawn; the table has all of them.
const MOST_BARS: usize = 10;

/// Probability of each candidate, of "enough already" and of "something else", the most probable on top.
pub(in crate::report) fn probabilities(diagnosis: &Diagnosis) -> String {
    let candidates = diagnosis.candidates.iter().take(MOST_BARS).map(|candidate| {
        let named = diagnosis.effects.contains(&candidate.effect);
        (bar_name(&candidate.effect, candidate.tied), candidate.probability, if named { 1 } else { 0 })
    });
    let mut bars: Vec<(String, f64, usize)> = candidates.collect();
    bars.push(("enough already".to_owned(), diagnosis.share.enough, 2));
    bars.push(("something else".to_owned(), diagnosis.share.other, GREY));
    horizontal("Probability", bars)
}

fn bar_name(effect: &str, tied: bool) -> String {
    if tied { format!("{} (tied)", spoken(effect)) } else { spoken(effect) }
}

/// The share of each effect's signature that calibration cannot absorb, the most visible on top.
pub(in crate::report) fn visible_shares(diagnosis: &Diagnosis) -> String {
    let bar = |candidate: &crate::diagnosis::CandidateResult| (spoken(&candidate.effect), candidate.visible_share, 0);
    horizontal("Visible share of each effect", diagnosis.candidates.iter().map(bar).collect())
}

/// Bars from 0 to 1, the longest on top; a dash where a value is none.
fn horizontal(title: &str, mut bars: Vec<(String, f64, usize)>) -> String {
    bars.sort_by(|a, b| b.1.total_cmp(&a.1));
    let row = |(name, value, colour): &(String, f64, usize)| {
        let (width, number) = match value.is_finite() {
            true => (100.0 * value.clamp(0.0, 1.0), format!("{value:.2}")),
            false => (0.0, "\u{2013}".to_owned()),
        };
        format!(
            "<tr><th scope=\"row\">{}</th><td><i class=\"bar c{colour}\" style=\"width:{width:.1}%\"></i></td><td>{number}</td></tr>\n",
            escape(name)
        )
    };
    let rows: String = bars.iter().map(row).collect();
    format!("<table class=\"bars\"><caption>{}</caption>\n{rows}</table>\n", escape(title))
}
