//! Which wheels of a rover a column belongs to.

use super::super::mapping::Side;
use super::entry::{Entry, To};
use super::survey::Survey;

/// The built-in rover that stands for a side where nothing else is known has this many wheels.
pub(in crate::measurement) const USUAL_WHEELS: usize = 2;

/// The side of the vehicle that a column's name says, where there is the same column of the other side.
pub(super) fn side(survey: &Survey, name: &str) -> Option<Side> {
    let (side, own, other) = [(Side::Left, "left", "right"), (Side::Right, "right", "left")]
        .into_iter()
        .find(|(_, own, _)| has_word(name, &[own]))?;
    let wanted = name.to_lowercase().replace(own, other);
    survey.columns.iter().any(|column| column.name.to_lowercase() == wanted).then_some(side)
}

/// The target of a wheel's field that its column gives no number for.
pub(super) fn of_all(field: &str, name: &str, wheels: usize) -> Entry {
    let all: Vec<usize> = (1..=wheels).collect();
    if has_word(name, &["rear", "back"]) {
        return with_reason(To::Signal(format!("wheel[1].{field}")), "wheels count from rear to front".to_owned());
    }
    if has_word(name, &["front"]) {
        let target = To::Signal(format!("wheel[{wheels}].{field}"));
        return with_reason(target, format!("the front wheel of {wheels}"));
    }
    match field {
        "current" | "torque" | "normal_force" | "drawbar_pull" => {
            with_reason(To::Wheels(field.to_owned(), all), format!("taken as the sum over {wheels} wheels of a side"))
        }
        _ if field.ends_with("command") => {
            with_reason(To::Wheels(field.to_owned(), all), format!("taken as the command of all {wheels} wheels"))
        }
        _ => {
            with_reason(To::Signal(format!("wheel[1].{field}")), "which wheel it is, the name does not say".to_owned())
        }
    }
}

fn with_reason(target: To, reason: String) -> Entry {
    Entry { guesses: vec![reason], ..Entry::to(target) }
}

fn has_word(name: &str, words: &[&str]) -> bool {
    name.to_lowercase().split(|c: char| !c.is_alphanumeric()).any(|word| words.contains(&word))
}
