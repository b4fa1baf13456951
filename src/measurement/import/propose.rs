//! Columns to entries: by name first, then by the sizes of the values.

use super::super::columns::quoted;
use super::super::experiment::Kind;
use super::super::suggestion::{self, Suggested};
use super::super::vocabulary::numbered;
use super::entry::{Entry, To};
use super::survey::{FoundColumn, Survey};
use super::wheels::{USUAL_WHEELS, of_all, side};
use super::{Plan, ranges};
use std::collections::BTreeMap;

/// A column that is left out and has no more different values than this may tell rows apart that do not belong together.
const FEW: usize = 10;

/// Longer texts are remarks, not labels.
const LABEL: usize = 24;

/// What becomes of all columns.
pub(super) fn plan(survey: &Survey, kind: Kind) -> Plan {
    let mut plan = Plan {
        entries: Vec::new(),
        ignored: Vec::new(),
        unsure: Vec::new(),
        missing: Vec::new(),
        filled: BTreeMap::new(),
    };
    let mut found: Vec<(&FoundColumn, Entry)> = Vec::new();
    for column in &survey.columns {
        match entry(survey, column, kind) {
            Ok(entry) => found.push((column, entry)),
            Err(reason) => plan.ignored.push((column.name.clone(), reason)),
        }
    }
    one_each(&mut found, &mut plan);
    kind.format().mend(survey, &mut found, &mut plan);
    for (column, entry) in &found {
        let guesses = entry.guesses.join("; ");
        if !guesses.is_empty() {
            plan.unsure.push(format!("`{}` as {}: {guesses}", column.name, entry.signal().unwrap_or("a parameter")));
        }
    }
    plan.missing.extend(missing(kind, &found));
    plan.entries = found.into_iter().map(|(column, entry)| (column.name.clone(), entry)).collect();
    few_values(survey, kind, &mut plan);
    plan
}

/// What one column becomes, or why it is left out.
fn entry(survey: &Survey, column: &FoundColumn, kind: Kind) -> Result<Entry, String> {
    if kind.format().signal_unit(&column.name).is_some() {
        return Ok(Entry::to(To::Signal(column.name.clone())));
    }
    let suggestion = suggestion::of(kind, &column.name).ok_or("its name says nothing to the model")?;
    let mut entry = match &suggestion.target {
        Suggested::Parameter(name) => Entry::to(To::Parameter(name.clone())),
        Suggested::Signal(signal) if signal == "time" && !column.is_numeric() && column.is_stamp() => {
            return Ok(Entry::to(To::TimeStamp));
        }
        Suggested::Signal(signal) if kind.format().signal_unit(signal).is_some() => {
            Entry::to(To::Signal(signal.clone()))
        }
        Suggested::Signal(field) => of_all(field, &column.name, wheels(survey, kind)),
    };
    let is_signal = matches!(entry.target, To::Signal(_) | To::Wheels(..));
    entry.side = side(survey, &column.name).filter(|_| is_signal && kind.format().has_course());
    let label = entry.signal() == Some("condition");
    if !label && !column.is_numeric() {
        return Err(if column.texts.is_empty() { "it is empty" } else { "its cells are no numbers" }.to_owned());
    }
    if !suggestion.sure {
        entry.guesses.insert(0, "a short name".to_owned());
    }
    if label {
        return Ok(entry);
    }
    read_unit(column, kind, suggestion.unit, &mut entry);
    Ok(entry)
}

/// Number of wheels that the names count, or the usual one.
fn wheels(survey: &Survey, kind: Kind) -> usize {
    let number = |column: &FoundColumn| match suggestion::of(kind, &column.name)?.target {
        Suggested::Signal(signal) => numbered(&signal).and_then(|(_, _, numbers)| numbers.last().copied()),
        Suggested::Parameter(_) => None,
    };
    survey.columns.iter().filter_map(number).max().unwrap_or(USUAL_WHEELS)
}

/// The unit of the name, else of the row of units, else one that fits the values.
fn read_unit(column: &FoundColumn, kind: Kind, named: Option<String>, entry: &mut Entry) {
    let meaning = match &entry.target {
        To::Parameter(name) => (name.clone(), true),
        _ => (entry.signal().unwrap_or_default().to_owned(), false),
    };
    let Some(si) = suggestion::unit_of(kind, &meaning.0, meaning.1) else { return };
    let known = named.or_else(|| column.unit.clone());
    let upward = meaning.0.ends_with("sinkage") && ranges::upward(&column.numbers);
    if upward {
        entry.turned = true;
        entry.guesses.push("all values are negative, so that it is taken as counted upward".to_owned());
    }
    match known {
        Some(unit) if si.factor_of(&unit).is_ok_and(|factor| factor == 1.0) => {}
        Some(unit) if super::super::mapping::Factor::of_signal(si, Some(&unit)).is_ok() => entry.unit = Some(unit),
        Some(unit) => entry.guesses.push(format!("its unit `{unit}` is none of {}", si.symbol)),
        None => match ranges::unit(kind, &meaning.0, &column.numbers) {
            Some(unit) => {
                entry.unit = Some(unit.to_owned());
                entry.guesses.push(format!("in {unit} by the size of its values"));
            }
            None if si.symbol == "1" => {}
            None => entry.guesses.push(format!("in {} since nothing says otherwise", si.symbol)),
        },
    }
}

/// Keeps one column for each meaning: the one with the fewest guesses, of equals the first.
fn one_each(found: &mut Vec<(&FoundColumn, Entry)>, plan: &mut Plan) {
    let mut kept: Vec<(&FoundColumn, Entry)> = Vec::new();
    for (column, entry) in found.drain(..) {
        match kept.iter_mut().find(|(_, other)| (&other.target, other.side) == (&entry.target, entry.side)) {
            None => kept.push((column, entry)),
            Some(other) => {
                let better = entry.guesses.len() < other.1.guesses.len();
                let out = if better { std::mem::replace(other, (column, entry)).0 } else { column };
                plan.ignored.push((out.name.clone(), format!("`{}` gives the same", other.0.name)));
            }
        }
    }
    *found = kept;
}

/// What no column gives.
pub(super) fn missing(kind: Kind, found: &[(&FoundColumn, Entry)]) -> Vec<String> {
    let parameter = |name: &str| found.iter().any(|(_, entry)| entry.target == To::Parameter(name.to_owned()));
    let unknown = kind.format().rig().iter().map(|(name, _)| name).filter(|name| !parameter(name));
    unknown.map(|name| format!("\"{name}\" under [parameters], m")).chain(kind.format().missing(found)).collect()
}

/// Columns that may tell rows apart which do not belong together.
fn few_values(survey: &Survey, kind: Kind, plan: &mut Plan) {
    let rows: usize = survey.sheets.iter().map(|sheet| sheet.rows.len()).sum();
    for (name, _) in plan.ignored.iter().filter(|_| kind.format().mixes_rows()) {
        let Some(column) = survey.columns.iter().find(|column| column.name == *name) else { continue };
        let short = |values: &Vec<&str>| values.iter().all(|value| value.len() <= LABEL);
        let distinct = column.distinct(FEW).filter(|values| values.len() > 1 && rows > 2 * values.len());
        if let Some(values) = distinct.filter(short) {
            let zero = values.iter().find(|value| value.parse() == Ok(0.0));
            let value = if column.is_numeric() { (*zero.unwrap_or(&values[0])).to_owned() } else { quoted(values[0]) };
            plan.unsure.push(format!(
                "`{name}` is left out and has {} different values: where only some of the rows belong to this experiment, write under [file]: where = {{ {} = {value} }}",
                values.len(),
                quoted(name)
            ));
        }
    }
}
