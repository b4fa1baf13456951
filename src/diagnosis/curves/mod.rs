//! The model as curves beside the points of a wheel on a carriage.
//!
//! Recorded inputs are never exactly equal, so that lines from one modelled row to the next would be zigzags, or there
//! would be no line at all. A curve is the model on a grid of one input, the axis, at the typical other inputs of a group
//! of rows, with a band for the differences of these inputs within the group.
//!
//! **Groups.** Rows belong together where their rigs have the same parameters and their other inputs the same set-points.
//! Values are set-points where they stand in at most ten classes that lie apart by more than 5 % of the largest value (of
//! slip by more than 0.02) and by more than twice the width of the widest class; otherwise all rows are one class, whose
//! differences are accidental.
//!
//! **Speed.** Either the wheel's speed is held or the carriage's, and then the wheel's speed follows from the slip: it is
//! that of the two which falls into fewer classes.
//!
//! **Typical inputs** of a group are the means, or, where a smooth over the axis accounts for 80 % of an input's variance,
//! the smooth: such an input follows the axis. The **band** is the range of the model over the lowest and highest
//! deviation of each of these inputs from the typical one in the group.

mod inputs;
mod set_points;

use super::calibrate::{CalibratedParameter, Calibration};
use super::diagnose::Step;
use super::problem::Problem;
use crate::carriage::{Rig, steady_point};
use crate::measurement::Sample;
use crate::parallel::map_in_order;
use inputs::{Held, Inputs, LEAST_SHARE, LEAST_SLIP, Row, rows};
use serde::Serialize;
use set_points::class_of;
pub(crate) use set_points::set_points;
use std::collections::BTreeMap;

/// Intervals of the grid of a curve.
const INTERVALS: usize = 60;

/// An input that changes by less than this share of its largest size is no axis.
const LEAST_RANGE: f64 = 0.3;

/// The input over which curves are drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Axis {
    /// Slip.
    Slip,
    /// Load, N.
    Load,
    /// Wheel speed, rad/s.
    WheelSpeed,
}

impl Axis {
    /// All, the most usual first.
    pub const ALL: [Self; 3] = [Self::Slip, Self::Load, Self::WheelSpeed];

    /// The column of an experiment.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Slip => "slip",
            Self::Load => "load",
            Self::WheelSpeed => "wheel_speed",
        }
    }
}

/// The model over one input, by group of rows and model. SI units; NaN (null in JSON) where the model has no answer.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Curves {
    /// The input along the curves.
    pub axis: Axis,
    /// Rows that belong together.
    pub groups: Vec<CurveGroup>,
}

/// Rows that belong together, and the model at their typical inputs.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct CurveGroup {
    /// The set-points that identify the group, SI units; empty where it is the only one.
    pub name: String,
    /// Run and row of each point, counted from 0.
    pub rows: Vec<(usize, usize)>,
    /// Lowest and highest load of the rows, N.
    pub loads: (f64, f64),
    /// Lowest and highest slip.
    pub slips: (f64, f64),
    /// Lowest and highest wheel speed, rad/s.
    pub wheel_speeds: (f64, f64),
    /// Values of the axis, rising; empty where the rows lie at one place of the axis.
    pub at: Vec<f64>,
    /// The typical inputs there: load (N), slip, wheel speed (rad/s).
    pub inputs: Vec<[f64; 3]>,
    /// One entry a model.
    pub models: Vec<ModelCurves>,
}

/// The curves of one model.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ModelCurves {
    /// The step of the diagnosis: 0 is the calibrated baseline; `None` is the model as given.
    pub step: Option<usize>,
    /// By signal.
    pub signals: BTreeMap<String, Curve>,
}

/// One signal of a model over the grid of its group.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Curve {
    /// At the typical inputs.
    pub value: Vec<f64>,
    /// Lowest value over the range of the group's inputs.
    pub low: Vec<f64>,
    /// Highest value.
    pub high: Vec<f64>,
}

/// Values of parameters by name.
type Values = Vec<(String, f64)>;

/// Curves of a diagnosis: of the model as given and of each step.
pub(crate) fn curves_of_steps(problem: &Problem, steps: &[Step]) -> Vec<Curves> {
    let values = |step: &Step| step.parameters.iter().map(|parameter| pair(&parameter.fitted)).collect();
    let steps = steps.iter().enumerate().map(|(k, step)| (Some(k), values(step)));
    curves(problem, &[(None, Vec::new())].into_iter().chain(steps).collect::<Vec<_>>())
}

/// Curves of a comparison: of the model as given and, where there was a calibration, after it.
pub(crate) fn curves_of_calibration(problem: &Problem, calibration: Option<&Calibration>) -> Vec<Curves> {
    let calibrated = calibration.map(|found| (Some(0), found.parameters.iter().map(pair).collect()));
    curves(problem, &[(None, Vec::new())].into_iter().chain(calibrated).collect::<Vec<_>>())
}

/// The model with these parameters over one input, at the typical inputs of each group only, so that it takes milliseconds: low and
/// high are those values. `None` where the input was not varied.
pub(super) fn sketch(problem: &Problem, axis: Axis, values: Values) -> Option<Curves> {
    if !problem.strategy().axes().contains(&axis) {
        return None;
    }
    let rows = rows(&problem.experiment);
    over(problem, &rows, axis, &[(None, values)], Ends::Typical)
}

fn pair(fitted: &CalibratedParameter) -> (String, f64) {
    (fitted.variable.name.clone(), fitted.value)
}

/// Curves over every input that was varied, the most usual one first; none for a traverse. `models` are the steps, each
/// with its parameters; parameters that are not listed keep what is known of the rig.
fn curves(problem: &Problem, models: &[(Option<usize>, Values)]) -> Vec<Curves> {
    let axes = problem.strategy().axes();
    if axes.is_empty() {
        return Vec::new();
    }
    let rows = rows(&problem.experiment);
    axes.iter().filter_map(|axis| over(problem, &rows, *axis, models, Ends::All)).collect()
}

/// Which inputs of a group a model is asked about.
#[derive(Clone, Copy, PartialEq)]
enum Ends {
    Typical,
    /// And the lowest and highest in the group.
    All,
}

/// Curves over one input; `None` where it was not varied.
fn over(problem: &Problem, rows: &[Row], axis: Axis, models: &[(Option<usize>, Values)], ends: Ends) -> Option<Curves> {
    let held = held(rows);
    let groups = groups(problem, rows, axis, held);
    let axis_varies = groups.iter().any(|group| varies(&group.rows, axis));
    let signals = problem.experiment.signals();
    let drawn = |group: &Group| group.with_models(problem, axis, held, models, &signals, ends);
    axis_varies.then(|| Curves { axis, groups: map_in_order(&groups, drawn) })
}

/// Whether rows lie along an axis, not at one place of it.
fn varies(rows: &[Row], axis: Axis) -> bool {
    let (low, high) = range(rows, |row| row.value(axis));
    let least = if axis == Axis::Slip { LEAST_SLIP } else { LEAST_RANGE * low.abs().max(high.abs()) };
    high - low > least
}

fn range(rows: &[Row], value: impl Fn(&Row) -> f64) -> (f64, f64) {
    let values = rows.iter().map(value);
    values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| (low.min(v), high.max(v)))
}

/// The speed that the rig holds: that which falls into fewer classes, or where neither does, varies less.
fn held(rows: &[Row]) -> Held {
    let width = |held: Held| {
        let classes = speed_classes(rows, held);
        let largest = classes.iter().map(|(low, high)| low.abs().max(high.abs())).fold(f64::MIN_POSITIVE, f64::max);
        let widest = classes.iter().map(|(low, high)| high - low).fold(0.0, f64::max);
        // One class of values all along is no set-point.
        if widest > LEAST_SHARE * largest { f64::INFINITY } else { classes.len() as f64 }
    };
    if width(Held::CarriageSpeed) < width(Held::WheelSpeed) { Held::CarriageSpeed } else { Held::WheelSpeed }
}

fn speed_classes(rows: &[Row], held: Held) -> Vec<(f64, f64)> {
    classes(rows, |row| row.speed(held))
}

/// Set-points of a load or a speed.
fn classes(rows: &[Row], value: impl Fn(&Row) -> f64) -> Vec<(f64, f64)> {
    let values: Vec<f64> = rows.iter().map(value).collect();
    let largest = values.iter().filter(|v| !v.is_nan()).map(|v| v.abs()).fold(0.0, f64::max);
    set_points(values, LEAST_SHARE * largest)
}

/// Rows of one rig and one set-point of each input that is not the axis.
struct Group {
    name: String,
    rows: Vec<Row>,
}

fn groups(problem: &Problem, rows: &[Row], axis: Axis, held: Held) -> Vec<Group> {
    let loads = if axis == Axis::Load { Vec::new() } else { classes(rows, |row| row.load) };
    let slips = if axis == Axis::Slip { Vec::new() } else { set_points(rows.iter().map(|row| row.slip), LEAST_SLIP) };
    let speeds = if axis == Axis::WheelSpeed { Vec::new() } else { speed_classes(rows, held) };
    let runs = &problem.experiment.runs;
    let rig = |run: usize| (0..run).find(|other| runs[*other].parameters == runs[run].parameters).unwrap_or(run);
    let mut found: BTreeMap<(usize, [Option<usize>; 3]), Vec<Row>> = BTreeMap::new();
    for row in rows {
        let place = [
            class_of(&loads, row.load),
            class_of(&slips, row.slip),
            // A locked wheel, whose carriage may have any speed, is of the first class.
            class_of(&speeds, row.speed(held)).or((!speeds.is_empty()).then_some(0)),
        ];
        found.entry((rig(row.at.run), place)).or_default().push(*row);
    }
    let rigs: Vec<usize> = found.keys().map(|(rig, _)| *rig).collect();
    let several_rigs = rigs.windows(2).any(|pair| pair[0] != pair[1]);
    let name = |rig: usize, [load, slip, speed]: [Option<usize>; 3]| {
        let radius = problem.rig(rig, &[]).wheel.radius;
        let mut parts = Vec::new();
        parts.extend(class_name(&loads, load, "", "N", 1.0));
        parts.extend(class_name(&slips, slip, "slip ", "", 1.0));
        parts.extend(match held {
            Held::WheelSpeed => class_name(&speeds, speed, "", "rad/s", 1.0),
            Held::CarriageSpeed => class_name(&speeds, speed, "carriage ", "m/s", radius),
        });
        if several_rigs {
            parts.extend(runs[rig].parameters.iter().map(|(name, value)| format!("{name} = {}", short(*value))));
            parts.extend(runs[rig].parameters.is_empty().then(|| "rig unchanged".to_owned()));
        }
        parts.join(", ")
    };
    found.into_iter().map(|((rig, place), rows)| Group { name: name(rig, place), rows }).collect()
}

/// A class in words, where there are several.
fn class_name(classes: &[(f64, f64)], at: Option<usize>, what: &str, unit: &str, factor: f64) -> Option<String> {
    let (low, high) = *classes.get(at?).filter(|_| classes.len() > 1)?;
    let (low, high) = (short(low * factor), short(high * factor));
    let values = if low == high { low } else { format!("{low} to {high}") };
    Some(format!("{what}{values} {unit}").trim_end().to_owned())
}

/// A number with three digits, without trailing zeros.
fn short(value: f64) -> String {
    let rounded: f64 = format!("{value:.2e}").parse().unwrap_or(value);
    rounded.to_string()
}

impl Group {
    fn with_models(
        &self,
        problem: &Problem,
        axis: Axis,
        held: Held,
        models: &[(Option<usize>, Values)],
        signals: &[String],
        ends: Ends,
    ) -> CurveGroup {
        let Self { name, rows } = self;
        let inputs = Inputs::new(rows, axis, held);
        let (low, high) = range(rows, |row| row.value(axis));
        let at: Vec<f64> = if varies(rows, axis) {
            (0..=INTERVALS).map(|k| low + (high - low) * k as f64 / INTERVALS as f64).collect()
        } else {
            Vec::new()
        };
        let mut grid: Vec<Vec<[f64; 3]>> = at.iter().map(|x| inputs.at(*x)).collect();
        if ends == Ends::Typical {
            grid.iter_mut().for_each(|place| place.truncate(1));
        }
        let rig_of = |values: &Values| problem.rig(rows[0].at.run, values);
        let models = models
            .iter()
            .map(|(step, values)| ModelCurves { step: *step, signals: evaluated(&rig_of(values), &grid, signals) });
        CurveGroup {
            models: models.collect(),
            name: name.clone(),
            loads: range(rows, |row| row.load),
            slips: range(rows, |row| row.slip),
            wheel_speeds: range(rows, |row| row.wheel_speed),
            inputs: grid.iter().map(|ends| ends[0]).collect(),
            rows: rows.iter().map(|Row { at: Sample { run, row }, .. }| (*run, *row)).collect(),
            at,
        }
    }
}

/// The signals of a rig along a grid; `grid` has the typical inputs and their ends for each place.
fn evaluated(rig: &Rig, grid: &[Vec<[f64; 3]>], signals: &[String]) -> BTreeMap<String, Curve> {
    let empty = Curve { value: Vec::new(), low: Vec::new(), high: Vec::new() };
    let mut curves: BTreeMap<String, Curve> = signals.iter().map(|signal| (signal.clone(), empty.clone())).collect();
    for ends in grid {
        // Inputs that a group's deviations make impossible, a load below zero say, have no answer and no part in the band.
        let answers: Vec<_> = ends
            .iter()
            .map(|[load, slip, wheel_speed]| {
                (*load > 0.0).then(|| steady_point(rig, *load, *slip, *wheel_speed).ok()).flatten()
            })
            .collect();
        for (signal, curve) in &mut curves {
            let value = |k: usize| answers[k].as_ref().map_or(f64::NAN, |point| super::kinds::signal(point, signal));
            let middle = value(0);
            // Where the typical inputs have no answer the curve has a gap, and so has its band.
            let all = (0..answers.len()).map(value).filter(|v| !v.is_nan() && !middle.is_nan());
            let (low, high) = all.fold((f64::NAN, f64::NAN), |(low, high), v| (v.min(low), v.max(high)));
            curve.value.push(middle);
            curve.low.push(low);
            curve.high.push(high);
        }
    }
    curves
}
