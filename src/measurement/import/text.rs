//! The text of a proposed `experiment.toml`.

use super::super::columns::quoted;
use super::super::experiment::Kind;
use super::Plan;
use super::survey::Survey;
use std::fmt::Write;

/// Comments stand at this column, where the line leaves room.
const COMMENT_AT: usize = 72;

pub(super) fn settings<'a>(survey: &Survey, kind: Kind, plan: &Plan, copies: impl Iterator<Item = &'a str>) -> String {
    let copies: Vec<&str> = copies.collect();
    let name = copies.first().and_then(|copy| copy.rsplit_once('.')).map_or("imported", |(stem, _)| stem);
    let mut lines = vec![
        "# Proposed by `bekker import` from the names and values of the columns; all keys: examples/experiments.md."
            .to_owned(),
        "# What is marked as a guess is to be checked.".to_owned(),
        format!("name = {}", quoted(name)),
        format!("kind = \"{}\"", kind.name()),
    ];
    lines.extend(kind.format().open_settings().iter().map(|line| (*line).to_owned()));
    lines.extend(ignored(plan));
    lines.push(String::new());
    lines.extend(dialect(survey));
    lines.push("[columns]".to_owned());
    for (column, entry) in &plan.entries {
        let why = entry.guesses.join("; ");
        lines.push(match (entry.line(column), why.is_empty()) {
            (Some(line), true) => line,
            (Some(line), false) => commented(line, &format!("guess: {why}")),
            (None, _) => format!("# {} is named as the model names it", quoted(column)),
        });
    }
    lines.push(String::new());
    lines.extend(inputs(plan));
    lines.push("[parameters]".to_owned());
    for (name, value) in kind.format().rig() {
        if let Some(value) = plan.filled.get(*name) {
            lines.push(format!("{} = {value}", quoted(name)));
        } else if plan.missing.iter().any(|missing| missing.contains(name)) {
            lines.push(format!("# {} = {value}   # fill in, m", quoted(name)));
        }
    }
    for copy in copies {
        lines.extend([String::new(), "[[run]]".to_owned(), format!("file = {}", quoted(copy))]);
    }
    lines.iter().fold(String::new(), |mut text, line| {
        // Writing to a String cannot fail.
        let _ = writeln!(text, "{line}");
        text
    })
}

fn ignored(plan: &Plan) -> Vec<String> {
    if plan.ignored.is_empty() {
        return Vec::new();
    }
    let entry = |(name, reason): &(String, String)| commented(format!("    {},", quoted(name)), reason);
    let inside = plan.ignored.iter().map(entry);
    std::iter::once("ignore = [".to_owned()).chain(inside).chain(["]".to_owned()]).collect()
}

/// How the files are written, where that is not plain: what was found out is said, so that it can be set right.
fn dialect(survey: &Survey) -> Vec<String> {
    let mut found: Vec<[String; 2]> = Vec::new();
    for sheet in &survey.sheets {
        let one = sheet.dialect();
        if !found.contains(&one) {
            found.push(one);
        }
    }
    match found.as_slice() {
        [one] if *one != [",".to_owned(), ".".to_owned()] => vec![
            "[file]".to_owned(),
            commented(format!("separator = {}", quoted(&one[0])), "as found"),
            commented(format!("decimal = {}", quoted(&one[1])), "as found"),
            String::new(),
        ],
        _ => Vec::new(),
    }
}

/// Places for inputs that no column gives.
fn inputs(plan: &Plan) -> Vec<String> {
    let places = [
        ("load", "50.0", "N"),
        ("slip", "0.2", "1"),
        ("wheel_speed", "0.1", "rad/s"),
        ("normal_stress", "10000.0", "Pa"),
    ];
    let wanted = |name: &str| plan.missing.iter().any(|missing| missing.starts_with(&format!("{name} under [inputs]")));
    let lines: Vec<String> = places
        .into_iter()
        .filter(|(name, ..)| wanted(name))
        .map(|(name, value, unit)| match plan.filled.get(name) {
            Some(value) => format!("{name} = {value}   # the same in all rows, {unit}"),
            None => format!("# {name} = {value}   # fill in: the same in all rows, {unit}"),
        })
        .collect();
    if lines.is_empty() {
        return lines;
    }
    std::iter::once("[inputs]".to_owned()).chain(lines).chain([String::new()]).collect()
}

fn commented(line: String, comment: &str) -> String {
    format!("{line:COMMENT_AT$}  # {comment}")
}
