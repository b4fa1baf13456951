//! One precedence: which value of a parameter holds where several places give one, and what is said of it.

use super::compare::CompareError;
use super::given::{Given, Named};
use super::kinds::strategy;
use super::prior_rows::JointPrior;
use super::problem::class_priors;
use super::thresholds::PRIOR_CONTRADICTED;
use crate::measurement::{Experiment, Prior, Run};
use crate::model::{ControlKind, Model, ModelError, ModelKind};
use crate::rover::{MAX_WHEELS, Rover};
use bekker_modeldescription::{Lookup, ParameterError, Role, Variable, nearest};
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
    /// What is known of the soil from other experiments, as far as it is used.
    pub joint: Option<JointPrior>,
    /// What the model that is found is of: of a single wheel that was measured without naming a rover a wheel on a carriage.
    pub found: ModelKind,
    /// What was taken from where, where two places disagree, and priors that come from a class of soil.
    pub sources: Vec<String>,
}

/// One place that gives a value.
struct Layer {
    value: f64,
    place: String,
    /// Whether it is the mean of a prior, which is not a value that is taken for known.
    is_mean: bool,
}

/// Finds the model and the values of all parameters for each run of `experiment`.
pub(super) fn resolve(given: &Given, experiment: &Experiment) -> Result<Resolved, CompareError> {
    let choice = choose(given, experiment)?;
    let strategy = strategy(experiment);
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
    let joint = used_soil(given, experiment, &held, &variables, &mut sources)?;
    let mut of_class = class_priors(experiment, &held);
    of_class.retain(|name, _| joint.as_ref().is_none_or(|joint| joint.of(name).is_none()));
    let mut priors = experiment.priors.clone();
    priors.extend(of_class.iter().map(|(name, prior)| (name.clone(), *prior)));
    let places = Places { given, experiment, rank, label: &label, joint: joint.as_ref(), of_class: &of_class };
    let mut names: BTreeSet<&String> = given.set.keys().chain(experiment.parameters.keys()).collect();
    names.extend(priors.keys());
    names.extend(joint.iter().flat_map(|joint| joint.soil.parameters.iter().map(|parameter| &parameter.name)));
    let stated = model.clone();
    for name in names {
        let layers = places.layers(name, &variables, &stated);
        // The last that is set holds. Those before it are set too, since a wrong name or value is an error wherever it stands.
        for layer in layers.iter().rev() {
            set(&mut model, name, layer.value, &layer.place)?;
        }
        let rig = variables.get(name).is_some_and(|variable| variable.role == Role::Rig);
        sources.extend(disagreement(name, &variables, &layers, rig && rank == Rank::Command));
        let of_soil = joint.as_ref().and_then(|joint| joint.of(name));
        sources.extend(prior_keeps(name, &variables, &layers, experiment.priors.get(name).copied().or(of_soil)));
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
    sources.extend(joint.as_ref().and_then(|joint| other_width(joint, &strategy.contact_widths(experiment, &runs))));
    Ok(Resolved { known: model, runs, held, priors, joint, found, sources })
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
    joint: Option<&'a JointPrior>,
    of_class: &'a BTreeMap<String, Prior>,
}

impl Places<'_> {
    /// All places that give `name` a value for the whole experiment, the one that holds first.
    fn layers(&self, name: &str, variables: &BTreeMap<String, Variable>, stated: &Model) -> Vec<Layer> {
        let layer = |value: f64, place: &str| Layer { value, place: place.to_owned(), is_mean: false };
        let mean = |prior: Prior, place: &str| Layer { is_mean: true, ..layer(prior.mean, place) };
        let by_hand = self.given.set.get(name).map(|value| layer(*value, self.given.set_by));
        let measured = self.experiment.parameters.get(name).map(|value| layer(*value, PARAMETERS));
        let of_prior = |priors: &BTreeMap<String, Prior>, place| priors.get(name).map(|prior| mean(*prior, place));
        let of_soil = || self.joint.and_then(|joint| joint.of(name).map(|prior| mean(prior, &joint.label)));
        let prior = of_prior(&self.experiment.priors, PRIORS);
        let prior = prior.or_else(of_soil).or_else(|| of_prior(self.of_class, CLASS));
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
    let differs = |layer: &&Layer| layer.value != first.value && !layer.is_mean;
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
    prior: Option<Prior>,
) -> Option<String> {
    let (prior, first) = (prior?, layers.first()?);
    let (mean, value, unit) = (figure(prior.mean), figure(first.value), unit_of(name, variables));
    (first.value != prior.mean)
        .then(|| format!("{name}: starts at {value}{unit} from {}; its prior keeps the mean {mean}{unit}", first.place))
}

/// Share by which the width of a contact may differ from that at which a soil was found.
const SAME_WIDTH: f64 = 0.1;

/// The known soil as far as it is used: without what has a prior of its own, what this kind of experiment tells nothing of, and given
/// what is taken for known. What is said of that goes to `sources`.
fn used_soil(
    given: &Given,
    experiment: &Experiment,
    held: &BTreeSet<String>,
    variables: &BTreeMap<String, Variable>,
    sources: &mut Vec<String>,
) -> Result<Option<JointPrior>, CompareError> {
    let Some((soil, label)) = &given.soil else { return Ok(None) };
    for parameter in &soil.parameters {
        let name = &parameter.name;
        let refused = |source| CompareError::Parameter { place: label.clone(), source };
        let Some(variable) = variables.get(name) else {
            let suggestions = nearest(name, variables.keys().cloned());
            return Err(refused(ParameterError::Unknown { name: name.clone(), suggestions }));
        };
        if !variable.allows(parameter.value) {
            let (value, range) = (parameter.value, variable.range());
            return Err(refused(ParameterError::OutOfRange { name: name.clone(), value, range }));
        }
    }
    let words = |name: &str| {
        let prior = soil.parameters.iter().find(|parameter| parameter.name == name);
        prior.map_or_else(String::new, |p| {
            format!("{} +- {}{}", figure(p.value), figure(p.sd), unit_of(name, variables))
        })
    };
    let strategy = strategy(experiment);
    let listed = |name: &str| soil.parameters.iter().any(|parameter| parameter.name == name);
    for (name, prior) in experiment.priors.iter().filter(|(name, _)| listed(name)) {
        let (mean, deviation, unit) = (figure(prior.mean), figure(prior.deviation), unit_of(name, variables));
        sources
            .push(format!("{name}: prior {mean} +- {deviation}{unit} from [priors], not {} from {label}", words(name)));
    }
    let tells = |name: &str| strategy.calibrates(name) || given.calibrated_elsewhere.iter().any(|own| own == name);
    let mut left = soil.without(|name| experiment.priors.contains_key(name) || !tells(name));
    let value = |name: &String| given.set.get(name).or_else(|| experiment.parameters.get(name)).copied();
    for name in held
        .iter()
        .filter(|name| left.parameters.iter().any(|parameter| parameter.name == **name))
        .cloned()
        .collect::<Vec<_>>()
    {
        let Some(value) = value(&name) else {
            // Every run states its own.
            left = left.without(|other| other == name);
            continue;
        };
        let (conditional, shifts) = left.given(&[(name.clone(), value)]);
        let shift = shifts.first().copied().unwrap_or(0.0);
        let far = shift.abs() > PRIOR_CONTRADICTED;
        let what = if far { "what it says of the others is used without it" } else { "the others follow it" };
        sources.push(format!(
            "{name}: {}{} is taken for known, {shift:+.1} standard deviations from {} in {label}; {what}",
            figure(value),
            unit_of(&name, variables),
            words(&name)
        ));
        left = if far { left.without(|other| other == name) } else { conditional };
    }
    let list: Vec<String> = left.parameters.iter().map(|p| format!("{} {}", p.name, words(&p.name))).collect();
    let list = if list.is_empty() { "nothing is left of it that could act".to_owned() } else { list.join(", ") };
    sources.push(format!("priors of {label} (`{}`), with their covariance: {list}", soil.name));
    Ok(JointPrior::new(left, label.clone()))
}

/// Says where k_phi stands for k_c too and was found under another width of contact.
fn other_width(joint: &JointPrior, widths: &[f64]) -> Option<String> {
    let has = |name: &str| joint.of(name).is_some();
    let found = &joint.soil.contact_widths;
    let near = |width: &f64| found.iter().any(|other| (width - other).abs() <= SAME_WIDTH * other);
    if !has("soil.k_phi") || has("soil.k_c") || found.is_empty() || widths.iter().all(near) {
        return None;
    }
    let list = |widths: &[f64]| widths.iter().map(|width| figure(*width)).collect::<Vec<_>>().join(", ");
    Some(format!(
        "{}: k_phi was found at a contact width of {} m and stands for k_c/b + k_phi there; here b is {} m, and the part of k_c is not known",
        joint.label,
        list(found),
        list(widths)
    ))
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
    let wheels = strategy(experiment).commanded_wheels(experiment);
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
