//! The candidates side by side.

use super::{COLOURS, GREY, axis, layout_with, rounded};
use crate::diagnosis::Diagnosis;
use crate::report::units::spoken;
use plotly::common::{Marker, Orientation};
use plotly::layout::AxisType;
use plotly::{Bar, Plot};

/// Candidates drawn; the table has all of them.
const MOST_BARS: usize = 10;

/// Probability of each candidate, of "enough already" and of "something else", the most probable on top.
pub(in crate::report) fn probabilities(diagnosis: &Diagnosis) -> Plot {
    let candidates = diagnosis.candidates.iter().take(MOST_BARS).map(|candidate| {
        let named = diagnosis.effects.contains(&candidate.effect);
        (
            bar_name(&candidate.effect, candidate.tied),
            candidate.probability,
            if named { COLOURS[1] } else { COLOURS[0] },
        )
    });
    let mut bars: Vec<(String, f64, &str)> = candidates.collect();
    bars.push(("enough already".to_owned(), diagnosis.share.enough, COLOURS[2]));
    bars.push(("something else".to_owned(), diagnosis.share.other, GREY));
    bars.sort_by(|a, b| a.1.total_cmp(&b.1));
    horizontal(bars, "probability")
}

fn bar_name(effect: &str, tied: bool) -> String {
    if tied { format!("{} (tied)", spoken(effect)) } else { spoken(effect) }
}

/// The share of each effect's signature that calibration cannot absorb, the most visible on top.
pub(in crate::report) fn visible_shares(diagnosis: &Diagnosis) -> Plot {
    let mut bars: Vec<(String, f64, &str)> = diagnosis
        .candidates
        .iter()
        .map(|candidate| (spoken(&candidate.effect), candidate.visible_share, COLOURS[0]))
        .collect();
    bars.sort_by(|a, b| a.1.total_cmp(&b.1));
    horizontal(bars, "share left after calibration")
}

fn horizontal(bars: Vec<(String, f64, &'static str)>, title: &str) -> Plot {
    let names = bars.iter().map(|(name, ..)| name.clone()).collect();
    let values = bars.iter().map(|(_, value, _)| rounded(*value)).collect();
    let colours = bars.iter().map(|(.., colour)| *colour).collect();
    let mut plot = Plot::new();
    plot.add_trace(
        Bar::new(values, names).orientation(Orientation::Horizontal).marker(Marker::new().color_array(colours)),
    );
    let mut layout = layout_with(axis(title).range(vec![0.0, 1.0]), axis("").type_(AxisType::Category), false);
    layout = layout.height(70 + 24 * bars.len());
    plot.set_layout(layout);
    plot
}
