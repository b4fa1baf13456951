//! A recorded run replayed window by window.

use super::{Recorded, Traced};
use crate::diagnosis::halt::Halt;
use crate::diagnosis::prediction::PredictionError;
use crate::diagnosis::replay::{Replay, ReplayError};
use crate::diagnosis::windows::{Moving, OPEN, Window};
use crate::rover::{Rover, State, Track};
use crate::scalar::Scalar;
use crate::simulation::{Simulation, StepError};
use std::ops::Range;

/// What a window takes over of a wheel's past from the window before, since no record tells it.
#[derive(Clone, Copy)]
pub(super) struct Past<S> {
    /// How warm the winding is, K.
    rise: S,
    /// Slip to which the ground is dug.
    dug_slip: S,
}

/// Whether the wheels of a rover have such a past.
pub(super) fn has_past<S: Scalar>(rover: &Rover<S>) -> bool {
    rover.effects.warming(S::from(0.0)).is_some() || rover.effects.digging_length().is_some()
}

/// The wheels' past along a window.
struct Carried<S> {
    /// With which it begins, and the row.
    first: (Vec<Past<S>>, usize),
    /// The same of the last row that was taken.
    last: (Vec<Past<S>>, usize),
}

impl<S: Scalar> Carried<S> {
    fn new(state: &State<S>, row: usize) -> Self {
        let past = past(state);
        Self { first: (past.clone(), row), last: (past, row) }
    }

    fn take(&mut self, row: usize, state: &State<S>) {
        self.last = (past(state), row);
    }

    /// The past at a row: where it lies behind the last one that was taken, the power stays what it was in between on average, and the
    /// ground as it was.
    fn at(self, row: usize, rover: &Rover<S>, time: &[f64]) -> Vec<Past<S>> {
        let ((before, begin), (mut wheels, end)) = (self.first, self.last);
        let Some(law) = rover.effects.warming(S::from(0.0)).filter(|_| begin < end && end < row) else { return wheels };
        for (wheel, before) in wheels.iter_mut().zip(before) {
            wheel.rise =
                law.between(before.rise, wheel.rise, time[end] - time[begin]).after(wheel.rise, time[row] - time[end]);
        }
        wheels
    }
}

fn past<S: Scalar>(state: &State<S>) -> Vec<Past<S>> {
    state.wheels.iter().map(|wheel| Past { rise: wheel.winding_rise, dug_slip: wheel.dug_slip }).collect()
}

impl Recorded {
    /// The traced signals of an open-loop replay window by window, row by row, unless `halt` asks to end. `open` makes the
    /// place and the velocity in which a window begins of their values.
    pub fn windowed<S: Scalar>(
        &self,
        replay: &Replay,
        rover: &Rover<S>,
        x0: S,
        open: &dyn Fn([f64; OPEN]) -> [S; OPEN],
        halt: Halt,
    ) -> Result<Traced<S>, PredictionError> {
        let mut trace = vec![S::from(f64::NAN); self.time.len() * self.traced];
        let mut ended = Vec::new();
        // The wheels' past where the next window begins.
        let mut wheels: Vec<Past<S>> = Vec::new();
        let has_past = has_past(rover);
        for (k, window) in self.windows.iter().enumerate() {
            let next = self.windows.get(k + 1).map(|next| next.begin).filter(|_| has_past);
            let state = self.state(rover, x0, window, open, &wheels).map_err(|error| self.failed(error.into()))?;
            let mut carried = Carried::new(&state, window.begin);
            let mut record = |row: usize, simulation: &Simulation<S>| {
                if next.is_some_and(|next| row <= next) {
                    carried.take(row, simulation.state());
                }
                if window.rows.contains(&row) {
                    self.read(simulation.signals(), row, &mut trace);
                }
            };
            match replay.run_window(self.guide.as_ref(), halt, (rover.clone(), state), window, &mut record) {
                Ok(()) => {}
                Err(ReplayError::Interrupted) => return Err(PredictionError::Interrupted),
                Err(ReplayError::Step(source)) => return Err(self.failed(source.into())),
                Err(ReplayError::Ended { row, event }) => {
                    let from = row.max(window.rows.start);
                    let error = PredictionError::Ended { run: self.name.clone(), time: self.time[row], event };
                    self.stay(&mut trace, from..window.rows.end);
                    ended.push((from..window.rows.end, error));
                }
            }
            if let Some(next) = next {
                wheels = carried.at(next, rover, &self.time);
            }
        }
        Ok(Traced { values: trace, ended })
    }

    /// How a window begins; with the past of its `wheels` that another window leaves, where there is one.
    pub(super) fn state<S: Scalar>(
        &self,
        rover: &Rover<S>,
        x0: S,
        window: &Window,
        open: &dyn Fn([f64; OPEN]) -> [S; OPEN],
        wheels: &[Past<S>],
    ) -> Result<State<S>, StepError> {
        let Some(start) = &window.start else { return Ok(rover.settled_at(x0)?) };
        let [x, velocity] = open([start.x, start.velocity]);
        let radius = rover.true_wheel().radius;
        // Without known speeds the wheels roll; an open velocity takes the wheels along.
        let speeds: Vec<S> = (0..rover.wheels.len())
            .map(|k| match start.speeds.get(k) {
                Some(speed) => (velocity - start.velocity) / radius + *speed,
                None => velocity / radius,
            })
            .collect();
        let mut state = rover.moving_at(x, velocity, &speeds, &passed(rover, start))?;
        state.start_x = S::from(start.origin);
        for (wheel, past) in state.wheels.iter_mut().zip(wheels) {
            (wheel.winding_rise, wheel.dug_slip) = (past.rise, past.dug_slip);
        }
        Ok(state)
    }

    /// Repeats the row before `rows`; where there is none, nothing is known.
    pub(super) fn stay<S: Scalar>(&self, trace: &mut [S], rows: Range<usize>) {
        for at in rows.start * self.traced..rows.end * self.traced {
            if at >= self.traced {
                trace[at] = trace[at - self.traced];
            }
        }
    }
}

/// Ground that each wheel has passed since the run began: from its foot at one end of the way to that at the other. On a slope a foot lies
/// beside the wheel's centre by a good part of the length over which ground turns from fresh to passed.
fn passed<S: Scalar>(rover: &Rover<S>, start: &Moving) -> Vec<Track> {
    let counting = rover.effects.counts_passes().then(|| rover.map(&|s| s.value()));
    let [low, high] = start.covered.map(|x| {
        let feet = counting.as_ref().and_then(|rover| rover.feet_at(x).ok());
        // Where no effect asks, and before the known ground, the way counts as level.
        feet.unwrap_or_else(|| rover.wheels.iter().map(|wheel| wheel.mount.x.value() + x).collect())
    });
    low.into_iter().zip(high).map(|(low, high)| Track { low, high }).collect()
}
