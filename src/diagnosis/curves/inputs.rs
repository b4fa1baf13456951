//! The inputs of a group of rows as functions of one of them.

use super::Axis;
use crate::diagnosis::local_line::LocalLine;
use crate::measurement::{Experiment, Sample};

/// An input follows the axis where a smooth over the axis accounts for this share of its variance; otherwise its
/// differences are accidental and the mean stands for it.
const FOLLOWS: f64 = 0.8;

/// Share of the rows to which each local line of that smooth is fitted: half of them follow one bend.
const SPAN: f64 = 0.5;

/// Least difference of two set-points: of loads and speeds this share of the largest, of slips this much.
pub(super) const LEAST_SHARE: f64 = 0.05;
pub(super) const LEAST_SLIP: f64 = 0.02;

/// Which speed a rig holds; the other one follows from the slip.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Held {
    WheelSpeed,
    /// The speed of the carriage over the wheel's radius, rad/s.
    CarriageSpeed,
}

/// Inputs of one row: load (N), slip, wheel speed (rad/s).
#[derive(Clone, Copy, Debug)]
pub(super) struct Row {
    pub at: Sample,
    pub load: f64,
    pub slip: f64,
    pub wheel_speed: f64,
}

impl Row {
    pub fn value(&self, axis: Axis) -> f64 {
        match axis {
            Axis::Slip => self.slip,
            Axis::Load => self.load,
            Axis::WheelSpeed => self.wheel_speed,
        }
    }

    /// The speed held, rad/s; NaN where a locked wheel does not tell that of the carriage.
    pub fn speed(&self, held: Held) -> f64 {
        match held {
            Held::WheelSpeed => self.wheel_speed,
            Held::CarriageSpeed if self.slip >= 0.0 => self.wheel_speed * (1.0 - self.slip),
            Held::CarriageSpeed if self.slip > -1.0 => self.wheel_speed / (1.0 + self.slip),
            Held::CarriageSpeed => f64::NAN,
        }
    }
}

/// All rows whose inputs are there.
pub(super) fn rows(experiment: &Experiment) -> Vec<Row> {
    let mut rows = Vec::new();
    for (run, data) in experiment.runs.iter().enumerate() {
        for row in 0..data.data.rows() {
            let value = |name: &str| data.data.value(name, row).unwrap_or(f64::NAN);
            let (load, slip, wheel_speed) = (value("load"), value("slip"), value("wheel_speed"));
            if !(load.is_nan() || slip.is_nan() || wheel_speed.is_nan()) {
                rows.push(Row { at: Sample { run, row }, load, slip, wheel_speed });
            }
        }
    }
    rows
}

/// An input of a group as a function of the axis, and how far the rows lie from it at most.
struct Trend {
    mean: f64,
    /// The smooth, where the input follows the axis.
    smooth: Option<LocalLine>,
    below: f64,
    above: f64,
}

impl Trend {
    fn new(samples: &[(f64, f64)]) -> Self {
        let present: Vec<(f64, f64)> = samples.iter().copied().filter(|(_, y)| !y.is_nan()).collect();
        let mean = present.iter().map(|(_, y)| y).sum::<f64>() / present.len() as f64;
        let smooth = LocalLine::new(present.iter().copied(), SPAN).filter(|smooth| smooth.explained() > FOLLOWS);
        let mut trend = Self { mean, smooth, below: 0.0, above: 0.0 };
        let apart: Vec<f64> = present.iter().map(|(x, y)| y - trend.at(*x)).collect();
        trend.below = apart.iter().copied().fold(0.0, f64::min);
        trend.above = apart.iter().copied().fold(0.0, f64::max);
        trend
    }

    fn at(&self, x: f64) -> f64 {
        self.smooth.as_ref().map_or(self.mean, |smooth| smooth.at(x).value)
    }

    /// The typical value, then the lowest and the highest.
    fn ends(&self, x: f64) -> [f64; 3] {
        let middle = self.at(x);
        [middle, middle + self.below, middle + self.above]
    }
}

/// The inputs of a group of rows along an axis.
pub(super) struct Inputs {
    axis: Axis,
    held: Held,
    load: Trend,
    slip: Trend,
    speed: Trend,
}

impl Inputs {
    pub fn new(rows: &[Row], axis: Axis, held: Held) -> Self {
        let along = |value: &dyn Fn(&Row) -> f64| {
            Trend::new(&rows.iter().map(|row| (row.value(axis), value(row))).collect::<Vec<_>>())
        };
        // Along the wheel's speed it is that speed which the axis gives.
        let held = if axis == Axis::WheelSpeed { Held::WheelSpeed } else { held };
        Self {
            axis,
            held,
            load: along(&|row| row.load),
            slip: along(&|row| row.slip),
            speed: along(&|row| row.speed(held)),
        }
    }

    /// Load, slip and wheel speed at a place of the axis, first the typical ones, then all ends of what is not the axis.
    pub fn at(&self, x: f64) -> Vec<[f64; 3]> {
        let own = |axis: Axis, trend: &Trend| if self.axis == axis { vec![x] } else { trend.ends(x).to_vec() };
        let mut all = Vec::new();
        for load in own(Axis::Load, &self.load) {
            for slip in own(Axis::Slip, &self.slip) {
                for speed in own(Axis::WheelSpeed, &self.speed) {
                    all.push([load, slip, self.wheel_speed(slip, speed)]);
                }
            }
        }
        all
    }

    fn wheel_speed(&self, slip: f64, speed: f64) -> f64 {
        match self.held {
            Held::WheelSpeed => speed,
            Held::CarriageSpeed if slip >= 0.0 => speed / (1.0 - slip),
            Held::CarriageSpeed => speed * (1.0 + slip),
        }
    }
}
