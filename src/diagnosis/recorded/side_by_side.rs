//! Windows of recorded runs, and whole runs with feedback loops, under several sets of values each, replayed side by side.
//!
//! Each goes on to the bits that it has by itself ([`crate::batch`]), so neither which of them share a batch nor the processor's
//! instructions show in what they give.

use super::windows::has_past;
use super::{Drives, Recorded, Traced};
use crate::batch::{Batch, Kernel, Kind};
use crate::diagnosis::halt::Halt;
use crate::diagnosis::prediction::PredictionError;
use crate::diagnosis::replay::Replay;
use crate::diagnosis::windows::{OPEN, Window};
use crate::model::{Model, Run, RunError};
use crate::parallel::map_in_order;
use crate::scalar::MOST_LANES;
use crate::signals::Signals;
use crate::simulation::{Event, Simulation, Status};

/// A recorded run under one set of values.
pub(in crate::diagnosis) struct Variant<'a> {
    pub run: &'a Recorded,
    /// The run's model with these values.
    pub model: Model,
    /// What is added to the place (m) and the velocity (m/s) in which its windows begin.
    pub shift: [f64; OPEN],
}

impl<'a> Variant<'a> {
    /// With windows that begin where they do.
    pub fn new(run: &'a Recorded, model: Model) -> Self {
        Self { run, model, shift: [0.0; OPEN] }
    }

    /// Whether its windows can be replayed by themselves: none waits for what another leaves of its wheels' past, and none is led. A run
    /// with feedback loops is one window.
    pub fn is_separable(&self) -> bool {
        let cut = !self.run.windows.is_empty() && self.run.guide.is_none();
        cut && (self.is_looped() || !has_past(&self.model.rover))
    }

    /// Whether feedback loops drive it.
    pub fn is_looped(&self) -> bool {
        matches!(self.run.drives, Drives::Loop(_))
    }

    /// The variant with open-loop commands window by window, one after the other.
    fn alone(&self, halt: Halt) -> Result<Traced<f64>, PredictionError> {
        let replay = self.replay();
        if self.run.windows.is_empty() {
            return self.run.replayed(replay, self.model.rover.clone(), self.model.start.x0, halt);
        }
        let open = |start: [f64; OPEN]| std::array::from_fn(|k| start[k] + self.shift[k]);
        self.run.windowed(replay, &self.model.rover, self.model.start.x0, &open, halt)
    }

    fn replay(&self) -> &'a Replay {
        match &self.run.drives {
            Drives::Open(replay) | Drives::Loop(replay) => replay,
        }
    }
}

/// A window of a variant.
struct Piece<'a> {
    /// Which variant.
    of: usize,
    variant: &'a Variant<'a>,
    replay: &'a Replay,
    /// Which window of the run.
    number: usize,
    window: &'a Window,
}

/// What a window gives: its rows as far as they were reached.
struct Answer {
    rows: Vec<f64>,
    /// The row that was due when it ended, and in what.
    ended: Option<(usize, Event)>,
}

/// An answer and which window of its run it is of.
type Numbered = (usize, Result<Answer, PredictionError>);

/// What each variant gives.
pub(in crate::diagnosis) fn traced(variants: &[Variant], halt: Halt) -> Vec<Result<Traced<f64>, PredictionError>> {
    let pieces = grouped(variants);
    let answers = map_in_order(&pieces, |pieces| side_by_side(pieces, halt));
    let mut by_variant: Vec<Vec<Numbered>> = Vec::new();
    by_variant.resize_with(variants.len(), Vec::new);
    for (piece, answer) in pieces.iter().flatten().zip(answers.into_iter().flatten()) {
        by_variant[piece.of].push((piece.number, answer));
    }
    // Windows of a variant follow each other, whatever batches they were in.
    by_variant.iter_mut().for_each(|answers| answers.sort_by_key(|(number, _)| *number));
    let alone: Vec<usize> = (0..variants.len()).filter(|k| by_variant[*k].is_empty()).collect();
    let mut others = map_in_order(&alone, |k| variants[*k].alone(halt)).into_iter();
    let whole = |(variant, answers): (&Variant, Vec<Numbered>)| {
        let alone = if answers.is_empty() { others.next() } else { None };
        alone.unwrap_or_else(|| joined(variant.run, answers.into_iter().map(|(_, answer)| answer)))
    };
    variants.iter().zip(by_variant).map(whole).collect()
}

/// The windows that can be replayed by themselves, in batches of runs that can go on side by side.
fn grouped<'a>(variants: &'a [Variant<'a>]) -> Vec<Vec<Piece<'a>>> {
    let mut kinds: Vec<(Kind, (u64, bool), Vec<Piece>)> = Vec::new();
    for (of, variant) in variants.iter().enumerate().filter(|(_, variant)| variant.is_separable()) {
        let replay = variant.replay();
        let kind = Kind::of_rover(&variant.model.rover, replay.drive());
        let driven = (replay.step_size().to_bits(), variant.is_looped());
        let known = kinds.iter().position(|(other, same, _)| *other == kind && *same == driven);
        let at = known.unwrap_or(kinds.len());
        if known.is_none() {
            kinds.push((kind, driven, Vec::new()));
        }
        let windows = variant.run.windows.iter().enumerate();
        kinds[at].2.extend(windows.map(|(number, window)| Piece { of, variant, replay, number, window }));
    }
    let mut batches = Vec::new();
    for (_, _, mut pieces) in kinds {
        // A batch is done when the longest of its windows is, and stops for new commands less often where these come at the same times.
        pieces.sort_by_key(|piece| (piece.window.rows.end - piece.window.begin, piece.window.begin));
        while !pieces.is_empty() {
            let rest = pieces.split_off(pieces.len().min(MOST_LANES));
            batches.push(std::mem::replace(&mut pieces, rest));
        }
    }
    batches
}

/// The whole of a variant from its windows.
fn joined(
    run: &Recorded,
    answers: impl Iterator<Item = Result<Answer, PredictionError>>,
) -> Result<Traced<f64>, PredictionError> {
    let mut trace = vec![f64::NAN; run.time.len() * run.traced];
    let mut ended = Vec::new();
    for (window, answer) in run.windows.iter().zip(answers) {
        let answer = answer?;
        let first = window.rows.start * run.traced;
        trace[first..first + answer.rows.len()].copy_from_slice(&answer.rows);
        if let Some((row, event)) = answer.ended {
            let rows = row.max(window.rows.start)..window.rows.end;
            run.stay(&mut trace, rows.clone());
            ended.push((rows.clone(), PredictionError::Ended { run: run.name.clone(), time: run.time[row], event }));
        }
    }
    Ok(Traced { values: trace, ended })
}

/// A window on its way.
struct Going<'a> {
    piece: &'a Piece<'a>,
    /// The next row, and the inner step at which the window begins.
    row: usize,
    first: u64,
    rows: Vec<f64>,
    ended: Option<(usize, Event)>,
    failed: Option<PredictionError>,
    done: bool,
}

impl<'a> Going<'a> {
    fn new(piece: &'a Piece<'a>) -> Self {
        let (row, first) = (piece.window.begin, piece.replay.due(piece.window.begin));
        Self { piece, row, first, rows: Vec::new(), ended: None, failed: None, done: false }
    }

    /// Inner steps until the next row.
    fn left(&self, ticks: u64) -> u64 {
        self.piece.replay.due(self.row) - self.first - ticks
    }

    /// Takes a row that is due; the commands that act from now on are put into `inputs`.
    fn take(&mut self, signals: &Signals, inputs: &mut [f64]) {
        if self.piece.window.rows.contains(&self.row) {
            let run = self.piece.variant.run;
            let row = self.rows.len() / run.traced.max(1);
            self.rows.resize(self.rows.len() + run.traced, f64::NAN);
            run.read(signals, row, &mut self.rows);
        }
        inputs.copy_from_slice(self.piece.replay.command(self.row));
        self.row += 1;
        self.done = self.row == self.piece.window.rows.end;
    }

    fn failed(&mut self, source: RunError) {
        (self.failed, self.done) = (Some(self.piece.variant.run.failed(source)), true);
    }

    fn answer(self) -> Result<Answer, PredictionError> {
        match self.failed {
            Some(error) => Err(error),
            None => Ok(Answer { rows: self.rows, ended: self.ended }),
        }
    }
}

/// Where the simulation of a window begins.
fn start(piece: &Piece) -> Result<Run, RunError> {
    let Variant { run, model, shift } = piece.variant;
    if piece.variant.is_looped() {
        return model.start();
    }
    let open = |start: [f64; OPEN]| std::array::from_fn(|k| start[k] + shift[k]);
    let state = run.state(&model.rover, model.start.x0, piece.window, &open, &[])?;
    Run::from_simulation(model, Simulation::from_state(model.rover.clone(), state, piece.replay.step_size())?)
}

/// Replays windows of one kind, at most as many as there are lanes, each to its end.
fn side_by_side(pieces: &[Piece], halt: Halt) -> Vec<Result<Answer, PredictionError>> {
    let mut going: Vec<Going> = pieces.iter().map(Going::new).collect();
    let mut runs = Vec::new();
    for going in &mut going {
        match start(going.piece) {
            Ok(run) => runs.push(run),
            Err(error) => going.failed(error),
        }
    }
    let mut on_their_way: Vec<&mut Going> = going.iter_mut().filter(|going| !going.done).collect();
    if !runs.is_empty() {
        advance(&mut on_their_way, runs, halt);
    }
    going.into_iter().map(Going::answer).collect()
}

fn advance(going: &mut [&mut Going], runs: Vec<Run>, halt: Halt) {
    // Runs of one kind and one inner step fit together, and the commands were checked when they were read.
    let mut batch = Batch::on(runs, 1, Kernel::best()).expect("runs of one kind");
    let wheels = batch.input_count();
    let mut inputs = vec![0.0; going.len() * wheels];
    loop {
        for (k, going) in going.iter_mut().enumerate() {
            while !going.done && going.left(batch.ticks(k)) == 0 {
                going.take(batch.signals_of(k), &mut inputs[k * wheels..(k + 1) * wheels]);
            }
        }
        let active: Vec<bool> = going.iter().map(|going| !going.done).collect();
        let left = going.iter().enumerate().filter(|(k, _)| active[*k]).map(|(k, going)| going.left(batch.ticks(k)));
        let Some(steps) = left.min() else { return };
        if halt.asked() {
            for going in going.iter_mut().filter(|going| !going.done) {
                (going.failed, going.done) = (Some(PredictionError::Interrupted), true);
            }
            return;
        }
        batch.step(&inputs, steps, Some(&active)).expect("a panic of a step stays one");
        for (k, going) in going.iter_mut().enumerate().filter(|(k, _)| active[*k]) {
            if let Some(error) = batch.error(k) {
                going.failed(error.clone());
                continue;
            }
            match batch.statuses()[k] {
                Status::Running => {}
                Status::Ended(Event::Stuck) if !going.piece.window.ends_when_stuck => batch.resume(k),
                Status::Ended(event) => (going.ended, going.done) = (Some((going.row, event)), true),
            }
        }
    }
}
