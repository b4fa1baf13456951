//! Windows of a recorded drive: stretches of a few seconds, each simulated from the measured state.
//!
//! Over a long replay small errors of the velocity add up, and a rover that gets stuck once says nothing of the rest. A window
//! begins anew: where the rover was, at the velocity that it had, with its wheels turning as they did (multiple shooting, Bock and Plitt
//! 1984). How deep it stands follows from the equilibrium. Where it begins is known as well as it was
//! measured, so the place is free in each window (and the velocity, where torques were commanded): what the rows of the
//! window say of it is all that counts ([`free`]). A run that begins at rest begins as in a replay. Ground that was passed and the
//! windings' temperature go on from window to window.

pub(crate) mod cut;
pub(crate) mod free;
mod path;

use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::ops::Range;

/// Motion in which a window begins.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Moving {
    /// Place of the reference point, m.
    pub x: f64,
    /// Velocity along the ground, m/s.
    pub velocity: f64,
    /// Speeds of the wheels relative to the body, rad/s.
    pub speeds: Vec<f64>,
    /// Least and largest x that the run has come to so far, m.
    pub covered: [f64; 2],
    /// Where the run began, m.
    pub origin: f64,
}

/// A stretch of a run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Window {
    /// Row at which its simulation begins, so much before its first row that what is quick has settled by then.
    pub begin: usize,
    /// Rows that it answers.
    pub rows: Range<usize>,
    /// How it begins; `None` at rest at the start of the run.
    pub start: Option<Moving>,
    /// Whether it ends where the rover gets stuck, rather than with the wheels turning on the spot.
    #[serde(default)]
    pub ends_when_stuck: bool,
}

/// The windows of each run; none for a run that is replayed as a whole.
pub(crate) type Windows = Vec<Vec<Window>>;

/// Number of numbers that a window's start may leave open: place and velocity.
pub(crate) const OPEN: usize = 2;

impl Window {
    /// All rows of a run that begins at rest and ends where it gets stuck.
    pub fn whole(rows: usize) -> Self {
        Self { begin: 0, rows: 0..rows, start: None, ends_when_stuck: true }
    }

    /// Moves the start by `change` of place (m) and velocity (m/s).
    pub fn displace(&mut self, change: [f64; OPEN]) {
        if let Some(start) = &mut self.start {
            // The end of the way at which the rover is moves with it.
            let here = start.x;
            start.covered.iter_mut().filter(|end| **end == here).for_each(|end| *end += change[0]);
            start.x += change[0];
            start.velocity += change[1];
        }
    }
}

/// Largest change of a start at a time: place, m, and velocity, m/s. What measurements leave open farther than that they do not tell.
const MOST: [f64; OPEN] = [0.25, 0.1];

/// Moves the starts of `windows` by `changes` of (run, window, number), the mean of which runs that begin alike share.
pub(crate) fn displaced(windows: &Windows, changes: &[((usize, usize, usize), f64)]) -> Windows {
    let known: BTreeMap<(usize, usize, usize), f64> = changes.iter().copied().collect();
    let change = |run: usize, window: usize, number: usize| {
        let alike = (0..windows.len()).filter(|other| windows[*other] == windows[run]);
        let all: Vec<f64> = alike.filter_map(|other| known.get(&(other, window, number))).copied().collect();
        let mean = all.iter().sum::<f64>() / all.len().max(1) as f64;
        if mean.is_finite() { mean.clamp(-MOST[number], MOST[number]) } else { 0.0 }
    };
    let mut moved = windows.clone();
    for (run, cuts) in moved.iter_mut().enumerate() {
        for (window, cut) in cuts.iter_mut().enumerate() {
            cut.displace(std::array::from_fn(|number| change(run, window, number)));
        }
    }
    moved
}
