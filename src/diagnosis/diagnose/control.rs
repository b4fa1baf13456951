//! What the caller may watch and steer: progress, interruption, where the fits are made.

use super::fits::{Noise, Outcome, Task};
use std::time::Duration;

/// How far a diagnosis is.
#[derive(Clone, Debug, PartialEq)]
pub struct Progress {
    /// What is being done, for people.
    pub stage: &'static str,
    /// What is being tried within the stage, for example `slip_sinkage + drag (7 of 22)`; empty where the stage says it all.
    pub trying: String,
    /// Work done and work in all, in the same unit of expected effort.
    pub done: f64,
    /// See `done`.
    pub total: f64,
    /// Time since the start, s.
    pub elapsed: f64,
    /// Estimate of the time left, s: what fits have taken so far times the fits that this stage and, at most, the later ones
    /// still make. `None` before the baseline is calibrated.
    pub remaining: Option<f64>,
}

impl Progress {
    /// The same after further `seconds` in which nothing was told.
    #[must_use]
    pub fn after(&self, seconds: f64) -> Self {
        let remaining = self.remaining.map(|left| (left - seconds).max(0.0));
        Self { elapsed: self.elapsed + seconds, remaining, ..self.clone() }
    }

    /// Stage and what is being tried in it, in one line.
    #[must_use]
    pub fn doing(&self) -> String {
        if self.trying.is_empty() { self.stage.to_owned() } else { format!("{}: {}", self.stage, self.trying) }
    }

    /// The time left in words, rounded to what the estimate is worth: `about 40 s left`.
    #[must_use]
    pub fn time_left(&self) -> String {
        match self.remaining {
            None => "time left not known yet".to_owned(),
            Some(left) if left < 10.0 => "less than 10 s left".to_owned(),
            Some(left) if left < 100.0 => format!("about {:.0} s left", (left / 10.0).round() * 10.0),
            Some(left) if left < 5400.0 => format!("about {:.0} min left", left / 60.0),
            Some(left) => format!("about {:.1} h left", left / 3600.0),
        }
    }
}

/// Makes fits: on this machine's threads, or where the caller's executor runs them.
pub trait Spread: Sync {
    /// The outcome of each task under `noise`, in the order of the tasks; `local` makes one fit here. `None` where a fit
    /// has no answer. Each task is self-contained (see [`fit_task`](super::fit_task)) and gives the same bits anywhere.
    fn fits(
        &self,
        tasks: &[Task],
        noise: &Noise,
        local: &(dyn Fn(&Task) -> Option<Outcome> + Sync),
    ) -> Vec<Option<Outcome>>;

    /// How many fits are made at a time: so many are begun together where a budget of time is kept.
    fn width(&self) -> usize {
        crate::parallel::threads()
    }
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
    /// Told when a piece of work begins and when it ends, from any thread, one call at a time; `done` never falls.
    pub progress: &'a (dyn Fn(Progress) + Sync),
    /// Asked between pieces of work, and at every row of a simulation; once it says yes the diagnosis ends within a second or
    /// two, with what it has.
    pub stop: &'a (dyn Fn() -> bool + Sync),
    /// Where fits are made.
    pub spread: &'a dyn Spread,
    /// Time that the diagnosis may take. Before each batch of fits it is decided whether there is time left for it; what
    /// was not tried is listed in the result, whose numbers are not changed by the budget. The baseline, its noise and the
    /// check of a name without priors are always computed. What is tried then depends on the clock; without a budget the
    /// result is deterministic.
    pub budget: Option<Duration>,
}

impl Default for Control<'_> {
    fn default() -> Self {
        Self { progress: &|_| {}, stop: &|| false, spread: &Threads, budget: None }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(remaining: Option<f64>) -> Progress {
        Progress { stage: "fitting", trying: String::new(), done: 0.1, total: 1.0, elapsed: 5.0, remaining }
    }

    #[test]
    fn property_the_time_left_is_rounded_and_runs_down() {
        assert_eq!(at(None).time_left(), "time left not known yet");
        assert_eq!(at(Some(43.0)).time_left(), "about 40 s left");
        assert_eq!(at(Some(430.0)).time_left(), "about 7 min left");
        assert_eq!(at(Some(2e4)).time_left(), "about 5.6 h left");
        let later = at(Some(43.0)).after(38.0);
        assert_eq!((later.elapsed, later.time_left()), (43.0, "less than 10 s left".to_owned()));
        assert_eq!(at(Some(1.0)).after(30.0).remaining, Some(0.0));
    }
}
