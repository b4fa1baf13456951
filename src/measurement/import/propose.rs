//! Columns to entries: by name first, then by the sizes of the values.

use super::super::columns::quoted;
use super::super::experiment::Kind;
use super::super::suggestion::{self, Suggested};
use super::super::vocabulary::{numbered, signal_unit};
use super::entry::{Entry, To};
use super::survey::{Column, Survey};
use super::wheels::{USUAL_WHEELS, of_all, other_side, right_side};
use super::{Plan, ranges};

/// A column that is left out and has no more different values than this may tell rows apart that do not belong together.
const FEW: usize = 10;

/// Longer texts are remarks, not labels.
const LABEL: usize = 24;

/// What becomes of all columns.
pub(super) fn plan(survey: &Survey, kind: Kind) -> Plan {
    let mut plan = Plan { entries: Vec::new(), ignored: Vec::new(), unsure: Vec::new(), missing: Vec::new() };
    let mut found: Vec<(&Column, Entry)> = Vec::new();
    for column in &survey.columns {
        match entry(survey, column, kind) {
            Ok(entry) => found.push((column, entry)),
            Err(reason) => plan.ignored.push((column.name.clone(), reason)),
        }
    }
    one_each(&mut found, &mut plan);
    if kind == Kind::Traverse {
        command_by_speed(&mut found);
        runs_by_label(survey, &mut found, &mut plan);
    }
    turn_pull(survey, kind, &mut found);
    for (column, entry) in &found {
        let guesses = entry.guesses.join("; ");
        if !guesses.is_empty() {
            plan.unsure.push(format!("`{}` as {}: {guesses}", column.name, entry.signal().unwrap_or("a parameter")));
        }
    }
    missing(kind, &found, &mut plan);
    plan.entries = found.into_iter().map(|(column, entry)| (column.name.clone(), entry)).collect();
    few_values(survey, kind, &mut plan);
    plan
}

/// What one column becomes, or why it is left out.
fn entry(survey: &Survey, column: &Column, kind: Kind) -> Result<Entry, String> {
    if signal_unit(kind, &column.name).is_some() {
        return Ok(Entry::to(To::Signal(column.name.clone())));
    }
    let suggestion = suggestion::of(kind, &column.name).ok_or("its name says nothing to the model")?;
    if kind == Kind::Traverse && right_side(&column.name) && other_side(survey, &column.name).is_some() {
        return Err("the model is planar: one side of the vehicle, the left one".to_owned());
    }
    let mut entry = match &suggestion.target {
        Suggested::Parameter(name) => Entry::to(To::Parameter((*name).to_owned())),
        Suggested::Signal(signal) if signal == "time" && !column.is_numeric() && column.is_stamp() => {
            return Ok(Entry::to(To::TimeStamp));
        }
        Suggested::Signal(signal) if signal_unit(kind, signal).is_some() => Entry::to(To::Signal(signal.clone())),
        Suggested::Signal(field) => of_all(field, &column.name, wheels(survey)),
    };
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
fn wheels(survey: &Survey) -> usize {
    let number = |column: &Column| match suggestion::of(Kind::Traverse, &column.name)?.target {
        Suggested::Signal(signal) => numbered(&signal).and_then(|(_, _, numbers)| numbers.last().copied()),
        Suggested::Parameter(_) => None,
    };
    survey.columns.iter().filter_map(number).max().unwrap_or(USUAL_WHEELS)
}

/// The unit of the name, else of the row of units, else one that fits the values.
fn read_unit(column: &Column, kind: Kind, named: Option<String>, entry: &mut Entry) {
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
fn one_each(found: &mut Vec<(&Column, Entry)>, plan: &mut Plan) {
    let mut kept: Vec<(&Column, Entry)> = Vec::new();
    for (column, entry) in found.drain(..) {
        match kept.iter_mut().find(|(_, other)| other.target == entry.target) {
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

/// Without a command the recorded speed of the wheels is what the model is to follow.
fn command_by_speed(found: &mut [(&Column, Entry)]) {
    if found.iter().any(|(_, entry)| entry.signal().is_some_and(|signal| signal.ends_with("command"))) {
        return;
    }
    for (column, entry) in found.iter_mut() {
        let Some(signal) = entry.signal().map(str::to_owned) else { continue };
        let Some((_, field @ ("speed" | "rim_speed"), numbers)) = numbered(&signal) else { continue };
        // A number in the name is that of the wheel; else the speed is that of all of a side.
        let own = column.name.chars().any(|c| c.is_ascii_digit());
        let wheels = if own { numbers } else { (1..=USUAL_WHEELS).collect() };
        entry.target = To::Wheels(format!("{field}_command"), wheels);
        entry.guesses.push("there is no command: the model follows this recorded speed".to_owned());
    }
}

/// Where time starts anew, the column that changes there holds the label of the run.
fn runs_by_label<'a>(survey: &'a Survey, found: &mut Vec<(&'a Column, Entry)>, plan: &mut Plan) {
    let Some(time) = found.iter().find(|(_, entry)| entry.target == To::Signal("time".to_owned())) else { return };
    let name = time.0.name.clone();
    let starts = |sheet: &super::super::sheet::Sheet, label: usize| {
        let at = sheet.position(&name)?;
        let time = |row: usize| sheet.value(&sheet.rows[row].cells[at]);
        let anew: Vec<usize> = (1..sheet.rows.len()).filter(|row| time(*row) <= time(row - 1)).collect();
        let changes = |row: &usize| sheet.rows[*row].cells[label] != sheet.rows[row - 1].cells[label];
        Some(!anew.is_empty() && anew.iter().all(changes))
    };
    let label = |column: &&Column| {
        let mut marks = survey.sheets.iter().filter_map(|sheet| starts(sheet, sheet.position(&column.name)?));
        column.distinct(survey.sheets.iter().map(|sheet| sheet.rows.len() / 10).sum()).is_some()
            && marks.any(|mark| mark)
    };
    let taken = |column: &&Column| !found.iter().any(|(other, _)| other.name == column.name);
    if let Some(column) = survey.columns.iter().filter(taken).find(label) {
        plan.ignored.retain(|(name, _)| *name != column.name);
        found.push((column, Entry::to(To::Run)));
    }
}

/// A pull that falls with slip has its sign turned.
fn turn_pull(survey: &Survey, kind: Kind, found: &mut [(&Column, Entry)]) {
    let of = |found: &[(&Column, Entry)], signal: &str| {
        found.iter().position(|(_, entry)| entry.signal() == Some(signal)).filter(|_| kind == Kind::SingleWheel)
    };
    let (Some(pull), Some(slip)) = (of(found, "drawbar_pull"), of(found, "slip")) else { return };
    let mut pairs = (Vec::new(), Vec::new());
    for sheet in &survey.sheets {
        let (Some(a), Some(b)) = (sheet.position(&found[slip].0.name), sheet.position(&found[pull].0.name)) else {
            continue;
        };
        for row in &sheet.rows {
            if let (Some(slip), Some(pull)) = (sheet.value(&row.cells[a]), sheet.value(&row.cells[b])) {
                pairs.0.push(slip);
                pairs.1.push(pull);
            }
        }
    }
    if ranges::falls(&pairs.0, &pairs.1) {
        found[pull].1.turned = true;
        found[pull].1.guesses.push("it falls with slip, so that its sign is taken as turned".to_owned());
    }
}

/// What no column gives.
fn missing(kind: Kind, found: &[(&Column, Entry)], plan: &mut Plan) {
    let has = |wanted: &str| found.iter().any(|(_, entry)| entry.signal() == Some(wanted));
    let parameter = |name: &str| found.iter().any(|(_, entry)| entry.target == To::Parameter(name.to_owned()));
    for name in ["wheel.radius", "wheel.width"].into_iter().filter(|name| !parameter(name)) {
        plan.missing.push(format!("\"{name}\" under [parameters], m"));
    }
    match kind {
        Kind::SingleWheel => {
            if !has("load") {
                plan.missing.push("load under [inputs], N: no column gives it".to_owned());
            }
            let speed = has("wheel_speed") || has("rim_speed");
            let carriage = has("carriage_speed");
            if !(speed || carriage && has("slip")) {
                plan.missing.push("wheel_speed under [inputs], rad/s: no column gives it".to_owned());
            }
            if !has("slip") && !carriage {
                plan.missing.push("slip under [inputs]: no column gives it".to_owned());
            }
            if !["drawbar_pull", "torque", "sinkage"].into_iter().any(has) {
                plan.missing.push("a measured column: drawbar_pull, torque or sinkage".to_owned());
            }
        }
        Kind::Traverse => {
            let command = found.iter().any(|(_, entry)| entry.signal().is_some_and(|s| s.ends_with("command")));
            if !command {
                plan.missing.push("commands of the wheels: a column for speed_command or torque_command".to_owned());
            }
            if !has("time") {
                plan.missing.push("a column for time".to_owned());
            }
            plan.missing.push(
                "`model`, the vehicle: a built-in model (`bekker parameters --models`) or a model file".to_owned(),
            );
        }
    }
}

/// Columns that may tell rows apart which do not belong together.
fn few_values(survey: &Survey, kind: Kind, plan: &mut Plan) {
    let rows: usize = survey.sheets.iter().map(|sheet| sheet.rows.len()).sum();
    for (name, _) in plan.ignored.iter().filter(|_| kind == Kind::SingleWheel) {
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
