//! The part of a batch that one thread steps.

use crate::model::{Run, RunError};
use std::panic::{AssertUnwindSafe, catch_unwind};

/// A place of a batch.
#[derive(Debug)]
pub struct Slot {
    pub run: Run,
    pub error: Option<RunError>,
    /// Whether the present step moves it.
    pub active: bool,
}

impl Slot {
    pub fn new(run: Run) -> Self {
        Self { run, error: None, active: false }
    }
}

#[derive(Debug)]
pub struct Shard {
    pub slots: Vec<Slot>,
    /// Inner steps to make.
    pub steps: u64,
    pub panicked: bool,
}

impl Shard {
    pub fn new(slots: Vec<Slot>) -> Self {
        Self { slots, steps: 0, panicked: false }
    }

    /// Makes the steps. A panic is noted and goes no further, so that nobody waits for a thread that is gone.
    pub fn step(&mut self) {
        let steps = self.steps;
        let all = || {
            for slot in self.slots.iter_mut().filter(|slot| slot.active) {
                slot.error = slot.run.advance(steps).err();
            }
        };
        self.panicked |= catch_unwind(AssertUnwindSafe(all)).is_err();
    }
}
