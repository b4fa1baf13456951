//! The diagnosis. It works in a thread of its own, without Python; the calling thread passes fits to the executor, calls
//! `progress` and checks for Ctrl-C.

use crate::compare::{Asked, SoilAsked, TogetherAsked, failed, given, read_soil, together};
use crate::error::{self, InputError, Panic, SimulationError};
use crate::experiment::{Material, Source};
use crate::finding::NativeDiagnosis;
use bekker::diagnosis::{
    CompareError, Control, DiagnoseOptions, Diagnosis, Given, Noise, Outcome, Progress, Spread, Task, Threads,
    diagnose as core_diagnose, fit_task as core_fit_task,
};
use bekker::measurement::Experiment;
use bekker::model::Model;
use pyo3::exceptions::{PyBaseException, PyKeyboardInterrupt};
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyList};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::time::Duration;

/// Time between two checks of Python's signals (Ctrl-C).
const LOOK: Duration = Duration::from_millis(50);

/// A fit for another machine: all that it needs, as JSON, in which numbers keep their bits.
#[derive(Serialize, Deserialize)]
struct Payload {
    /// The model that was chosen, with the parameters that it states, and whether the experiment names it; none where each of several
    /// experiments has its own.
    model: Option<String>,
    stated: Vec<String>,
    by_experiment: bool,
    /// Parameters that are set by hand.
    values: BTreeMap<String, f64>,
    /// What is known of the soil.
    soil: SoilAsked,
    together: TogetherAsked,
    experiment: Material,
    candidates: Option<Vec<String>>,
    added: Vec<String>,
    windows: usize,
    noise: Noise,
    task: Task,
}

/// What the working thread says to the calling one.
enum Event {
    Progress(Progress),
    /// Fits to be made, and where their outcomes go.
    Fits(Vec<Task>, Noise, Sender<Vec<Option<Outcome>>>),
    Done(Result<Result<Box<Diagnosis>, CompareError>, Panic>),
}

/// Fits that are handed to the calling thread, which gives them to an executor.
struct Elsewhere {
    events: Sender<Event>,
}

impl Spread for Elsewhere {
    fn fits(
        &self,
        tasks: &[Task],
        noise: &Noise,
        _local: &(dyn Fn(&Task) -> Option<Outcome> + Sync),
    ) -> Vec<Option<Outcome>> {
        let (sender, outcomes) = channel();
        // If the calling thread has stopped listening, the fits count as not made.
        let sent = self.events.send(Event::Fits(tasks.to_vec(), noise.clone(), sender));
        sent.ok().and_then(|()| outcomes.recv().ok()).unwrap_or_else(|| vec![None; tasks.len()])
    }
}

/// Fits on this machine's threads, until there is a stop.
struct Here {
    stop: Arc<AtomicBool>,
}

impl Spread for Here {
    fn fits(
        &self,
        tasks: &[Task],
        noise: &Noise,
        local: &(dyn Fn(&Task) -> Option<Outcome> + Sync),
    ) -> Vec<Option<Outcome>> {
        let unless_stopped = |task: &Task| if self.stop.load(Ordering::Relaxed) { None } else { local(task) };
        Threads.fits(tasks, noise, &unless_stopped)
    }
}

/// The diagnosis (None where it was abandoned), and what was raised meanwhile.
type Ended<'py> = (Option<NativeDiagnosis>, Option<Bound<'py, PyBaseException>>);

/// Diagnoses. `spread` makes fits, a list of payloads to the list of their outcomes; `progress` takes stage, what is being
/// tried, the share of the work that is done, time since the start and time left (s, or None); `time_budget` is in s. What they raise, and Ctrl-C, comes back beside what was found by then.
#[pyfunction]
#[allow(clippy::too_many_arguments, reason = "keywords of the Python function")]
pub fn diagnose<'py>(
    py: Python<'py>,
    experiment: Source<'_>,
    model: Asked,
    values: BTreeMap<String, f64>,
    candidates: Option<Vec<String>>,
    added: Vec<String>,
    max_effects: usize,
    draws: usize,
    windows: usize,
    spread: Option<Bound<'py, PyAny>>,
    progress: Option<Bound<'py, PyAny>>,
    time_budget: Option<f64>,
    soil: SoilAsked,
    together: TogetherAsked,
) -> PyResult<Ended<'py>> {
    let refused = |_| InputError::new_err("time_budget: expected a positive number of seconds");
    let budget = time_budget.map(Duration::try_from_secs_f64).transpose().map_err(refused)?;
    let (read, material) = experiment.read(py)?;
    let options = DiagnoseOptions { candidates, added, max_effects, draws, windows };
    let material = spread.as_ref().map(|_| material.portable()).transpose()?;
    let given = given(py, &model, &values, &soil, &together)?;
    let chosen = match &spread {
        None => None,
        // Each of several experiments finds its own model, unless one is named for all.
        Some(_) if !read.parts.is_empty() => model.as_ref().map(|(model, _)| (model.borrow(py).core.clone(), false)),
        Some(_) => Some(given.chosen(&read).map_err(|refused| failed(&refused))?),
    };
    let caller = Caller { spread, progress, chosen, values, soil, together, material, options: &options };
    let stop = Arc::new(AtomicBool::new(false));
    let mut events = begin(given, read, options.clone(), caller.spread.is_some(), budget, Arc::clone(&stop));
    let (done, raised) = caller.attend(py, &mut events, &stop);
    let found = match done {
        None => None,
        Some(done) => match (done?, &raised) {
            (Ok(diagnosis), _) => Some(NativeDiagnosis::new(*diagnosis)),
            (Err(refused), None) => return Err(failed(&refused)),
            (Err(_), Some(_)) => None,
        },
    };
    Ok((found, raised.map(|raised| raised.into_value(py).into_bound(py))))
}

/// Starts the working thread.
fn begin(
    given: Given,
    experiment: Experiment,
    options: DiagnoseOptions,
    elsewhere: bool,
    budget: Option<Duration>,
    stop: Arc<AtomicBool>,
) -> Receiver<Event> {
    let (events, receiver) = channel();
    std::thread::spawn(move || {
        let (here, there) = (Here { stop: Arc::clone(&stop) }, Elsewhere { events: events.clone() });
        let tell = |progress| drop(events.send(Event::Progress(progress)));
        let stopped = || stop.load(Ordering::Relaxed);
        let spread: &dyn Spread = if elsewhere { &there } else { &here };
        let control = Control { progress: &tell, stop: &stopped, spread, budget };
        let done = error::fenced(|| core_diagnose(&given, &experiment, &options, &control));
        drop(events.send(Event::Done(done.map(|found| found.map(Box::new)))));
    });
    receiver
}

/// The calling thread's side.
struct Caller<'a, 'py> {
    spread: Option<Bound<'py, PyAny>>,
    progress: Option<Bound<'py, PyAny>>,
    /// The model and whether the experiment names it, where fits are made elsewhere.
    chosen: Option<(Model, bool)>,
    values: BTreeMap<String, f64>,
    soil: SoilAsked,
    together: TogetherAsked,
    /// What the experiment is made of, where fits are made elsewhere.
    material: Option<Material>,
    options: &'a DiagnoseOptions,
}

type Done = Result<Result<Box<Diagnosis>, CompareError>, Panic>;

impl Caller<'_, '_> {
    /// Serves the working thread until it is done. The first Ctrl-C asks it to end and waits for what it has; a second
    /// one, or any other exception, leaves it to end by itself.
    fn attend(&self, py: Python<'_>, events: &mut Receiver<Event>, stop: &AtomicBool) -> (Option<Done>, Option<PyErr>) {
        let mut raised: Option<PyErr> = None;
        loop {
            // A receiver belongs to one thread at a time, so it is lent as a whole.
            let waiting = &mut *events;
            let event = py.detach(move || waiting.recv_timeout(LOOK));
            let served = match event {
                Ok(Event::Done(done)) => return (Some(done), raised),
                Ok(Event::Progress(progress)) => self.tell(&progress),
                Ok(Event::Fits(tasks, noise, reply)) => {
                    self.fit(py, &tasks, &noise, raised.is_some()).map(|outcomes| {
                        // The working thread waits for this; a closed channel means that it has gone.
                        drop(reply.send(outcomes));
                    })
                }
                Err(RecvTimeoutError::Timeout) => Ok(()),
                Err(RecvTimeoutError::Disconnected) => return (None, raised),
            };
            if let Err(error) = served.and_then(|()| py.check_signals()) {
                stop.store(true, Ordering::Relaxed);
                if raised.is_some() || !error.is_instance_of::<PyKeyboardInterrupt>(py) {
                    return (None, Some(raised.unwrap_or(error)));
                }
                raised = Some(error);
            }
        }
    }

    fn tell(&self, progress: &Progress) -> PyResult<()> {
        let Some(call) = &self.progress else { return Ok(()) };
        let share = if progress.total > 0.0 { progress.done / progress.total } else { 0.0 };
        call.call1((progress.stage, &progress.trying, share, progress.elapsed, progress.remaining)).map(drop)
    }

    fn fit(&self, py: Python<'_>, tasks: &[Task], noise: &Noise, stopped: bool) -> PyResult<Vec<Option<Outcome>>> {
        let Some(spread) = self.spread.as_ref().filter(|_| !stopped) else { return Ok(vec![None; tasks.len()]) };
        let Some(material) = &self.material else { return Ok(vec![None; tasks.len()]) };
        let chosen = self.chosen.as_ref();
        let model = chosen.map(|(model, _)| model.to_toml()).transpose().map_err(|refused| error::model(&refused))?;
        let stated = chosen.map(|(model, _)| model.stated.names().map(str::to_owned).collect::<Vec<_>>());
        let (stated, by_experiment) = (stated.unwrap_or_default(), chosen.is_some_and(|(_, named)| *named));
        let payload = |task: &Task| {
            let payload = Payload {
                model: model.clone(),
                stated: stated.clone(),
                by_experiment,
                values: self.values.clone(),
                soil: self.soil.clone(),
                together: self.together.clone(),
                experiment: material.clone(),
                candidates: self.options.candidates.clone(),
                added: self.options.added.clone(),
                windows: self.options.windows,
                noise: noise.clone(),
                task: task.clone(),
            };
            Ok(PyBytes::new(py, &serde_json::to_vec(&payload).map_err(|error| refused(&error))?))
        };
        let payloads = tasks.iter().map(payload).collect::<PyResult<Vec<_>>>()?;
        let outcomes: Vec<Vec<u8>> = spread.call1((PyList::new(py, payloads)?,))?.extract()?;
        if outcomes.len() != tasks.len() {
            let (found, expected) = (outcomes.len(), tasks.len());
            return Err(InputError::new_err(format!("executor: {found} outcomes of {expected} fits")));
        }
        outcomes.iter().map(|bytes| serde_json::from_slice(bytes).map_err(|error| refused(&error))).collect()
    }
}

/// Makes one fit of a diagnosis from its payload.
#[pyfunction]
pub fn fit_task<'py>(py: Python<'py>, payload: &[u8]) -> PyResult<Bound<'py, PyBytes>> {
    // Threads of its own: those of the process do not outlive a fork, and an executor has a worker for each core.
    let refused = |failed: rayon::ThreadPoolBuildError| SimulationError::new_err(failed.to_string());
    let one_core = rayon::ThreadPoolBuilder::new().num_threads(1).build().map_err(refused)?;
    let outcome = py.detach(|| error::fenced(|| one_core.install(|| fitted(payload))))??;
    Ok(PyBytes::new(py, &serde_json::to_vec(&outcome).map_err(|error| self::refused(&error))?))
}

fn fitted(payload: &[u8]) -> PyResult<Option<Outcome>> {
    let payload: Payload = serde_json::from_slice(payload).map_err(|error| refused(&error))?;
    let given = match &payload.model {
        Some(text) => {
            let mut model = Model::from_toml(text, None).map_err(|error| error::model(&error))?;
            model.stated = payload.stated.into_iter().collect();
            Given::again(model, payload.by_experiment, payload.values)
        }
        None => payload.values.iter().fold(Given::default(), |given, (name, value)| given.with_value(name, *value)),
    };
    let given = match &payload.soil {
        Some((text, name)) => given.with_soil(read_soil(text)?, name),
        None => given,
    };
    let given = together(given, &payload.together)?;
    let experiment = payload.experiment.read().map_err(|error| InputError::new_err(error.to_string()))?;
    let options = DiagnoseOptions {
        candidates: payload.candidates,
        added: payload.added,
        windows: payload.windows,
        ..DiagnoseOptions::default()
    };
    core_fit_task(given, &experiment, &options, &payload.noise, &payload.task).map_err(|error| failed(&error))
}

fn refused(error: &serde_json::Error) -> PyErr {
    InputError::new_err(format!("a fit's payload: {error}"))
}
