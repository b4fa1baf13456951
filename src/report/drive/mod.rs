//! The part of a page that tells of a traverse as a drive: where it fails at a glance, under which conditions, what was not
//! counted and why.

mod places;
mod stretch;

use crate::diagnosis::{Uncounted, UncountedGroup, UncountedRows};
use crate::measurement::Kind;
use crate::report::page::{Page, escape, table};
use crate::report::plots::View;
use crate::report::units::{digits, of_column, spoken};
use stretch::{Stretch, stretches};

/// Reasons for which rows do not count, in the order in which they are told.
const REASONS: [Uncounted; 5] =
    [Uncounted::Start, Uncounted::Gap, Uncounted::Odd, Uncounted::NoAnswer, Uncounted::Spared];
/// A window stands out where a signal misses by this many times its noise: noise that a window has in common seldom reaches it.
const STANDS_OUT: f64 = 2.0;
/// Windows that the text names, and rows of the table of what does not count.
const NAMED: usize = 3;
const LISTED: usize = 12;

/// Whether the experiment is a drive and a model's motion is known.
pub(super) fn is_shown(view: &View) -> bool {
    view.experiment.kind == Kind::Traverse && !view.model.fit.motion.is_empty()
}

/// What stands on the first screen: the worst windows, and what was not counted. Empty where there is no drive.
pub(super) fn at_first_sight(view: &View) -> String {
    if !is_shown(view) {
        return String::new();
    }
    let mut html = format!("<p><strong>Where it fails:</strong> {}</p>", escape(&worst_windows(view)));
    html.push_str(&format!("<p><strong>Not counted:</strong> {}</p>", escape(&not_counted(view))));
    format!("<div class=\"drive-facts\">{html}</div>")
}

/// The section itself, under its heading; `radius` is that of the wheels, m.
pub(super) fn add(page: &mut Page, view: &View, radius: f64) {
    if !is_shown(view) {
        return;
    }
    page.html(&format!("<p class=\"lead\">{}{}</p>", escape(&ghost(view)), usual_error(view)));
    page.html("<h3>Under which conditions</h3>");
    page.html(&format!(
        "<p class=\"lead\">Mean residual (measured less model) where it is largest along each condition, over the signal's {}, and where that is. Loads are \
         those of the model.</p>",
        view.measure()
    ));
    page.html(&places::table(view, radius));
    page.html("<h3>What is not counted, and why</h3>");
    page.html(&uncounted(view));
}

/// What stands in for a noise that is not known.
fn usual_error(view: &View) -> &'static str {
    if view.measure() == "noise" {
        ""
    } else {
        " Where a noise is not known, nothing says how large an error would be by chance: the usual error, the RMS over all rows that count, stands in \
         for it, so that colours tell where the model is worse than elsewhere."
    }
}

/// What is known of the measured rover.
fn ghost(view: &View) -> String {
    let measured = |name: &str| view.experiment.runs.iter().any(|run| run.measured.iter().any(|own| own == name));
    if !measured("x") {
        return "No position was measured, so that nothing tells where the rover was: only the model is drawn."
            .to_owned();
    }
    let missing: Vec<&str> = [("z", "height"), ("pitch", "pitch")]
        .iter()
        .filter(|(name, _)| !measured(name))
        .map(|(_, word)| *word)
        .collect();
    if missing.is_empty() {
        "The ghost stands where position, height and pitch were measured.".to_owned()
    } else {
        format!(
            "The ghost stands at the measured position. Its {} was not measured and is the model's, carried along the ground.",
            missing.join(" and its ")
        )
    }
}

/// The windows that stand out most, in words.
fn worst_windows(view: &View) -> String {
    let all = stretches(view);
    let counted = all.iter().filter(|stretch| stretch.why.is_none() && !stretch.ratios.is_empty());
    let mut counted: Vec<&Stretch> = counted.collect();
    counted.sort_by(|a, b| b.worst().total_cmp(&a.worst()));
    let out = counted.iter().filter(|stretch| stretch.worst() >= STANDS_OUT).count();
    let total = counted.len();
    let name = view.model.name;
    let measure = view.measure();
    if out == 0 {
        return format!("in no window of {total} is an error of {name} {STANDS_OUT:.0} times its {measure} or more.");
    }
    let one = |stretch: &&Stretch| {
        let run = &view.experiment.runs[stretch.run].name;
        let (signal, ratio) = &stretch.ratios[0];
        let [from, to] = stretch.seconds;
        let ground = ground_under(view, stretch).map_or_else(String::new, |ground| format!(", {ground}"));
        format!(
            "run {run} at {from:.1} to {to:.1} s{ground}: {} {} times its {measure}",
            spoken(signal),
            digits(*ratio)
        )
    };
    let worst: Vec<String> = counted.iter().take(NAMED.min(out)).map(one).collect();
    format!(
        "{out} of {total} windows have a signal in which {name} is off by {STANDS_OUT:.0} times its {measure} or more; the worst are {}.",
        worst.join("; ")
    )
}

/// Position and slope of the ground under a stretch.
fn ground_under(view: &View, stretch: &Stretch) -> Option<String> {
    let motion = view.model.fit.motion.get(stretch.run)?;
    let range = |values: &mut dyn Iterator<Item = f64>| {
        values
            .filter(|value| value.is_finite())
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| (low.min(value), high.max(value)))
    };
    let (x0, x1) = range(&mut motion.chassis[stretch.rows.clone()].iter().map(|chassis| chassis[0]));
    let (s0, s1) = range(&mut motion.slope[stretch.rows.clone()].iter().copied());
    let degrees = of_column("pitch").factor;
    let slope = if s0 == s1 {
        String::new()
    } else {
        format!(", slope {:.0} to {:.0}\u{b0}", (s0 * degrees).round() + 0.0, (s1 * degrees).round() + 0.0)
    };
    // No sign before a zero.
    let [x0, x1] = [x0, x1].map(|x| (10.0 * x).round() / 10.0 + 0.0);
    (x0 <= x1).then(|| format!("x {x0:.1} to {x1:.1} m{slope}"))
}

/// How many rows do not count for which reason.
fn not_counted(view: &View) -> String {
    let total: usize = view.experiment.runs.iter().map(|run| run.data.rows()).sum();
    let count = |why: Uncounted| -> (usize, usize) {
        let own: Vec<&UncountedRows> = view.uncounted.iter().filter(|rows| rows.why == why).collect();
        (own.iter().map(|rows| rows.count()).sum(), own.len())
    };
    let one = |why: &Uncounted| {
        let (rows, places) = count(*why);
        let several = |one: &str, many: &str| format!("{places} {}", if places == 1 { one } else { many });
        let place = match why {
            Uncounted::Start => format!("at the start of {}", several("run", "runs")),
            Uncounted::Gap => format!("behind {} in the recording", several("gap", "gaps")),
            Uncounted::Odd => format!("in {}", several("odd stretch", "odd stretches")),
            Uncounted::Spared => format!("in {} that judge the final model", several("stretch", "stretches")),
            Uncounted::NoAnswer => format!("in {} where the model has no answer", several("stretch", "stretches")),
        };
        (rows > 0).then(|| format!("{rows} {place}"))
    };
    let parts: Vec<String> = REASONS.iter().filter_map(one).collect();
    if parts.is_empty() {
        return format!("nothing; all {total} rows count.");
    }
    let all: usize = view.uncounted.iter().map(UncountedRows::count).sum();
    format!("{all} of {total} rows: {}.", parts.join(", "))
}

/// The table of rows that do not count; runs that share a reason and its length stand together.
fn uncounted(view: &View) -> String {
    if view.uncounted.is_empty() {
        return "<p>Every row counts.</p>".to_owned();
    }
    let row =
        |group: &UncountedGroup| vec![group.runs(), group.when(), group.count().to_string(), group.reason().to_owned()];
    let cells: Vec<Vec<String>> = UncountedGroup::of(view.uncounted).iter().map(row).collect();
    let header = ["run", "when", "rows", "why"];
    let shown = |rows: &[Vec<String>]| format!("<div class=\"words\">{}</div>", table(&header, rows));
    let open = shown(&cells[..cells.len().min(LISTED)]);
    if cells.len() <= LISTED {
        return open;
    }
    let rest = cells.len() - LISTED;
    format!("{open}<details><summary>{rest} more</summary>{}</details>", shown(&cells[LISTED..]))
}
