//! One open experiment: the prepared measurements, the steps that were accepted, what the work in the background has found.

use crate::error::Refusal;
use crate::options::Opened;
use crate::work::{Event, Jobs};
use bekker::diagnosis::{Calibration, CompareError, Diagnosis, Given, Workbench};
use bekker::measurement::Experiment;
use bekker::report::shown::{self, Form, Values};
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError, RwLock};
use tokio::sync::broadcast;

/// Events that a slow browser may fall behind by, before it is told the whole state again.
const BACKLOG: usize = 1024;

/// Most steps of a history.
const MOST_STEPS: usize = 1000;

/// A model that was accepted.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Step {
    /// What was done, for people.
    pub label: String,
    /// The step from which it was reached; `None` of the first.
    pub parent: Option<usize>,
    /// Effects that act in it.
    pub effects: Vec<String>,
    /// Values that differ from the given model's, by parameter.
    pub values: Values,
    /// Errors of the model, by signal.
    #[serde(default)]
    pub rmse: BTreeMap<String, f64>,
}

/// A fit of the baseline with some effects, as the background found it.
#[derive(Clone, Debug, Serialize)]
pub struct Found {
    pub effects: Vec<String>,
    pub values: Values,
    pub chi_square: f64,
    /// Standard errors and bounds, where they were computed.
    pub fitted: Option<BTreeMap<String, Value>>,
}

/// Share of chi-square within which two fits are the same but for where their searches ended.
const SAME_FIT: f64 = 1e-3;

impl Found {
    /// A fit with its standard errors.
    pub fn of(effects: Vec<String>, fit: &Calibration) -> Self {
        let all = fit.parameters.iter();
        Self {
            effects,
            values: all.clone().map(|p| (p.variable.name.clone(), p.value)).collect(),
            chi_square: fit.chi_square,
            fitted: Some(all.map(|p| (p.variable.name.clone(), shown::fitted_value(p))).collect()),
        }
    }

    /// Whether it takes the place of another fit of the same effects: it is better, or as good and with standard errors.
    fn replaces(&self, known: &Self) -> bool {
        let same = (self.chi_square - known.chi_square).abs() <= SAME_FIT * known.chi_square;
        if same && self.fitted.is_some() != known.fitted.is_some() {
            return self.fitted.is_some();
        }
        self.chi_square < known.chi_square
    }
}

/// An open experiment.
pub struct Bench {
    pub id: String,
    pub example: bool,
    pub given: Given,
    pub jobs: Jobs,
    pub events: broadcast::Sender<Event>,
    workbench: RwLock<Arc<Workbench>>,
    state: Mutex<State>,
}

/// What is remembered for every tab.
#[derive(Default)]
struct State {
    steps: Vec<Step>,
    found: Vec<Found>,
    diagnosis: Option<Arc<Diagnosis>>,
    separation: Option<Value>,
}

impl Bench {
    pub fn open(id: String, opened: Opened) -> Result<Self, CompareError> {
        let Opened { experiment, given, example } = opened;
        let workbench = Workbench::open(&given, &experiment)?;
        let rmse = workbench.trial(&Values::new(), false)?.fit.rmse;
        let first =
            Step { label: "as given".to_owned(), parent: None, effects: Vec::new(), values: Values::new(), rmse };
        Ok(Self {
            id,
            example,
            given,
            jobs: Jobs::default(),
            events: broadcast::channel(BACKLOG).0,
            workbench: RwLock::new(Arc::new(workbench)),
            state: Mutex::new(State { steps: vec![first], ..State::default() }),
        })
    }

    fn state(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The prepared experiment as it is now.
    pub fn workbench(&self) -> Arc<Workbench> {
        Arc::clone(&self.workbench.read().unwrap_or_else(PoisonError::into_inner))
    }

    /// The measurements.
    pub fn experiment(&self) -> Experiment {
        self.workbench().experiment().clone()
    }

    /// The experiment in a list.
    pub fn listed(&self) -> Value {
        let workbench = self.workbench();
        let experiment = workbench.experiment();
        json!({
            "id": self.id, "name": experiment.name, "kind": experiment.kind.name(), "example": self.example,
            "parts": experiment.parts.len(),
        })
    }

    /// All that the page has to know of it but for what the models give.
    pub fn shown(&self) -> Value {
        let workbench = self.workbench();
        shown::experiment(&workbench, workbench.experiment(), &self.id, self.example, &Form::plain())
    }

    /// Tells every tab.
    pub fn tell(&self, event: Event) {
        // Nobody may be listening.
        let _ = self.events.send(event);
    }

    /// Takes the calibrated baseline, and makes it a step.
    pub fn take_calibrated(&self, calibrated: Workbench) -> Result<(), CompareError> {
        let Some(found) = calibrated.baseline() else { return Ok(()) };
        let found = Found::of(Vec::new(), &found.calibration);
        let values = found.values.clone();
        let rmse = calibrated.trial(&values, false)?.fit.rmse;
        *self.workbench.write().unwrap_or_else(PoisonError::into_inner) = Arc::new(calibrated);
        let step = Step { label: "soil calibrated".to_owned(), parent: Some(0), effects: Vec::new(), values, rmse };
        self.tell(Event::new("calibrated", Value::Null));
        self.found(found);
        // A tab may have told it to a server that was started again: the same measurements give the same values.
        if !self.state().steps.iter().any(|known| known.effects.is_empty() && known.values == step.values) {
            self.push(step);
        }
        Ok(())
    }

    /// Remembers a fit, of several of the same effects the best, and tells of it.
    pub fn found(&self, mut found: Found) {
        found.effects.sort();
        let mut state = self.state();
        let known = state.found.iter().position(|known| known.effects == found.effects);
        match known {
            Some(at) if !found.replaces(&state.found[at]) => return,
            Some(at) => state.found[at] = found.clone(),
            None => state.found.push(found.clone()),
        }
        drop(state);
        self.tell(Event::new("fit", json!(found)));
    }

    /// Every model that was accepted.
    pub fn steps(&self) -> Vec<Step> {
        self.state().steps.clone()
    }

    /// Accepts a model.
    pub fn accept(&self, mut step: Step) -> Result<usize, Refusal> {
        if step.label.chars().count() > 200 {
            return Err(Refusal::bad("a label of at most 200 characters is expected"));
        }
        let steps = self.state().steps.len();
        if step.parent.is_none_or(|parent| parent >= steps) {
            return Err(Refusal::missing("such step to go on from"));
        }
        if steps >= MOST_STEPS {
            return Err(Refusal::bad("the history is full"));
        }
        step.effects.sort();
        step.rmse = self.workbench().trial(&step.values, false)?.fit.rmse;
        Ok(self.push(step))
    }

    fn push(&self, step: Step) -> usize {
        let mut state = self.state();
        state.steps.push(step.clone());
        let at = state.steps.len() - 1;
        drop(state);
        self.tell(Event::new("step", json!({ "at": at, "step": step })));
        at
    }

    /// Takes what a diagnosis has found.
    pub fn take_diagnosis(&self, diagnosis: Diagnosis) {
        let shown = shown::diagnosis(&diagnosis);
        self.state().diagnosis = Some(Arc::new(diagnosis));
        self.tell(Event::new("diagnosis", shown));
    }

    /// The last diagnosis.
    pub fn diagnosis(&self) -> Option<Arc<Diagnosis>> {
        self.state().diagnosis.clone()
    }

    /// Takes what the experiment can tell apart.
    pub fn take_separation(&self, separation: Value) {
        self.state().separation = Some(separation.clone());
        self.tell(Event::new("separation", separation));
    }

    /// All that a tab has to know that comes or comes back.
    pub fn snapshot(&self) -> Event {
        let state = self.state();
        let data = json!({
            "steps": state.steps,
            "found": state.found,
            "diagnosis": state.diagnosis.as_ref().map(|diagnosis| shown::diagnosis(diagnosis)),
            "separation": state.separation,
            "jobs": self.jobs.list(),
        });
        Event::new("snapshot", data)
    }
}
