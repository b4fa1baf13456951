//! The rover on its ground, measured and modelled, at a time that the reader chooses.

use super::map::{COLOURS, LARGE};
use super::stretch::reasons;
use crate::diagnosis::{Fit, Ground, Motion};
use crate::report::page::escape;
use crate::report::plots::{REASONS, View};
use serde_json::{Value, json};

/// Rows over all runs that a page holds at most; more are thinned evenly.
const MOST_ROWS: usize = 8000;
/// Rows around a row over which its error is averaged.
const AROUND: usize = 5;
/// Ground that is shown before and behind a drive, m.
const MARGIN: f64 = 1.0;
/// Points of the ground at most.
const MOST_POINTS: usize = 400;

/// Markup and data; `None` where the motion of no model is known.
pub(super) fn scene(view: &View) -> Option<String> {
    let first = view.shown()?.fit.motion.first()?;
    let runs: Vec<Value> = (0..view.experiment.runs.len()).map(|run| of_run(view, run)).collect();
    let models: Vec<Value> = view
        .models
        .iter()
        .filter(|model| !model.fit.motion.is_empty())
        .map(|model| json!({ "key": model.key, "name": model.name, "short": model.short, "colour": model.colour }))
        .collect();
    let reasons: Vec<&str> = REASONS.iter().map(|(why, _)| why.name()).collect();
    let data = json!({
        "runs": runs, "models": models, "reasons": reasons, "measure": view.measure(), "radius": number(first.radius),
        "shown": view.shown()?.key, "colours": COLOURS.iter().map(|(at, colour)| json!([at, colour])).collect::<Vec<_>>(), "large": LARGE,
    });
    let options = |names: &mut dyn Iterator<Item = (String, String, bool)>| {
        names
            .map(|(value, name, chosen)| {
                let chosen = if chosen { " selected" } else { "" };
                format!("<option value=\"{}\"{chosen}>{}</option>", escape(&value), escape(&name))
            })
            .collect::<String>()
    };
    let of_runs = options(
        &mut view
            .experiment
            .runs
            .iter()
            .enumerate()
            .map(|(k, run)| (k.to_string(), format!("{}: {}", k + 1, run.name), k == 0)),
    );
    let shown = view.shown()?.key;
    let with_motion = view.models.iter().filter(|model| !model.fit.motion.is_empty());
    let of_models =
        options(&mut with_motion.map(|model| (model.key.to_owned(), model.name.clone(), model.key == shown)));
    // A tag inside a string of the data would end the script.
    let json = data.to_string().replace('<', "\\u003c");
    Some(format!(
        "<div class=\"scene\">\n<div class=\"controls\"><label>Run <select class=\"run\">{of_runs}</select></label>\
         <label>Model <select class=\"model\">{of_models}</select></label></div>\n\
         <figure><figcaption>The whole run, height exaggerated; the ground is coloured by the error of the worst signal there over its {}</figcaption>\
         <div class=\"whole-run\" role=\"img\" aria-label=\"The whole run\"></div></figure>\n\
         <div class=\"controls timeline\"><button type=\"button\" class=\"play\">Play</button>\
         <input type=\"range\" class=\"time\" min=\"0\" value=\"0\" step=\"1\" aria-label=\"Time\"></div>\n\
         <p class=\"readout\" aria-live=\"off\"></p>\n\
         <figure><figcaption>To scale at this time: the measured rover as a ghost, the model in colour</figcaption>\
         <div class=\"rover-view\" role=\"img\" aria-label=\"The rover at the chosen time\"></div></figure>\n\
         <script type=\"application/json\" class=\"scene-data\">{json}</script></div>",
        view.measure()
    ))
}

/// A number of a scene: a tenth of a millimetre is less than a screen shows; null where it is not finite.
fn number(value: f64) -> Value {
    if value.is_finite() { json!((value * 1e4).round() / 1e4) } else { Value::Null }
}

fn numbers(values: impl Iterator<Item = f64>) -> Value {
    values.map(number).collect()
}

fn of_run(view: &View, run: usize) -> Value {
    let own = &view.experiment.runs[run];
    let total: usize = view.experiment.runs.iter().map(|run| run.data.rows()).sum();
    let rows: Vec<usize> = (0..own.data.rows()).step_by(total.div_ceil(MOST_ROWS).max(1)).collect();
    let column = |name: &str| {
        let measured = own.measured.iter().any(|signal| signal == name);
        measured.then(|| numbers(rows.iter().map(|row| own.data.value(name, *row).unwrap_or(f64::NAN))))
    };
    let why = reasons(view, run);
    let code =
        |row: &usize| why[*row].map_or(0, |why| 1 + REASONS.iter().position(|(own, _)| *own == why).unwrap_or(0));
    let models: serde_json::Map<String, Value> = view
        .models
        .iter()
        .filter_map(|model| {
            let motion = model.fit.motion.get(run)?;
            Some((model.key.to_owned(), of_model(view, model.fit, motion, run, &rows)))
        })
        .collect();
    json!({
        "name": own.name,
        "time": numbers(rows.iter().map(|row| own.data.value("time", *row).unwrap_or(f64::NAN))),
        "ground": ground(view, run),
        "measured": { "x": column("x"), "z": column("z"), "pitch": column("pitch") },
        "why": rows.iter().map(code).collect::<Vec<_>>(),
        "models": models,
    })
}

fn of_model(view: &View, fit: &Fit, motion: &Motion, run: usize, rows: &[usize]) -> Value {
    let chassis = |part: usize| numbers(rows.iter().map(|row| motion.chassis[*row][part]));
    let wheels = motion.centres.first().map_or(0, Vec::len);
    let centre = |wheel: usize, part: usize| numbers(rows.iter().map(|row| motion.centres[*row][wheel][part]));
    json!({
        "x": chassis(0), "z": chassis(1), "pitch": chassis(2),
        "wheels": (0..wheels).map(|wheel| [centre(wheel, 0), centre(wheel, 1)]).collect::<Vec<_>>(),
        "slope": numbers(rows.iter().map(|row| motion.slope[*row])),
        "error": numbers(rows.iter().map(|row| error(view, fit, run, *row))),
    })
}

/// Error of the worst signal around a row, in its noise.
fn error(view: &View, fit: &Fit, run: usize, row: usize) -> f64 {
    let Some(own) = fit.runs.get(run) else { return f64::NAN };
    let of_signal = |signal: &crate::diagnosis::SignalFit| {
        let around = row.saturating_sub(AROUND)..(row + AROUND + 1).min(signal.residual.len());
        if own.signals.iter().all(|signal| signal.residual[row].is_nan()) {
            return f64::NAN;
        }
        let present = signal.residual[around].iter().filter(|residual| !residual.is_nan());
        let (sum, count) = present.fold((0.0, 0), |(sum, count), residual| (sum + residual * residual, count + 1));
        (sum / f64::from(count)).sqrt() / view.scale(&signal.signal)
    };
    // `max` leaves out what is not a number.
    own.signals.iter().map(of_signal).fold(f64::NAN, f64::max)
}

/// Points of the ground under the drive.
fn ground(view: &View, run: usize) -> Value {
    let ground = Ground::of_run(&view.experiment.runs[run]);
    let reached = view.models.iter().filter_map(|model| model.fit.motion.get(run)).flat_map(|motion| &motion.chassis);
    let measured = view.experiment.runs[run].data.column("x").unwrap_or_default().iter().copied();
    let places = reached.map(|chassis| chassis[0]).chain(measured).filter(|x| x.is_finite());
    let (low, high) = places.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(x), high.max(x)));
    if low > high {
        return json!([[], []]);
    }
    let (low, high) = (low - MARGIN, high + MARGIN);
    let mut x: Vec<f64> = ground.points().map(|[x, _]| x).filter(|x| (low..=high).contains(x)).collect();
    x = x.iter().copied().step_by(x.len().div_ceil(MOST_POINTS).max(1)).collect();
    x.insert(0, low);
    x.push(high);
    json!([numbers(x.iter().copied()), numbers(x.iter().map(|x| ground.height(*x)))])
}
