//! Many runs stepped together: for learning, and for studies over soils, grounds and seeds.
//!
//! Each run goes on as it would alone, to the last bit: results depend neither on the number of threads nor on which runs
//! share a batch, nor on the processor's instructions.
//!
//! Runs of one kind go eight at a time, number k of every quantity being that of run k ([`Kernel`] has the instruction
//! sets). A run that needs what only the single run computes is stepped by itself, in the same batch: the plant of rigid bodies, effects of
//! the user's own, and a step in which one of the eight leaves the ground or is not finite.
//!
//! ```
//! use bekker::batch::Batch;
//! use bekker::model::Model;
//!
//! let model = Model::preset("two_wheeled")?;
//! let mut batch = Batch::new(vec![model.start()?, model.start()?], 1)?;
//! batch.step(&[0.5, 0.5, 1.0, 1.0], 10, None)?; // two wheels a run, N m
//! let mut signals = vec![0.0; batch.len() * batch.signal_count()];
//! batch.signals(&mut signals);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod error;
mod group;
mod kernel;
mod kind;
#[cfg(test)]
mod operations;
mod pool;
mod shard;

pub use error::BatchError;
pub use kernel::Kernel;
#[cfg(feature = "experiments")]
pub(crate) use kind::Kind;

use crate::model::{Ahead, Inputs, Run, RunError};
use crate::signals::{Measurement, Signals};
use crate::simulation::Status;
use bekker_modeldescription::Parameters;
use pool::Pool;
use shard::{Shard, Slot};

/// Many runs of models of one structure, stepped together.
///
/// With more than one thread it owns as many workers less one, which the first step starts. A process that is forked off
/// has no threads but its own: there the first step starts new ones.
#[derive(Debug)]
pub struct Batch {
    /// One shard for each thread. In every step a shard moves to its worker thread and back, as a pointer.
    #[allow(clippy::vec_box, reason = "shards move between threads as pointers")]
    shards: Vec<Box<Shard>>,
    pool: Pool,
    structure: Structure,
    statuses: Vec<Status>,
    /// A panic left a run in an unknown state.
    broken: bool,
}

/// What runs of one batch share: it decides about the names of inputs and signals.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Structure {
    wheels: usize,
    links: usize,
    /// Inputs of a run, and which of the three kinds they are.
    inputs: usize,
    kind: std::mem::Discriminant<Inputs>,
    step_size: f64,
}

impl Structure {
    fn of(run: &Run) -> Self {
        let (signals, mut inputs) = (run.signals(), 0);
        run.inputs().values(&mut |_| inputs += 1);
        let kind = std::mem::discriminant(run.inputs());
        Self { wheels: signals.wheels.len(), links: signals.links.len(), inputs, kind, step_size: run.step_size() }
    }
}

impl Batch {
    /// A batch of `runs`, stepped by `threads` threads, the calling one among them.
    ///
    /// # Errors
    /// [`BatchError::Empty`], [`BatchError::NoThreads`]; [`BatchError::Structure`] where runs differ in their inputs,
    /// their signals or their inner step.
    pub fn new(runs: Vec<Run>, threads: usize) -> Result<Self, BatchError> {
        Self::on(runs, threads, Kernel::best())
    }

    /// The same on a certain [`Kernel`]; the bits are the same on each.
    ///
    /// # Errors
    /// As [`Batch::new`], and [`BatchError::Kernel`] where this processor does not have it.
    pub fn on(runs: Vec<Run>, threads: usize, kernel: Kernel) -> Result<Self, BatchError> {
        if !kernel.is_there() {
            return Err(BatchError::Kernel(kernel));
        }
        let Some(first) = runs.first() else { return Err(BatchError::Empty) };
        if threads == 0 {
            return Err(BatchError::NoThreads);
        }
        let structure = Structure::of(first);
        if let Some(index) = runs.iter().position(|run| Structure::of(run) != structure) {
            return Err(BatchError::Structure { index });
        }
        let statuses = runs.iter().map(Run::status).collect();
        let share = runs.len().div_ceil(threads);
        let mut slots = runs.into_iter().map(Slot::new);
        let mut shards = Vec::new();
        while slots.len() > 0 {
            shards.push(Box::new(Shard::new(slots.by_ref().take(share).collect(), kernel)));
        }
        Ok(Self { pool: Pool::new(shards.len() - 1), shards, structure, statuses, broken: false })
    }

    /// Number of runs.
    #[must_use]
    pub fn len(&self) -> usize {
        self.statuses.len()
    }

    /// Never: a batch has a run at least.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.statuses.is_empty()
    }

    /// Inputs of a run.
    #[must_use]
    pub fn input_count(&self) -> usize {
        self.structure.inputs
    }

    /// Signals of a run.
    #[must_use]
    pub fn signal_count(&self) -> usize {
        let mut count = 0;
        self.slots().take(1).for_each(|slot| slot.run.signals().values(&mut |_| count += 1));
        count
    }

    /// Inner steps that runs have made side by side, summed over the runs: what is missing to all inner steps made was
    /// stepped run by run, which takes several times as long.
    #[must_use]
    pub fn steps_side_by_side(&self) -> u64 {
        self.shards.iter().map(|shard| shard.steps_side_by_side()).sum()
    }

    /// Inner step, s.
    #[must_use]
    pub fn step_size(&self) -> f64 {
        self.structure.step_size
    }

    /// Holds row i of `inputs` (length x inputs, row by row, in the vocabulary's order) in run i for `steps` inner steps,
    /// where `active` (everywhere where it is `None`). A run that has ended stays as it is. A run that fails stays at its
    /// last good step and shows its error in [`Batch::error`]; the others go on.
    ///
    /// # Errors
    /// As [`Batch::hold`] and [`Batch::advance`].
    pub fn step(&mut self, inputs: &[f64], steps: u64, active: Option<&[bool]>) -> Result<(), BatchError> {
        self.hold(inputs, active)?;
        self.advance(steps)
    }

    /// The first half of [`Batch::step`]: copies row i of `inputs` into the inputs of run i and selects the runs that
    /// [`Batch::advance`] moves. `inputs` and `active` are free for other use afterwards.
    ///
    /// # Errors
    /// [`BatchError`] for a wrong number of values or an input of an active run that is not finite or out of range. All
    /// values are checked before the first is copied: after an error every run has the inputs that it had.
    pub fn hold(&mut self, inputs: &[f64], active: Option<&[bool]>) -> Result<(), BatchError> {
        self.check(inputs, active)?;
        let width = self.structure.inputs;
        let row = |index: usize| &inputs[index * width..(index + 1) * width];
        let moves = |index: usize, slot: &Slot| active.is_none_or(|active| active[index]) && slot.error.is_none();
        for (index, slot) in self.slots().enumerate().filter(|(index, slot)| moves(*index, slot)) {
            let refused = |source| BatchError::Input { index, source };
            slot.run.inputs().check_all(row(index)).map_err(refused)?;
        }
        for (index, slot) in self.shards.iter_mut().flat_map(|shard| &mut shard.slots).enumerate() {
            slot.active = moves(index, slot);
            if slot.active {
                slot.run.inputs_mut().put_all(row(index));
            }
        }
        Ok(())
    }

    /// The second half of [`Batch::step`]: makes `steps` inner steps with the inputs that [`Batch::hold`] has set, in the
    /// runs that it has selected (in none before its first call).
    ///
    /// # Errors
    /// [`BatchError::Panicked`] after a bug, from when on the batch is of no use.
    pub fn advance(&mut self, steps: u64) -> Result<(), BatchError> {
        if self.broken {
            return Err(BatchError::Panicked);
        }
        for shard in &mut self.shards {
            shard.steps = steps;
        }
        self.pool.step(&mut self.shards);
        self.broken = self.shards.iter().any(|shard| shard.panicked);
        let Self { shards, statuses, .. } = self;
        let slots = shards.iter().flat_map(|shard| &shard.slots);
        statuses.iter_mut().zip(slots).for_each(|(status, slot)| *status = slot.run.status());
        if self.broken { Err(BatchError::Panicked) } else { Ok(()) }
    }

    fn check(&self, inputs: &[f64], active: Option<&[bool]>) -> Result<(), BatchError> {
        if self.broken {
            return Err(BatchError::Panicked);
        }
        let expected = self.len() * self.structure.inputs;
        if inputs.len() != expected {
            return Err(BatchError::InputLength { got: inputs.len(), expected });
        }
        match active {
            Some(active) if active.len() != self.len() => {
                Err(BatchError::ActiveLength { got: active.len(), expected: self.len() })
            }
            _ => Ok(()),
        }
    }

    fn slots(&self) -> impl Iterator<Item = &Slot> {
        self.shards.iter().flat_map(|shard| &shard.slots)
    }

    fn slot(&self, index: usize) -> &Slot {
        let share = self.shards[0].slots.len();
        &self.shards[index / share].slots[index % share]
    }

    /// Signals of all runs as single runs record them, row by row in the vocabulary's order; `out` holds
    /// [`Batch::len`] times [`Batch::signal_count`] values.
    pub fn signals(&self, out: &mut [f64]) {
        let mut places = out.iter_mut();
        for slot in self.slots() {
            slot.run.signals().values(&mut |value| {
                if let Some(place) = places.next() {
                    *place = value;
                }
            });
        }
    }

    /// Signals of the run at `index`, as a single run records them.
    #[must_use]
    pub fn signals_of(&self, index: usize) -> &Signals {
        self.slot(index).run.signals()
    }

    /// Whether the runs go on.
    #[must_use]
    pub fn statuses(&self) -> &[Status] {
        &self.statuses
    }

    /// Why the run at `index` failed; it does not move any more.
    #[must_use]
    pub fn error(&self, index: usize) -> Option<&RunError> {
        self.slot(index).error.as_ref()
    }

    /// Time of the run at `index` since its start, s.
    #[must_use]
    pub fn time(&self, index: usize) -> f64 {
        self.slot(index).run.time()
    }

    /// Inner steps that the run at `index` has made.
    #[cfg(feature = "experiments")]
    pub(crate) fn ticks(&self, index: usize) -> u64 {
        self.slot(index).run.ticks()
    }

    /// Lets the run at `index` go on after an event, from now on by itself.
    #[cfg(feature = "experiments")]
    pub(crate) fn resume(&mut self, index: usize) {
        let share = self.shards[0].slots.len();
        let run = &mut self.shards[index / share].slots[index % share].run;
        run.resume();
        self.statuses[index] = run.status();
    }

    /// Reads the ground ahead of each run, as [`Run::look_ahead`], a row a run.
    ///
    /// # Panics
    /// If `out` does not hold [`Ahead::ROWS`] numbers for each distance of each run.
    pub fn look_ahead(&self, ahead: &Ahead, out: &mut [f64]) {
        assert_eq!(out.len(), self.len() * Ahead::ROWS * ahead.distances().len(), "a row a run");
        let rows = out.chunks_exact_mut(Ahead::ROWS * ahead.distances().len());
        self.slots().zip(rows).for_each(|(slot, row)| slot.run.look_ahead(ahead, row));
    }

    /// What the sensors of the run at `index` read last.
    #[must_use]
    pub fn measurement(&self, index: usize) -> &Measurement {
        self.slot(index).run.measurement()
    }

    /// Puts another run into a place (a reset, a restore).
    ///
    /// # Errors
    /// [`BatchError::Structure`] where it differs from the others in its inputs, its signals or its inner step.
    pub fn replace(&mut self, index: usize, run: Run) -> Result<(), BatchError> {
        if Structure::of(&run) != self.structure {
            return Err(BatchError::Structure { index });
        }
        self.statuses[index] = run.status();
        let share = self.shards[0].slots.len();
        self.shards[index / share].replace(index % share, run);
        Ok(())
    }

    /// The run at a place, as a single run that goes on to the same bits.
    #[must_use]
    pub fn run(&self, index: usize) -> Run {
        let share = self.shards[0].slots.len();
        self.shards[index / share].run(index % share)
    }
}
