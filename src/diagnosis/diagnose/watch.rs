//! The course of a diagnosis by the clock: what is being tried, how long the rest may take, and what a budget leaves time for.

use super::control::{Control, Progress};
use super::fits::{Noise, Outcome, Task};
use super::untried::{Untried, named};
use crate::diagnosis::halt::Halt;
use crate::diagnosis::kinds::Strategy;
use crate::parallel::map_in_order;
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::Instant;

/// The stages of a diagnosis, in their order.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Phase {
    Baseline,
    Noise,
    Singles,
    Sets,
    LeftOut,
    Rivals,
    Profiles,
    Next,
    Done,
}

impl Phase {
    /// All, in their order.
    const ALL: [Self; 9] = [
        Self::Baseline,
        Self::Noise,
        Self::Singles,
        Self::Sets,
        Self::LeftOut,
        Self::Rivals,
        Self::Profiles,
        Self::Next,
        Self::Done,
    ];
}

/// What is known of a stage beforehand, whatever the kind of the experiment.
struct Row {
    words: &'static str,
    /// Share of the expected work that is done when the stage begins.
    from: f64,
    /// Share of a budget, of what is left of it after the baseline, by which the stage's last piece has to end.
    until: f64,
}

/// By [`Phase`].
const ROWS: [Row; 9] = [
    Row { words: "calibrating the baseline", from: 0.0, until: 1.0 },
    Row { words: "what noise alone would give", from: 0.15, until: 1.0 },
    Row { words: "fitting each effect", from: 0.3, until: 0.5 },
    Row { words: "looking for the best set", from: 0.5, until: 0.65 },
    Row { words: "predicting what was left out", from: 0.75, until: 0.8 },
    Row { words: "fitting what could stand in its place", from: 0.85, until: 0.88 },
    Row { words: "profiles", from: 0.9, until: 0.94 },
    Row { words: "planning the next experiment", from: 0.95, until: 1.0 },
    Row { words: "done", from: 1.0, until: 1.0 },
];

/// Share by which a new estimate of the remaining time moves the reported one: more where it is sooner.
const SOONER: f64 = 0.5;
const LATER: f64 = 0.2;

/// The baseline is calibrated under a first guess of the noise and again under the final one: a first measure of what a fit
/// costs, three fits of a single effect as measured on a reduced traverse.
const OF_BASELINE: usize = 3;

/// Fits after which their duration is known well enough to be reported.
const ENOUGH: usize = 2;

/// Measures the work done and reports progress to the caller.
pub(crate) struct Watch<'a> {
    control: &'a Control<'a>,
    strategy: &'static dyn Strategy,
    start: Instant,
    state: Mutex<State>,
}

/// The work so far, from which progress is computed.
struct State {
    phase: Phase,
    trying: String,
    /// Pieces of the batch at hand: begun, done, in all.
    begun: usize,
    done: usize,
    planned: usize,
    /// When the batch at hand began, s since the start.
    since: f64,
    /// What a piece of it costs in single fits; `None` where it is a fit.
    weight: Option<f64>,
    /// Pieces of the stage that are done, in single fits.
    within: f64,
    /// Time of all finished batches of fits, s, and fits made in them.
    spent: f64,
    fits: usize,
    /// Share of the work that was told last.
    share: f64,
    /// Time of the end that was told last, s since the start.
    end: Option<f64>,
    /// When the baseline and its noise were known, s since the start.
    known: f64,
    untried: Vec<Untried>,
}

impl State {
    /// Duration of one fit with all threads at work, s, as far as it is known.
    fn cost(&self, now: f64) -> Option<f64> {
        let running = if self.planned > 0 && self.weight.is_none() { (now - self.since, self.done) } else { (0.0, 0) };
        let made = self.fits + running.1;
        (made >= ENOUGH).then(|| (self.spent + running.0) / made as f64)
    }

    /// Most of the stage that is still to be done, in single fits: the batch at hand, or what is known of the stage.
    fn here(&self, strategy: &dyn Strategy) -> f64 {
        let batch = self.planned.saturating_sub(self.done) as f64 * self.weight.unwrap_or(1.0);
        batch.max(strategy.work(self.phase) - self.within)
    }
}

impl<'a> Watch<'a> {
    pub fn new(control: &'a Control<'a>, strategy: &'static dyn Strategy) -> Self {
        let state = State {
            phase: Phase::Baseline,
            trying: String::new(),
            begun: 0,
            done: 0,
            planned: 0,
            since: 0.0,
            weight: None,
            within: 0.0,
            spent: 0.0,
            fits: 0,
            share: 0.0,
            end: None,
            known: 0.0,
            untried: Vec::new(),
        };
        Self { control, strategy, start: Instant::now(), state: Mutex::new(state) }
    }

    /// Whether the caller asked to end.
    pub fn stopped(&self) -> bool {
        (self.control.stop)()
    }

    /// What simulations ask.
    pub fn halt(&self) -> Halt<'a> {
        Halt::when(self.control.stop)
    }

    fn now(&self) -> f64 {
        self.start.elapsed().as_secs_f64()
    }

    /// No panic of another thread leaves the few numbers here half written.
    fn state(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Begins a stage.
    pub fn begin(&self, phase: Phase, trying: &str) {
        let mut state = self.state();
        state.phase = phase;
        state.within = 0.0;
        trying.clone_into(&mut state.trying);
        if phase == Phase::Noise {
            (state.spent, state.fits) = (self.now(), OF_BASELINE);
        }
        if phase == Phase::Singles {
            state.known = self.now();
        }
        self.tell(&mut state);
    }

    /// Tells what is being tried within the stage.
    pub fn trying(&self, what: &str) {
        let mut state = self.state();
        what.clone_into(&mut state.trying);
        self.tell(&mut state);
    }

    /// The lock is held meanwhile, so that the caller hears of everything in its order.
    fn tell(&self, state: &mut State) {
        let now = self.now();
        let remaining = self.remaining(state, now);
        let row = &ROWS[state.phase as usize];
        let next = ROWS.get(state.phase as usize + 1).map_or(1.0, |next| next.from);
        let within = state.within / (state.within + state.here(self.strategy)).max(1.0);
        // A stage may turn out to be longer than was known.
        state.share = state.share.max(row.from + within * (next - row.from));
        (self.control.progress)(Progress {
            stage: row.words,
            trying: state.trying.clone(),
            done: state.share,
            total: 1.0,
            elapsed: now,
            remaining,
        });
    }

    /// Estimate of the time left, s.
    fn remaining(&self, state: &mut State, now: f64) -> Option<f64> {
        if state.phase == Phase::Done {
            return Some(0.0);
        }
        let later: f64 = Phase::ALL[state.phase as usize + 1..].iter().map(|phase| self.strategy.work(*phase)).sum();
        let mut end = now + state.cost(now)? * (state.here(self.strategy) + later);
        if let Some(budget) = self.control.budget {
            end = end.min(budget.as_secs_f64().max(now));
        }
        let told = state.end.unwrap_or(end);
        let end = told + if end < told { SOONER } else { LATER } * (end - told);
        state.end = Some(end);
        Some((end - now).max(0.0))
    }

    /// Whether there is time for one more batch that takes as long as `fits` single fits.
    pub fn has_time(&self, fits: f64) -> bool {
        self.ends_in_time(|state, now| fits * state.cost(now).unwrap_or(0.0))
    }

    /// Whether there is time to do once more what was done since the baseline was known.
    pub fn has_time_again(&self) -> bool {
        self.ends_in_time(|state, now| now - state.known)
    }

    /// Whether what takes so many seconds more ends by the stage's share of the budget.
    fn ends_in_time(&self, takes: impl Fn(&State, f64) -> f64) -> bool {
        let Some(budget) = self.control.budget else { return true };
        let (state, now) = (self.state(), self.now());
        let until = state.known + ROWS[state.phase as usize].until * (budget.as_secs_f64() - state.known);
        now + takes(&state, now) <= until
    }

    /// Notes what is not done.
    pub fn leave(&self, what: impl IntoIterator<Item = Untried>) {
        self.state().untried.extend(what);
    }

    /// What was not done so far.
    pub fn untried(&self) -> Vec<Untried> {
        self.state().untried.clone()
    }

    /// Makes fits as far as there is time; `None` for the others, and where a fit has no answer. `known` says whether a set
    /// is fitted already.
    pub fn fits(
        &self,
        tasks: &[Task],
        noise: &Noise,
        known: &dyn Fn(&[String]) -> bool,
        fit: &(dyn Fn(&Task) -> Option<Outcome> + Sync),
    ) -> Vec<Option<Outcome>> {
        let local = |task: &Task| self.piece(&words(task), || fit(task));
        let untried = |task: &Task| {
            let set = task.effects.clone();
            match task {
                _ if known(&set) => Untried::Again(set),
                Task { scouting: Some(_), .. } => Untried::Look(set),
                _ => Untried::Fit(set),
            }
        };
        self.plan(tasks.len(), None);
        let mut all = Vec::with_capacity(tasks.len());
        for part in self.parts(tasks, self.control.spread.width()) {
            let outcomes = if self.stopped() || !self.has_time(part.len() as f64) {
                self.leave(part.iter().map(untried));
                vec![None; part.len()]
            } else {
                let outcomes = self.control.spread.fits(part, noise, &local);
                self.made_elsewhere(all.len() + part.len());
                if self.stopped() {
                    let cut = part.iter().zip(&outcomes).filter(|(_, outcome)| outcome.is_none());
                    self.leave(cut.map(|(task, _)| untried(task)));
                }
                outcomes
            };
            all.extend(outcomes);
        }
        self.finish();
        all
    }

    /// `f` of every item as far as there is time, each taking about as long as `cost` single fits; `words` says what an item
    /// is, `untried` what is noted where it is left out. What a stop has cut short is left out too.
    pub fn pieces<T: Sync, R: Send>(
        &self,
        items: &[T],
        cost: f64,
        words: impl Fn(&T) -> String + Sync,
        untried: impl Fn(&T) -> Untried,
        f: impl Fn(&T) -> Option<R> + Sync,
    ) -> Vec<Option<R>> {
        self.plan(items.len(), Some(cost));
        let mut all = Vec::with_capacity(items.len());
        for part in self.parts(items, crate::parallel::threads()) {
            if self.stopped() || !self.has_time(cost * part.len() as f64) {
                self.leave(part.iter().map(&untried));
                all.extend(part.iter().map(|_| None));
                continue;
            }
            let whole = |item: &T| {
                let made = self.piece(&words(item), || f(item));
                (made, self.stopped())
            };
            for (item, (made, cut)) in part.iter().zip(map_in_order(part, whole)) {
                if cut {
                    self.leave([untried(item)]);
                }
                all.push(made.filter(|_| !cut));
            }
        }
        self.finish();
        all
    }

    /// All at once, or with a budget so many at a time.
    fn parts<'t, T>(&self, items: &'t [T], width: usize) -> std::slice::Chunks<'t, T> {
        items.chunks(if self.control.budget.is_some() { width.max(1) } else { items.len().max(1) })
    }

    fn plan(&self, pieces: usize, weight: Option<f64>) {
        let mut state = self.state();
        state.weight = weight;
        (state.begun, state.done, state.planned, state.since) = (0, 0, pieces, self.now());
    }

    /// Counts fits that were made on other machines, which do not tell of themselves.
    fn made_elsewhere(&self, made: usize) {
        let mut state = self.state();
        let silent = made.saturating_sub(state.begun);
        state.begun += silent;
        state.done += silent;
        state.within += silent as f64;
        if silent > 0 {
            self.tell(&mut state);
        }
    }

    /// Ends a batch; those of fits say how long a fit takes.
    fn finish(&self) {
        let mut state = self.state();
        if state.weight.is_none() {
            state.spent += self.now() - state.since;
            state.fits += state.done;
        }
        (state.begun, state.done, state.planned) = (0, 0, 0);
    }

    /// Does one piece of a batch and reports it.
    fn piece<R>(&self, words: &str, f: impl FnOnce() -> Option<R>) -> Option<R> {
        if self.stopped() {
            return None;
        }
        {
            let mut state = self.state();
            state.begun += 1;
            state.trying = format!("{words} ({} of {})", state.begun, state.planned);
            self.tell(&mut state);
        }
        let made = f();
        let mut state = self.state();
        state.done += 1;
        state.within += state.weight.unwrap_or(1.0);
        self.tell(&mut state);
        made
    }
}

/// What a fit tries.
fn words(task: &Task) -> String {
    let set = named(&task.effects);
    match task {
        Task { guided: true, .. } => format!("{set}, rovers led at the measured velocity"),
        Task { scouting: Some(_), .. } => format!("{set}, a first look"),
        _ => set,
    }
}
