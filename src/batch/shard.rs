//! The part of a batch that one thread steps.

use super::Kernel;
use super::group::{Group, group};
use super::kind::Kind;
use crate::model::{Run, RunError};
#[cfg(any(all(feature = "every-kernel", not(test)), not(target_arch = "x86_64")))]
use crate::scalar::Arrays;
#[cfg(target_arch = "x86_64")]
use crate::scalar::Avx2;
#[cfg(all(feature = "every-kernel", not(test), target_arch = "x86_64"))]
use crate::scalar::Avx512;
use crate::simulation::Status;
use std::panic::{AssertUnwindSafe, catch_unwind};

/// A place of a batch.
#[derive(Debug)]
pub struct Slot {
    /// Its signals, status, time, sensors and the memory of its recorder are always those of the present; its motion may be with a group.
    pub run: Run,
    pub error: Option<RunError>,
    /// Whether the present step moves it.
    pub active: bool,
    /// The group that steps it, where it does not go on by itself.
    group: Option<usize>,
}

impl Slot {
    pub fn new(run: Run) -> Self {
        Self { run, error: None, active: false, group: None }
    }

    fn goes_on(&self) -> bool {
        self.error.is_none() && self.run.status() == Status::Running
    }
}

#[derive(Debug)]
pub struct Shard {
    pub slots: Vec<Slot>,
    groups: Vec<Box<dyn Group>>,
    kernel: Kernel,
    /// Inner steps to make.
    pub steps: u64,
    pub panicked: bool,
}

impl Shard {
    pub fn new(slots: Vec<Slot>, kernel: Kernel) -> Self {
        let mut shard = Self { slots, groups: Vec::new(), kernel, steps: 0, panicked: false };
        (0..shard.slots.len()).for_each(|index| shard.join(index));
        shard
    }

    /// Makes the steps. A panic is caught and recorded, so that the calling thread does not wait for a thread that has ended.
    pub fn step(&mut self) {
        let all = || self.step_all();
        self.panicked |= catch_unwind(AssertUnwindSafe(all)).is_err();
    }

    fn step_all(&mut self) {
        let Self { slots, groups, steps, .. } = self;
        for group in groups.iter_mut() {
            group.step(slots, *steps);
            for index in (*group.members()).into_iter().flatten() {
                if let Some(slot) = slots.get_mut(index).filter(|slot| !slot.goes_on()) {
                    group.leave(index, slot);
                    slot.group = None;
                }
            }
        }
        for slot in slots.iter_mut().filter(|slot| slot.active && slot.group.is_none() && slot.error.is_none()) {
            slot.error = slot.run.advance(*steps).err();
        }
    }

    /// Inner steps made side by side, summed over the runs.
    pub fn steps_side_by_side(&self) -> u64 {
        self.groups.iter().map(|group| group.steps_made()).sum()
    }

    /// Finds a group for the run at `index`, or starts one.
    fn join(&mut self, index: usize) {
        let slot = &mut self.slots[index];
        let Some(kind) = (if slot.goes_on() { Kind::of(&slot.run) } else { None }) else { return };
        let place = self.groups.iter_mut().position(|group| *group.kind() == kind && group.join(index));
        slot.group = place.or_else(|| {
            let mut group = match self.kernel {
                #[cfg(any(all(feature = "every-kernel", not(test)), not(target_arch = "x86_64")))]
                Kernel::Portable => group::<Arrays>(kind, &slot.run),
                #[cfg(target_arch = "x86_64")]
                Kernel::Avx2 => group::<Avx2>(kind, &slot.run),
                #[cfg(all(feature = "every-kernel", not(test), target_arch = "x86_64"))]
                Kernel::Avx512 => group::<Avx512>(kind, &slot.run),
                _ => None,
            }?;
            group.join(index);
            self.groups.push(group);
            Some(self.groups.len() - 1)
        });
    }

    /// Puts another run into a place.
    pub fn replace(&mut self, index: usize, run: Run) {
        let slot = &mut self.slots[index];
        if let Some(group) = slot.group.take().and_then(|place| self.groups.get_mut(place)) {
            group.leave(index, slot);
        }
        *slot = Slot::new(run);
        self.join(index);
    }

    /// The run at a place, with its motion.
    pub fn run(&self, index: usize) -> Run {
        let slot = &self.slots[index];
        let mut run = slot.run.clone();
        if let Some(group) = slot.group.and_then(|place| self.groups.get(place)) {
            group.take_out(index, &mut run);
        }
        run
    }
}
