//! What a column may be, from its name: `DP [kN]` is likely a drawbar pull in kN.

use super::columns::quoted;
use super::experiment::Kind;
use super::vocabulary::parameter;
use crate::effects::Effects;
use bekker_modeldescription::Unit;
use std::borrow::Cow;

/// What a name is likely to mean.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Suggestion {
    pub target: Suggested,
    /// The unit that the name gives.
    pub unit: Option<String>,
    /// Whether the name says it in words, not in a letter or two.
    pub sure: bool,
}

#[derive(Clone, Debug, PartialEq)]
pub(super) enum Suggested {
    /// A signal under its name; of a wheel whose number the name does not give, its field alone.
    Signal(String),
    Parameter(String),
}

/// All of the words must be in the name.
#[derive(Clone)]
pub(super) struct Rule {
    words: &'static [&'static str],
    meaning: Cow<'static, str>,
    sure: bool,
}

/// A rule whose words say it.
pub(super) const fn sure(words: &'static [&'static str], meaning: &'static str) -> Rule {
    Rule { words, meaning: Cow::Borrowed(meaning), sure: true }
}

/// A rule that is a guess.
pub(super) const fn maybe(words: &'static [&'static str], meaning: &'static str) -> Rule {
    Rule { words, meaning: Cow::Borrowed(meaning), sure: false }
}

/// What the effects say of headers that mean one of their parameters.
fn parameters_of_effects() -> Vec<Rule> {
    let effects = Effects::<f64>::default();
    let rules = effects.facts().flat_map(|(id, facts)| {
        let rule = move |header: &crate::effects::Header| Rule {
            words: header.words,
            meaning: format!("{id}.{}", header.parameter).into(),
            sure: true,
        };
        facts.headers.iter().map(rule)
    });
    rules.collect()
}

/// Words that make of a column something else than the rest of its name says: a scatter, a sensor that is not modelled,
/// an angle of slip, a wanted value.
const OTHER: [&str; 13] =
    ["std", "sd", "sigma", "stdev", "stddev", "error", "err", "count", "angle", "yaw", "roll", "side", "temperature"];

/// What the column called `name` may be; `None` where the name says nothing.
pub(super) fn of(kind: Kind, name: &str) -> Option<Suggestion> {
    let bracket = bracketed(name);
    let base = match &bracket {
        Some(_) => name.split(['[', '(']).next().unwrap_or(name),
        None => name,
    };
    let words = words(base);
    if words.len() > 1 && words[0] == "s" {
        return None;
    }
    let signal = best(kind.format().rules(), &words).map(|rule| (rule, false));
    let parameter =
        best(&[kind.format().parameter_rules(), &parameters_of_effects()].concat(), &words).map(|rule| (rule, true));
    // A parameter takes more words than a signal, or is none.
    let (rule, is_parameter) = match (signal, parameter) {
        (Some(signal), Some(parameter)) if parameter.0.words.len() < signal.0.words.len() => signal,
        (Some(_) | None, Some(parameter)) => parameter,
        (Some(signal), None) => signal,
        (None, None) => return None,
    };
    if words.iter().any(|word| OTHER.contains(&word.as_str()) && !rule.words.contains(&word.as_str())) {
        return None;
    }
    let meaning = if is_parameter { rule.meaning.to_string() } else { of_wheel(kind, &rule.meaning, base) };
    let unit = bracket.or_else(|| suffix(&unit_of(kind, &meaning, is_parameter)?, &words, &rule));
    let target = if is_parameter { Suggested::Parameter(meaning) } else { Suggested::Signal(meaning) };
    Some(Suggestion { target, unit, sure: rule.sure })
}

/// The line of `[columns]` that the name suggests.
pub(super) fn line(kind: Kind, name: &str) -> Option<String> {
    let suggestion = of(kind, name)?;
    let unit = suggestion.unit.map_or_else(String::new, |unit| format!(", unit = {}", quoted(&unit)));
    Some(match suggestion.target {
        Suggested::Parameter(parameter) => format!("{} = {{ parameter = \"{parameter}\"{unit} }}", quoted(name)),
        Suggested::Signal(signal) if unit.is_empty() && kind.format().signal_unit(&signal).is_some() => {
            format!("{} = \"{signal}\"", quoted(name))
        }
        Suggested::Signal(signal) => {
            let wheels = if kind.format().signal_unit(&signal).is_none() { ", wheels = [..]" } else { "" };
            format!("{} = {{ signal = \"{signal}\"{wheels}{unit} }}", quoted(name))
        }
    })
}

/// The SI unit of what a suggestion means; a field of a wheel has the same for every wheel.
pub(super) fn unit_of(kind: Kind, meaning: &str, is_parameter: bool) -> Option<Unit> {
    if is_parameter {
        return parameter(meaning, &[]).ok().map(|variable| variable.unit);
    }
    kind.format().signal_unit(meaning).or_else(|| kind.format().signal_unit(&format!("wheel[1].{meaning}")))
}

/// The unit in brackets at the end of a column's name.
pub(super) fn bracketed(name: &str) -> Option<String> {
    let name = name.trim();
    let inside = |open: char, close: char| {
        let (base, unit) = name.strip_suffix(close)?.rsplit_once(open)?;
        (!base.trim().is_empty() && !unit.trim().is_empty()).then(|| unit.trim().to_owned())
    };
    // `wheel[2]` is no unit.
    inside('[', ']').or_else(|| inside('(', ')')).filter(|unit| unit.parse::<f64>().is_err())
}

fn best(rules: &[Rule], words: &[String]) -> Option<Rule> {
    let fits = |rule: &&Rule| rule.words.iter().all(|word| words.iter().any(|own| own == word));
    // A single letter means something only where it is all there is, but for a number and a unit.
    let alone =
        |rule: &&Rule| rule.words.concat().len() > 1 || words.first().is_some_and(|first| *first == rule.words[0]);
    rules.iter().filter(fits).filter(alone).max_by_key(|rule| (rule.words.len(), rule.sure)).cloned()
}

/// Words of a name in lower case: parted by anything but letters and digits, by digits, and where a capital follows a
/// small letter.
fn words(name: &str) -> Vec<String> {
    let mut words = vec![String::new()];
    let mut before = ' ';
    for c in name.chars() {
        let parts = (before.is_lowercase() && c.is_uppercase())
            || (before.is_alphanumeric() && c.is_alphanumeric() && before.is_numeric() != c.is_numeric());
        if parts || !c.is_alphanumeric() {
            words.push(String::new());
        }
        if c.is_alphanumeric()
            && let Some(last) = words.last_mut()
        {
            last.extend(c.to_lowercase());
        }
        before = c;
    }
    words.retain(|word| !word.is_empty());
    words
}

/// The unit that the words behind the name spell, as in `drawbar_pull_kn` or `gyro_deg_s`.
fn suffix(unit: &Unit, words: &[String], rule: &Rule) -> Option<String> {
    let free = |word: &String| !rule.words.contains(&word.as_str()) || words.iter().filter(|w| *w == word).count() > 1;
    let last = words.last().filter(|word| free(word) || *word == "rpm")?;
    let two = words.len().checked_sub(2).map(|k| format!("{}/{last}", words[k]));
    let spelled = |symbol: &String| {
        unit.factor_of(symbol).is_ok()
            || (unit.symbol == Unit::NEWTON.symbol && Unit::KILOGRAM.factor_of(symbol).is_ok())
    };
    let found = two.filter(spelled).or_else(|| Some(last.clone()).filter(spelled))?;
    // In the spelling of the table, where capitals differ only.
    let usual = unit.symbols().into_iter().find(|symbol| symbol.eq_ignore_ascii_case(&found));
    Some(usual.map_or(found, str::to_owned))
}

/// A signal of a wheel by its full name where the column's name has a number: `I_2` is the current of wheel 2.
fn of_wheel(kind: Kind, meaning: &str, name: &str) -> String {
    let wheel = kind.format().signal_unit(meaning).is_none();
    let number = words(name).iter().find_map(|word| word.parse::<usize>().ok()).filter(|number| *number > 0);
    match number.filter(|_| wheel) {
        Some(number) => format!("wheel[{number}].{meaning}"),
        None => meaning.to_owned(),
    }
}
