//! One recorded run of a traverse, prepared for replays: no names are looked up in them.

mod side_by_side;
mod windows;

pub(super) use side_by_side::{Variant, traced};

use super::guide::Guide;
use super::halt::Halt;
use super::layout::Block;
use super::prediction::PredictionError;
use super::replay::{Replay, ReplayError};
use super::windows::Window;
use crate::measurement::{Run as Measured, summands};
use crate::model::{ControlKind, Model, RunError};
use crate::rover::Rover;
use crate::scalar::Scalar;
use crate::signals::{Drive, Signals};
use crate::simulation::Event;
use bekker_modeldescription::{Lookup, Parameters};
use std::ops::Range;

/// How a run is driven.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Drives {
    /// By its commands as they are.
    Open(Replay),
    /// By a feedback loop on every wheel, which follows the commands. The state of the loop is not measured, so that all rows are one
    /// window.
    Loop(Replay),
}

/// What a run gives.
#[derive(Debug)]
pub(super) struct Traced<S> {
    /// The recorded signals, row by row; as at the last row reached, where the run ended.
    pub values: Vec<S>,
    /// Rows, counted from 0, that the run did not reach, and how it ended: those of a window, or all to the run's end.
    pub ended: Vec<(Range<usize>, PredictionError)>,
}

/// A recorded run, and those that repeat it.
#[derive(Clone, Debug)]
pub(super) struct Recorded {
    name: String,
    /// The model with what is known of the run.
    pub model: Model,
    pub drives: Drives,
    /// Not compared between runs: those that repeat each other are led as the first of them was.
    guide: Option<Guide>,
    /// How it is cut; empty where it is replayed as a whole, one window of all rows where a loop drives it.
    pub windows: Vec<Window>,
    /// Times of the rows, s.
    time: Vec<f64>,
    /// Free parameters that the run does not set itself.
    pub felt: Vec<usize>,
    /// For each signal, in the order of [`Signals`], whether it is traced, and as which of them.
    columns: Vec<Option<usize>>,
    traced: usize,
    /// For each measured block what it is the sum of, and where its values start in the layout.
    targets: Vec<(Summed, usize)>,
}

/// The signals, in the order of [`Signals`], that a measured one is the sum of: mostly one.
type Summed = Vec<usize>;

impl Recorded {
    pub fn new<'a>(
        model: Model,
        run: &Measured,
        blocks: impl Iterator<Item = &'a Block>,
        felt: Vec<usize>,
        guide: Option<Guide>,
        windows: &[Window],
    ) -> Result<Self, PredictionError> {
        let mut signals = Signals::<f64>::of(run.inputs.len(), model.rover.links.len());
        let names: Vec<String> = signals.list().into_iter().map(|(variable, _)| variable.name).collect();
        let target = |block: &Block| {
            let parts = summands(&block.signal);
            let at: Option<Summed> = parts.iter().map(|part| names.iter().position(|name| name == part)).collect();
            let unknown = || PredictionError::Signal { run: run.name.clone(), signal: block.signal.clone() };
            at.map(|at| (at, block.range.start)).ok_or_else(unknown)
        };
        let targets = blocks.map(target).collect::<Result<Vec<_>, _>>()?;
        let time = run.data.column("time").unwrap_or_default().to_vec();
        let commands = commands(&model, run)?;
        let replay = |drive| Replay::new(drive, model.stepping.step_size, &time, commands);
        let drives = match model.control.kind {
            ControlKind::Speed => Drives::Open(replay(Drive::Speed)),
            ControlKind::Torque => Drives::Open(replay(Drive::Torque)),
            // The loop turns commanded speeds into torques.
            _ => Drives::Loop(replay(Drive::Torque)),
        };
        let windows = match &drives {
            Drives::Open(_) => windows.to_vec(),
            Drives::Loop(_) => vec![Window::whole(time.len())],
        };
        let columns = vec![None; names.len()];
        let mut recorded = Self {
            name: run.name.clone(),
            model,
            drives,
            guide,
            windows,
            time,
            felt,
            columns,
            traced: 0,
            targets: vec![],
        };
        recorded.add_targets(&targets);
        Ok(recorded)
    }

    /// Number of rows.
    pub fn rows(&self) -> usize {
        self.time.len()
    }

    /// Values of a trace.
    #[cfg(test)]
    pub fn traced_values(&self) -> usize {
        self.time.len() * self.traced
    }

    fn add_targets(&mut self, targets: &[(Summed, usize)]) {
        for signal in targets.iter().flat_map(|(summed, _)| summed) {
            if self.columns[*signal].is_none() {
                self.columns[*signal] = Some(self.traced);
                self.traced += 1;
            }
        }
        self.targets.extend_from_slice(targets);
    }

    /// Whether `other` is the same run to the last bit, whatever was measured in it.
    pub fn repeats(&self, other: &Self) -> bool {
        let (a, b) = (&self.model, &other.model);
        let parameters = |model: &Model| model.clone().list();
        let same_model = a.control.kind == b.control.kind
            && a.stepping.step_size.to_bits() == b.stepping.step_size.to_bits()
            && a.stepping.seed == b.stepping.seed
            && a.rover.terrain == b.rover.terrain
            && bodies(&a.rover) == bodies(&b.rover);
        let open = matches!(self.drives, Drives::Open(_));
        same_model
            && self.drives == other.drives
            && self.windows == other.windows
            && (open || self.time == other.time)
            && self.felt == other.felt
            && parameters(a) == parameters(b)
    }

    /// Takes the measured blocks of a run that repeats this one.
    pub fn take(&mut self, other: Self) {
        self.add_targets(&other.targets);
    }

    /// The traced signals of an open-loop replay, row by row, unless `halt` asks to end.
    pub fn replayed<S: Scalar>(
        &self,
        replay: &Replay,
        rover: Rover<S>,
        x0: S,
        halt: Halt,
    ) -> Result<Traced<S>, PredictionError> {
        let mut trace = vec![S::from(f64::NAN); self.time.len() * self.traced];
        match replay.run_led(self.guide.as_ref(), halt, rover, x0, |row, signals| self.read(signals, row, &mut trace)) {
            Ok(()) => Ok(Traced { values: trace, ended: Vec::new() }),
            Err(ReplayError::Ended { row, event }) => Ok(self.ended(trace, row, event)),
            Err(ReplayError::Interrupted) => Err(PredictionError::Interrupted),
            Err(ReplayError::Step(source)) => Err(self.failed(source.into())),
        }
    }

    /// A trace whose rows from `row` on repeat the one before: the first row is the start, which cannot end.
    fn ended<S: Scalar>(&self, mut values: Vec<S>, row: usize, event: Event) -> Traced<S> {
        let reached = row * self.traced;
        for at in reached..values.len() {
            values[at] = values[at - self.traced];
        }
        let error = PredictionError::Ended { run: self.name.clone(), time: self.time[row], event };
        Traced { values, ended: vec![(row..self.time.len(), error)] }
    }

    pub fn read<S: Scalar>(&self, signals: &Signals<S>, row: usize, trace: &mut [S]) {
        let row = &mut trace[row * self.traced..(row + 1) * self.traced];
        let mut columns = self.columns.iter();
        signals.values(&mut |value| {
            if let Some(Some(column)) = columns.next() {
                row[*column] = value;
            }
        });
    }

    /// How a trace differs from `own` by a change of `step`, per unit of it; where one of them has ended as at the last row that both
    /// have reached.
    pub fn slope(&self, own: &Traced<f64>, changed: &Traced<f64>, step: f64) -> Vec<f64> {
        let mut slope: Vec<f64> = changed.values.iter().zip(&own.values).map(|(a, b)| (a - b) / step).collect();
        let mut ended: Vec<Range<usize>> =
            own.ended.iter().chain(&changed.ended).map(|(rows, _)| rows.clone()).collect();
        ended.sort_by_key(|rows| rows.start);
        ended.into_iter().for_each(|rows| self.stay(&mut slope, rows));
        slope
    }

    /// Puts a trace where it was measured.
    pub fn store(&self, trace: &[f64], layout: &mut [f64]) {
        for (summed, start) in &self.targets {
            let columns: Vec<usize> = summed.iter().filter_map(|signal| self.columns[*signal]).collect();
            for row in 0..self.time.len() {
                layout[start + row] = columns.iter().map(|column| trace[row * self.traced + column]).sum();
            }
        }
    }

    pub fn failed(&self, source: RunError) -> PredictionError {
        PredictionError::Simulation { run: self.name.clone(), source: Box::new(source) }
    }
}

/// How the bodies hang together: what a rover has beside its parameters and its ground.
fn bodies(rover: &Rover) -> (Vec<usize>, Vec<usize>) {
    (rover.links.iter().map(|link| link.parent).collect(), rover.wheels.iter().map(|wheel| wheel.body).collect())
}

/// What drives the wheels row by row, wheel 1 first whatever their order in the file, each within its range: the commands or,
/// where none were recorded, the measured speeds.
fn commands(model: &Model, run: &Measured) -> Result<Vec<f64>, PredictionError> {
    let columns: Vec<Vec<f64>> = (1..=run.inputs.len()).map(|wheel| run.held_inputs(wheel)).collect();
    let mut inputs = model.inputs();
    let mut commands = Vec::new();
    for row in 0..run.data.rows() {
        commands.extend(columns.iter().map(|values| values.get(row).copied().unwrap_or(0.0)));
        let present = &commands[row * columns.len()..];
        let failed = |source| PredictionError::Simulation { run: run.name.clone(), source: Box::new(source) };
        inputs.set_all(present).map_err(failed)?;
    }
    Ok(commands)
}
