//! What the caller may watch and steer: progress, interruption, where the fits are made.

use super::fits::{Noise, Outcome, Task};

/// How far a diagnosis is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Progress {
    /// What is being done, for people.
    pub stage: &'static str,
    /// Work done and work in all, in the same unit of expected effort; the total may grow when a further effect is looked for.
    pub done: f64,
    /// See `done`.
    pub total: f64,
}

/// Makes fits: on this machine's threads, or wherever the caller likes.
pub trait Spread: Sync {
    /// The outcome of each task under `noise`, in the order of the tasks; `local` makes one fit here. `None` where a fit
    /// has no answer. Each task is self-contained (see [`fit_task`](super::fit_task)) and gives the same bits anywhere.
    fn fits(
        &self,
        tasks: &[Task],
        noise: &Noise,
        local: &(dyn Fn(&Task) -> Option<Outcome> + Sync),
    ) -> Vec<Option<Outcome>>;
}

/// The threads of this machine.
#[derive(Clone, Copy, Debug, Default)]
pub struct Threads;

impl Spread for Threads {
    fn fits(
        &self,
        tasks: &[Task],
        _noise: &Noise,
        local: &(dyn Fn(&Task) -> Option<Outcome> + Sync),
    ) -> Vec<Option<Outcome>> {
        crate::parallel::map_in_order(tasks, local)
    }
}

/// Hooks of the caller.
pub struct Control<'a> {
    /// Told after each piece of work.
    pub progress: &'a (dyn Fn(Progress) + Sync),
    /// Asked between pieces of work; once it says yes the diagnosis ends soon, with what it has.
    pub stop: &'a (dyn Fn() -> bool + Sync),
    /// Where fits are made.
    pub spread: &'a dyn Spread,
}

impl Default for Control<'_> {
    fn default() -> Self {
        Self { progress: &|_| {}, stop: &|| false, spread: &Threads }
    }
}
