//! One precedence: which value of a parameter holds where several places give one, and what is said of it.

use super::compare::CompareError;
use super::given::{Given, Named};
use super::kinds::strategy;
use super::problem::class_priors;
use crate::measurement::{Experiment, Prior, Run};
use crate::model::{ControlKind, Model, ModelError, ModelKind};
use crate::rover::{MAX_WHEELS, Rover};
use bekker_modeldescription::{Lookup, Role, Variable};
use std::collections::{BTreeMap, BTreeSet};

/// Places as they are called in messages and errors.
const PARAMETERS: &str = "the experiment's [parameters]";
const PRIORS: &str = "the mean in the experiment's [priors]";
const CLASS: &str = "the mean of the soil's class";

/// Runs named in one line about their own values.
const RUNS_NAMED: usize = 3;

/// Who names the model.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Rank {
    /// The command, or the call: what it states goes before `[parameters]`.
    Command,
    /// The experiment: `[parameters]` go before what it states.
    Experiment,
    /// Nobody: it is built in.
    Nobody,
}

/// The model that is taken.
pub(crate) struct Choice {
    pub model: Model,
    /// How it is called in messages.
    pub label: String,
    pub rank: Rank,
    /// What has to be said of the choice.
    pub sources: Vec<String>,
}

/// A model with what is known of it and of each run.
pub(super) struct Resolved {
    /// What is known of all runs.
    pub known: Model,
    /// What is known of each run.
    pub runs: Vec<Model>,
    /// Parameters that a calibration does not move unless they have a prior.
    pub held: BTreeSet<String>,
    /// Priors of the experiment and of the soil's class.
    pub priors: BTreeMap<String, Prior>,
    /// What the model that is found is of: of a single wheel that was measured without naming a rover a wheel on a carriage.
    pub found: ModelKind,
    /// What was taken from where, where two places disagree, and priors that come from a class of soil.
    pub sources: Vec<String>,
}

/// One place that gives a value.
struct Layer {
    value: f64,
    place: String,
}

/// Finds the model and the values of all parameters for each run of `experiment`.
pub(super) fn resolve(given: &Given, experiment: &Experiment) -> Result<Resolved, CompareError> {
    let choice = choose(given, experiment)?;
    let strategy = strategy(experiment.kind);
    let found = strategy.finds(&choice)?;
    let Choice { mut model, label, rank, mut sources } = choice;
    // A rover's vocabulary contains that of its wheel, so that parameters of a vehicle are taken, and do nothing.
    model.kind = ModelKind::Rover;
    strategy.prepare(&mut model);
    model.define_effects(given.effects.clone())?;
    model.define_effects(experiment.effects.clone())?;
    let variables: BTreeMap<String, Variable> =
        model.list().into_iter().map(|(variable, _)| (variable.name.clone(), variable)).collect();
    let held = held(given, experiment);
    let of_class = class_priors(experiment, &held);
    let mut priors = experiment.priors.clone();
    priors.extend(of_class.iter().map(|(name, prior)| (name.clone(), *prior)));
    let places = Places { given, experiment, rank, label: &label, of_class: &of_class };
    let mut names: BTreeSet<&String> = given.set.keys().chain(experiment.parameters.keys()).collect();
    names.extend(priors.keys());
    let stated = model.clone();
    for name in names {
        let layers = places.layers(name, &variables, &stated);
        // The last that is set holds. Those before it are set too, since a wrong name or value is an error wherever it stands.
        for layer in layers.iter().rev() {
            set(&mut model, name, layer.value, &layer.place)?;
        }
        let rig = variables.get(name).is_some_and(|variable| variable.role == Role::Rig);
        sources.extend(disagreement(name, &variables, &layers, rig && rank == Rank::Command));
        sources.extend(prior_keeps(name, &variables, &layers, experiment.priors.get(name)));
    }
    sources.extend(places.of_runs(&variables, &stated));
    sources.extend(class_line(experiment, &of_class, &variables));
    sources.extend(experiment.measured_drive());
    let runs = experiment.runs.iter().map(|run| {
        let mut own = model.clone();
        for (name, value) in &run.parameters {
            set(&mut own, name, *value, &format!("experiment.toml, run {}", run.name))?;
        }
        Ok(own)
    });
    let runs: Vec<Model> = runs.collect::<Result<_, CompareError>>()?;
    strategy.check_rig(experiment, &runs)?;
    Ok(Resolved { known: model, runs, held, priors, found, sources })
}

fn set(model: &mut Model, name: &str, value: f64, place: &str) -> Result<(), CompareError> {
    model.set(name, value).map_err(|source| CompareError::Parameter { place: place.to_owned(), source })
}

/// What a calibration leaves as it is: values that are set, that `[parameters]` gives, or that every run gives.
fn held(given: &Given, experiment: &Experiment) -> BTreeSet<String> {
    let mut held: BTreeSet<String> = given.set.keys().chain(experiment.parameters.keys()).cloned().collect();
    if let Some((first, others)) = experiment.runs.split_first() {
        let all = first.parameters.keys().filter(|name| others.iter().all(|run| run.parameters.contains_key(*name)));
        held.extend(all.cloned());
    }
    held
}

/// Where values may come from.
struct Places<'a> {
    given: &'a Given,
    experiment: &'a Experiment,
    rank: Rank,
    label: &'a str,
    of_class: &'a BTreeMap<String, Prior>,
}

impl Places<'_> {
    /// All places that give `name` a value for the whole experiment, the one that holds first.
    fn layers(&self, name: &str, variables: &BTreeMap<String, Variable>, stated: &Model) -> Vec<Layer> {
        let layer = |value: f64, place: &str| Layer { value, place: place.to_owned() };
        let by_hand = self.given.set.get(name).map(|value| layer(*value, self.given.set_by));
        let measured = self.experiment.parameters.get(name).map(|value| layer(*value, PARAMETERS));
        let of_prior = |priors: &BTreeMap<String, Prior>, place| priors.get(name).map(|prior| layer(prior.mean, place));
        let prior = of_prior(&self.experiment.priors, PRIORS).or_else(|| of_prior(self.of_class, CLASS));
        let model = Some(name).filter(|name| stated.stated.contains(name));
        let model = model.and_then(|name| stated.clone().get(name).ok()).map(|value| layer(value, self.label));
        let rig = variables.get(name).is_some_and(|variable| variable.role == Role::Rig);
        let order = if self.rank == Rank::Command && !rig {
            [by_hand, model, measured, prior]
        } else if self.rank == Rank::Command {
            [by_hand, measured, model, prior]
        } else {
            [by_hand, measured, prior, model]
        };
        order.into_iter().flatten().collect()
    }

    /// Lines on what runs say of their own against a value that is set or that the named model states.
    fn of_runs(&self, variables: &BTreeMap<String, Variable>, stated: &Model) -> Vec<String> {
        let mut own: BTreeMap<&String, Vec<(&String, f64)>> = BTreeMap::new();
        for run in &self.experiment.runs {
            for (name, value) in &run.parameters {
                own.entry(name).or_default().push((&run.name, *value));
            }
        }
        let line = |(name, values): (&String, Vec<(&String, f64)>)| {
            let layers = self.layers(name, variables, stated);
            let against =
                layers.into_iter().find(|layer| layer.place == self.given.set_by || layer.place == self.label)?;
            let others: Vec<_> = values.into_iter().filter(|(_, value)| *value != against.value).collect();
            let unit = unit_of(name, variables);
            let shown = |(run, value): &(&String, f64)| format!("{}{unit} in run {run}", figure(*value));
            let mut words: Vec<String> = others.iter().take(RUNS_NAMED).map(shown).collect();
            if others.len() > RUNS_NAMED {
                words.push(format!("{} more runs", others.len() - RUNS_NAMED));
            }
            let said = format!(
                "{name}: {} by the runs' own parameters, not {}{unit} from {}",
                words.join(", "),
                figure(against.value),
                against.place
            );
            (!others.is_empty()).then_some(said)
        };
        own.into_iter().filter_map(line).collect()
    }
}

/// What is said where places disagree; nothing where they do not. A prior's mean is not a value that is taken for known.
fn disagreement(
    name: &str,
    variables: &BTreeMap<String, Variable>,
    layers: &[Layer],
    rig_holds: bool,
) -> Option<String> {
    let (first, others) = layers.split_first()?;
    let differs = |layer: &&Layer| layer.value != first.value && layer.place != PRIORS && layer.place != CLASS;
    let unit = unit_of(name, variables);
    let other: Vec<String> =
        others.iter().filter(differs).map(|l| format!("{}{unit} from {}", figure(l.value), l.place)).collect();
    if other.is_empty() {
        return None;
    }
    let why = if rig_holds && first.place == PARAMETERS { ": dimensions and masses of the rig hold" } else { "" };
    Some(format!("{name}: {}{unit} from {}, not {}{why}", figure(first.value), first.place, other.join(" nor ")))
}

/// What is said where a fit starts elsewhere than at the mean of its prior.
fn prior_keeps(
    name: &str,
    variables: &BTreeMap<String, Variable>,
    layers: &[Layer],
    prior: Option<&Prior>,
) -> Option<String> {
    let (prior, first) = (prior?, layers.first()?);
    let (mean, value, unit) = (figure(prior.mean), figure(first.value), unit_of(name, variables));
    (first.value != prior.mean)
        .then(|| format!("{name}: starts at {value}{unit} from {}; its prior keeps the mean {mean}{unit}", first.place))
}

/// The priors of the soil's class that are used.
fn class_line(
    experiment: &Experiment,
    of_class: &BTreeMap<String, Prior>,
    variables: &BTreeMap<String, Variable>,
) -> Option<String> {
    let class = experiment.soil_class.as_deref().and_then(crate::soil_class::SoilClass::find)?;
    let one = |(name, prior): (&String, &Prior)| {
        format!("{name} {} +- {}{}", figure(prior.mean), figure(prior.deviation), unit_of(name, variables))
    };
    let list = of_class.iter().map(one).collect::<Vec<_>>().join(", ");
    let list = if list.is_empty() { "nothing is left free that they could act on".to_owned() } else { list };
    Some(format!("priors of the soil class `{}` ({}): {list}", class.name, class.source))
}

fn unit_of(name: &str, variables: &BTreeMap<String, Variable>) -> String {
    match variables.get(name).map(|variable| variable.unit.symbol) {
        None | Some("1") => String::new(),
        Some(symbol) => format!(" {symbol}"),
    }
}

/// A number with six significant digits.
fn figure(value: f64) -> String {
    format!("{value:.5e}").parse::<f64>().map_or_else(|_| value.to_string(), |short| short.to_string())
}

/// The model of a comparison: the one that is named, else the experiment's own, else one that is built in.
pub(super) fn choose(given: &Given, experiment: &Experiment) -> Result<Choice, CompareError> {
    match (&given.named, &experiment.model) {
        (Some(named), asked) => Ok(named_choice(named, asked.as_deref())),
        (None, Some(name)) => {
            let model = of_experiment(experiment, name)?;
            let label = format!("the experiment's model `{name}`");
            Ok(Choice { model, label, rank: Rank::Experiment, sources: Vec::new() })
        }
        (None, None) => built_in(given, experiment),
    }
}

fn named_choice(named: &Named, asked: Option<&str>) -> Choice {
    let label = if named.by_experiment {
        format!("the experiment's model `{}`", named.name)
    } else {
        format!("MODEL `{}`", named.name)
    };
    let rank = if named.by_experiment { Rank::Experiment } else { Rank::Command };
    let file = |name: &str| std::path::Path::new(name).file_name().map(std::ffi::OsStr::to_owned);
    let other = asked.filter(|asked| file(asked) != file(&named.name) && rank == Rank::Command);
    let said = |asked: &str| format!("model: {label}, not `{asked}` of experiment.toml");
    Choice { model: named.model.clone(), sources: other.map(said).into_iter().collect(), label, rank }
}

/// The model that the experiment names.
fn of_experiment(experiment: &Experiment, name: &str) -> Result<Model, CompareError> {
    let folder = Some(experiment.folder.as_path()).filter(|folder| !folder.as_os_str().is_empty());
    let found = match folder {
        Some(folder) => Model::find(name, Some(folder)).map(|(model, _)| model),
        None => Model::preset(name),
    };
    found.map_err(|error| {
        let message = match (&error, folder) {
            (ModelError::UnknownPreset { .. }, None) => {
                format!("{error}; an experiment in memory has no folder for a file: give the model itself")
            }
            _ => error.to_string(),
        };
        CompareError::Vehicle(format!("experiment.toml, model: {message}"))
    })
}

/// The built-in model, with as many wheels as the commands of a traverse name.
fn built_in(given: &Given, experiment: &Experiment) -> Result<Choice, CompareError> {
    let by_speed = experiment.runs.iter().any(Run::imposes_speeds);
    let mut model = Model::new("two_wheeled", Rover::two_wheeled());
    if by_speed {
        model.control.kind = ControlKind::Speed;
    }
    let wheels = strategy(experiment.kind).commanded_wheels(experiment);
    let mut sources = Vec::new();
    if wheels > model.rover.wheels.len() {
        let (places, said) = wheel_places(given, experiment, wheels)?;
        model.name = format!("rover_with_{wheels}_wheels");
        model.rover = Rover::rigid(&places);
        sources.push(said);
    }
    Ok(Choice { model, label: "the built-in model".to_owned(), rank: Rank::Nobody, sources })
}

/// Positions of the wheels along x, m, where neither model nor experiment describes the rover, and a note that says so.
fn wheel_places(given: &Given, experiment: &Experiment, wheels: usize) -> Result<(Vec<f64>, String), CompareError> {
    if wheels > MAX_WHEELS {
        let message = format!("the commands name {wheels} wheels; a rover has at most {MAX_WHEELS}");
        return Err(CompareError::Vehicle(message));
    }
    let names: Vec<String> = (1..=wheels).map(|k| format!("wheel[{k}].x")).collect();
    let place = |name: &String| given.set.get(name).or_else(|| experiment.parameters.get(name)).copied();
    let missing: Vec<&str> = names.iter().filter(|name| place(name).is_none()).map(String::as_str).collect();
    if !missing.is_empty() {
        return Err(CompareError::Vehicle(format!(
            "the commands name {wheels} wheels and no model is named; give {} under [parameters] (m, from the chassis \
             reference point, rear to front), or name the vehicle: model = \"..\"",
            missing.join(", ")
        )));
    }
    let said = format!(
        "vehicle: a rigid rover with {wheels} wheels, as the commands name them, at wheel[1].x .. wheel[{wheels}].x; what \
         [parameters] do not give (mass, heights, drives) is that of the built-in two-wheeled rover"
    );
    Ok((names.iter().filter_map(place).collect(), said))
}
