//! Recorded commands replayed through the simulation, over any scalar.

use super::guide::Guide;
use super::halt::Halt;
use super::windows::Window;
use crate::rover::{Rover, State};
use crate::scalar::Scalar;
use crate::signals::{Command, Drive, Signals};
use crate::simulation::{Event, Simulation, Status, StepError};

/// Why a replay failed.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ReplayError {
    /// The simulation failed.
    #[error(transparent)]
    Step(#[from] StepError),
    /// The caller asked to end.
    #[error("interrupted")]
    Interrupted,
    /// The run ended before its rows did.
    #[error("at row {}: the rover is {event}", row + 1)]
    Ended {
        /// The row that was due, counted from 0.
        row: usize,
        /// What happened.
        event: Event,
    },
}

/// Open-loop commands of a run and the times at which they act.
///
/// The rover starts at rest, settled above `x0`, at the time of the first row. The commands of a row hold until the
/// next row's time. Rows are met to half an inner step.
/// ```
/// use bekker::{diagnosis::Replay, rover::Rover, signals::Drive};
///
/// let commands: Vec<f64> = [2.0, 2.0].repeat(3); // three rows of two wheels, rad/s
/// let replay = Replay::new(Drive::Speed, 0.002, &[0.0, 0.5, 1.0], commands);
/// let mut way = Vec::new();
/// replay.run(Rover::two_wheeled(), 0.0, |_, signals| way.push(signals.body.x))?;
/// assert!(way[0] == 0.0 && way[2] > way[1]);
/// # Ok::<(), bekker::diagnosis::ReplayError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Replay {
    drive: Drive,
    step_size: f64,
    /// Inner steps since the start at which each row is due.
    due: Vec<u64>,
    /// One value a wheel, row by row.
    commands: Vec<f64>,
}

impl Replay {
    /// A replay with the inner step `step_size` (s) of `commands` (one value a wheel, rear to front, row by row; N m or
    /// rad/s as `drive` says) at `time` (s, rising; the first is the start).
    #[must_use]
    pub fn new(drive: Drive, step_size: f64, time: &[f64], commands: Vec<f64>) -> Self {
        let start = time.first().copied().unwrap_or(0.0);
        let due = time.iter().map(|t| ((t - start) / step_size).round() as u64).collect();
        Self { drive, step_size, due, commands }
    }

    /// Number of rows.
    #[must_use]
    pub fn rows(&self) -> usize {
        self.due.len()
    }

    /// Inner steps since the start at which `row` is due.
    pub(super) fn due(&self, row: usize) -> u64 {
        self.due[row]
    }

    /// Commands of a row, one a wheel.
    pub(super) fn command(&self, row: usize) -> &[f64] {
        let wheels = self.commands.len() / self.due.len();
        &self.commands[row * wheels..(row + 1) * wheels]
    }

    pub(super) fn drive(&self) -> Drive {
        self.drive
    }

    /// Inner step, s.
    pub(super) fn step_size(&self) -> f64 {
        self.step_size
    }

    /// Replays the commands and calls `record` with every row and the signals at its time, before its own command acts.
    /// Over dual numbers the signals carry their derivatives in what `rover` and `x0` (m) are seeded with.
    ///
    /// # Errors
    /// [`ReplayError`].
    pub fn run<S: Scalar>(
        &self,
        rover: Rover<S>,
        x0: S,
        record: impl FnMut(usize, &Signals<S>),
    ) -> Result<(), ReplayError> {
        self.run_led(None, Halt::default(), rover, x0, record)
    }

    /// The same, led by `guide`, until `halt` asks to end.
    pub(super) fn run_led<S: Scalar>(
        &self,
        guide: Option<&Guide>,
        halt: Halt,
        rover: Rover<S>,
        x0: S,
        mut record: impl FnMut(usize, &Signals<S>),
    ) -> Result<(), ReplayError> {
        let mut simulation = Simulation::new(rover, x0, self.step_size)?;
        self.follow((guide, halt), &mut simulation, 0..self.due.len(), false, &mut |row, simulation| {
            record(row, simulation.signals());
        })
    }

    /// Replays the rows from where a window begins to its end, from `state`.
    pub(super) fn run_window<S: Scalar>(
        &self,
        guide: Option<&Guide>,
        halt: Halt,
        (rover, state): (Rover<S>, State<S>),
        window: &Window,
        record: &mut dyn FnMut(usize, &Simulation<S>),
    ) -> Result<(), ReplayError> {
        let mut simulation = Simulation::from_state(rover, state, self.step_size)?;
        self.follow((guide, halt), &mut simulation, window.begin..window.rows.end, !window.ends_when_stuck, record)
    }

    /// Goes through `rows`, the first of which is where `simulation` stands; if it `goes_on` also where the rover is stuck.
    fn follow<S: Scalar>(
        &self,
        (guide, halt): (Option<&Guide>, Halt),
        simulation: &mut Simulation<S>,
        rows: std::ops::Range<usize>,
        goes_on: bool,
        record: &mut dyn FnMut(usize, &Simulation<S>),
    ) -> Result<(), ReplayError> {
        let wheels = simulation.rover().wheels.len();
        let mut command = Command { drive: self.drive, values: vec![0.0; wheels] };
        let first = self.due.get(rows.start).copied().unwrap_or(0);
        for row in rows {
            if halt.asked() {
                return Err(ReplayError::Interrupted);
            }
            let due = self.due[row] - first;
            while simulation.ticks() < due {
                match simulation.advance(&command, due - simulation.ticks())? {
                    Status::Ended(Event::Stuck) if goes_on => simulation.resume(),
                    Status::Ended(event) => return Err(ReplayError::Ended { row, event }),
                    Status::Running => {}
                }
            }
            record(row, simulation);
            if let Some(guide) = guide {
                simulation.adjust(|effects| guide.lead(row, effects))?;
            }
            let values = self.commands.iter().skip(row * wheels);
            command.values.iter_mut().zip(values).for_each(|(value, recorded)| *value = *recorded);
        }
        Ok(())
    }
}
