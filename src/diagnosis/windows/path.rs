//! Where a rover was and how fast, row by row, as the measurements tell it.

use crate::measurement::{Run, around};

/// Rows within this time of a row tell where the rover was there, s: over it a rover's velocity hardly changes.
const AROUND: f64 = 0.5;
/// Share of a run's rows that must have a value for a signal to give the path.
const ENOUGH: f64 = 0.5;

/// Place (m) and velocity (m/s), row by row.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Path {
    pub x: Vec<f64>,
    pub velocity: Vec<f64>,
    /// Whether the place was measured, rather than reckoned from the start.
    pub placed: bool,
    /// Whether velocity or place was measured; else the wheels' speeds stand in for the velocity.
    pub measured: bool,
}

/// What a run tells of its path; `None` where nothing tells where on uneven ground the rover was. `radius` is that of the
/// wheels, `x0` where the run began (m), `speeds` the commanded wheel speeds row by row.
pub(super) fn path(run: &Run, radius: f64, x0: f64, speeds: &[Vec<f64>]) -> Option<Path> {
    let time = run.data.column("time")?;
    let column = |name: &str| {
        let values = run.data.column(name)?;
        let present = values.iter().filter(|v| !v.is_nan()).count();
        (present as f64 >= ENOUGH * values.len() as f64).then_some(values)
    };
    let (places, velocities) = (column("x"), column("velocity"));
    if let Some(places) = places {
        return Some(about(time, places, velocities));
    }
    let measured = velocities.is_some();
    let velocity = match velocities {
        Some(velocities) => means(time, velocities),
        None if run.terrain.is_none() => {
            let rim = |values: &Vec<f64>| radius * values.iter().sum::<f64>() / values.len().max(1) as f64;
            speeds.iter().map(rim).collect()
        }
        None => return None,
    };
    let mut x = vec![x0];
    for k in 1..time.len() {
        x.push(x[k - 1] + 0.5 * (velocity[k - 1] + velocity[k]) * (time[k] - time[k - 1]));
    }
    Some(Path { x, velocity, placed: false, measured })
}

/// Straight lines through the places around each row, whose slope the velocities tell too. Both count by the scatter about their neighbours.
fn about(time: &[f64], places: &[f64], velocities: Option<&[f64]>) -> Path {
    let weight_x = weight(places);
    let weight_v = velocities.map(weight);
    let (mut x, mut velocity) = (Vec::new(), Vec::new());
    for row in 0..time.len() {
        let (mut s, mut b) = ([0.0; 3], [0.0; 2]);
        for k in around(time, row, AROUND) {
            let t = time[k] - time[row];
            if !places[k].is_nan() {
                s[0] += weight_x;
                s[1] += weight_x * t;
                s[2] += weight_x * t * t;
                b[0] += weight_x * places[k];
                b[1] += weight_x * t * places[k];
            }
            if let (Some(values), Some(weight)) = (velocities, weight_v)
                && !values[k].is_nan()
            {
                s[2] += weight;
                b[1] += weight * values[k];
            }
        }
        let determinant = s[0] * s[2] - s[1] * s[1];
        let last = (x.last().copied().unwrap_or(0.0), velocity.last().copied().unwrap_or(0.0));
        let (here, rate) = if determinant > 1e-12 * s[0] * s[2] {
            ((s[2] * b[0] - s[1] * b[1]) / determinant, (s[0] * b[1] - s[1] * b[0]) / determinant)
        } else {
            last
        };
        x.push(here);
        velocity.push(rate);
    }
    Path { x, velocity, placed: true, measured: true }
}

/// One over the variance of a sample, from second differences; equal values do not count without bound.
fn weight(values: &[f64]) -> f64 {
    let present: Vec<f64> = values.iter().copied().filter(|v| !v.is_nan()).collect();
    let differences = present.windows(3).map(|v| (v[0] - 2.0 * v[1] + v[2]).powi(2));
    let count = differences.len().max(1) as f64;
    let largest = present.iter().fold(1e-3_f64, |most, v| most.max(v.abs()));
    (differences.sum::<f64>() / (6.0 * count) + (1e-6 * largest).powi(2)).recip()
}

/// Means around each row.
fn means(time: &[f64], values: &[f64]) -> Vec<f64> {
    let mut last = 0.0;
    (0..time.len())
        .map(|row| {
            let around: Vec<f64> = around(time, row, AROUND).map(|k| values[k]).filter(|v| !v.is_nan()).collect();
            if !around.is_empty() {
                last = around.iter().sum::<f64>() / around.len() as f64;
            }
            last
        })
        .collect()
}
