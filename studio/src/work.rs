//! Work in the background: calibrations, fits, the ranking of effects, what an experiment tells apart. It is told as it comes, and ends
//! when a person asks it to.

use crate::bench::{Bench, Found};
use bekker::diagnosis::{
    CompareError, Control, DiagnoseOptions, Noise, Outcome, Progress, SeparateOptions, Spread, Task, Threads, diagnose,
    separate_unless,
};
use bekker::report::shown::Values;
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

/// Time between two reports of progress.
const TICK: Duration = Duration::from_millis(150);

/// Something that every tab of an experiment hears.
#[derive(Clone, Debug)]
pub struct Event {
    pub name: &'static str,
    pub data: Arc<str>,
}

impl Event {
    pub fn new(name: &'static str, data: Value) -> Self {
        Self { name, data: data.to_string().into() }
    }
}

/// What may be asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Kind {
    /// Calibrate the baseline.
    Calibrate,
    /// Fit the baseline with some effects.
    Fit,
    /// Find out which effect is missing.
    Rank,
    /// See what the experiment can tell apart.
    Separate,
}

/// A request for work.
#[derive(Clone, Debug, Deserialize)]
pub struct Order {
    pub kind: Kind,
    /// Effects that act: of a fit those that are fitted, else those that belong to the baseline.
    #[serde(default)]
    pub effects: Vec<String>,
    /// Values from which a fit starts.
    #[serde(default)]
    pub values: Values,
}

/// What is at work, at most one of a kind.
#[derive(Default)]
pub struct Jobs(Mutex<BTreeMap<Kind, Job>>);

struct Job {
    stop: Arc<AtomicBool>,
    shown: Value,
}

impl Jobs {
    fn all(&self) -> MutexGuard<'_, BTreeMap<Kind, Job>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// How far everything is.
    pub fn list(&self) -> Vec<Value> {
        self.all().values().map(|job| job.shown.clone()).collect()
    }

    /// Asks work to end; whether there was any.
    pub fn stop(&self, kind: Kind) -> bool {
        self.all().get(&kind).map(|job| job.stop.store(true, Ordering::Relaxed)).is_some()
    }
}

/// Begins work; what there was of the same kind ends.
pub fn begin(bench: &Arc<Bench>, order: Order) {
    let stop = Arc::new(AtomicBool::new(false));
    let kind = order.kind;
    let shown = json!({ "kind": kind, "stage": "starting", "effects": order.effects, "running": true });
    let before = bench.jobs.all().insert(kind, Job { stop: Arc::clone(&stop), shown: shown.clone() });
    if let Some(before) = before {
        before.stop.store(true, Ordering::Relaxed);
    }
    bench.tell(Event::new("job", shown));
    let bench = Arc::clone(bench);
    std::thread::spawn(move || {
        let worker = Worker { bench: &bench, stop: &stop, kind, told: Mutex::new(None) };
        // A panic of a library call must not leave a bar that never ends.
        let outcome = std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| worker.run(&order)));
        let error = match outcome {
            Ok(Ok(())) => None,
            Ok(Err(CompareError::Interrupted)) => Some("stopped".to_owned()),
            Ok(Err(error)) => Some(error.to_string()),
            Err(_) => Some("the work failed: this is a fault of the program".to_owned()),
        };
        let mut jobs = bench.jobs.all();
        // Newer work of the same kind may have taken the place.
        if jobs.get(&kind).is_some_and(|job| Arc::ptr_eq(&job.stop, &stop)) {
            jobs.remove(&kind);
            drop(jobs);
            bench.tell(Event::new("job", json!({ "kind": kind, "running": false, "error": error })));
        }
    });
}

/// One piece of work.
struct Worker<'a> {
    bench: &'a Arc<Bench>,
    stop: &'a Arc<AtomicBool>,
    kind: Kind,
    told: Mutex<Option<Instant>>,
}

impl Worker<'_> {
    fn stopped(&self) -> bool {
        self.stop.load(Ordering::Relaxed)
    }

    fn run(&self, order: &Order) -> Result<(), CompareError> {
        match order.kind {
            Kind::Calibrate => self.calibrate(),
            Kind::Fit => self.fit(order),
            Kind::Rank => self.rank(order),
            Kind::Separate => self.separate(order),
        }
    }

    fn calibrate(&self) -> Result<(), CompareError> {
        self.stage("calibrating the soil", "");
        let calibrated = self.bench.workbench().calibrated(&|| self.stopped())?;
        if self.stopped() {
            return Err(CompareError::Interrupted);
        }
        self.bench.take_calibrated(calibrated)
    }

    fn fit(&self, order: &Order) -> Result<(), CompareError> {
        self.stage("fitting", &order.effects.join(" + "));
        let fit = self.bench.workbench().fitted(&order.effects, &order.values, &|| self.stopped())?;
        if self.stopped() {
            return Err(CompareError::Interrupted);
        }
        let fit = fit.ok_or(CompareError::NoFit)?;
        self.bench.found(Found::of(order.effects.clone(), &fit));
        Ok(())
    }

    fn rank(&self, order: &Order) -> Result<(), CompareError> {
        let workbench = self.bench.workbench();
        let parameters = workbench.parameters();
        let names = |effect: Option<&String>| {
            let own = parameters.iter().filter(|parameter| parameter.effect.as_ref() == effect);
            own.map(|parameter| parameter.variable.name.clone()).collect::<Vec<_>>()
        };
        let mut baseline = names(None);
        baseline.extend(order.effects.iter().flat_map(|id| names(Some(id))));
        let streaming = Streaming { bench: self.bench, baseline, added: &order.effects };
        let progress = |progress: Progress| self.progress(&progress);
        let stop = || self.stopped();
        let control = Control { progress: &progress, stop: &stop, spread: &streaming, ..Control::default() };
        let options = DiagnoseOptions { added: order.effects.clone(), ..DiagnoseOptions::default() };
        let diagnosis = diagnose(&self.bench.given, &self.bench.experiment(), &options, &control)?;
        self.bench.take_diagnosis(diagnosis);
        Ok(())
    }

    fn separate(&self, order: &Order) -> Result<(), CompareError> {
        self.stage("looking at what the experiment can tell apart", "");
        let options = SeparateOptions { added: order.effects.clone(), ..SeparateOptions::default() };
        let stop = || self.stopped();
        let separation = separate_unless(&self.bench.given, &self.bench.experiment(), &options, &stop)?;
        self.bench.take_separation(separation.to_json());
        Ok(())
    }

    fn stage(&self, stage: &str, trying: &str) {
        self.tell(json!({ "kind": self.kind, "running": true, "stage": stage, "trying": trying }));
    }

    /// Tells of progress, a few times a second.
    fn progress(&self, progress: &Progress) {
        let mut told = self.told.lock().unwrap_or_else(PoisonError::into_inner);
        if told.is_some_and(|told| told.elapsed() < TICK) {
            return;
        }
        *told = Some(Instant::now());
        let share = if progress.total > 0.0 { progress.done / progress.total } else { 0.0 };
        self.tell(json!({
            "kind": self.kind, "running": true, "stage": progress.stage, "trying": progress.trying,
            "share": share, "left": progress.time_left(),
        }));
    }

    fn tell(&self, shown: Value) {
        if let Some(job) = self.bench.jobs.all().get_mut(&self.kind).filter(|job| Arc::ptr_eq(&job.stop, self.stop)) {
            job.shown = shown.clone();
        }
        self.bench.tell(Event::new("job", shown));
    }
}

/// Makes the fits of a diagnosis on this machine and tells of each as it comes.
struct Streaming<'a> {
    bench: &'a Bench,
    /// Names of the baseline's parameters, in the order of a fit's values.
    baseline: Vec<String>,
    added: &'a [String],
}

impl Spread for Streaming<'_> {
    fn fits(
        &self,
        tasks: &[Task],
        noise: &Noise,
        local: &(dyn Fn(&Task) -> Option<Outcome> + Sync),
    ) -> Vec<Option<Outcome>> {
        let told = |task: &Task| {
            let outcome = local(task);
            if let Some(outcome) = &outcome {
                self.tell(task, outcome);
            }
            outcome
        };
        Threads.fits(tasks, noise, &told)
    }
}

impl Streaming<'_> {
    /// Tells of a fit to everything; others are parts of the argument.
    fn tell(&self, task: &Task, outcome: &Outcome) {
        let whole = task.left_out.is_empty() && task.scouting.is_none() && !task.guided && task.prior_factor == 1.0;
        let names: Vec<&String> = self.baseline.iter().chain(&task.parameters).collect();
        if !whole || names.len() != outcome.values.len() {
            return;
        }
        self.bench.found(Found {
            effects: self.added.iter().chain(&task.effects).cloned().collect(),
            values: names.into_iter().cloned().zip(outcome.values.iter().copied()).collect(),
            chi_square: outcome.chi_square,
            fitted: None,
        });
    }
}
