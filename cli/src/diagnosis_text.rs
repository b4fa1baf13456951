//! A diagnosis as text.

use crate::output::say;
use anyhow::Result;
use bekker::diagnosis::{
    CandidateResult, Diagnosis, ParameterResult, STANDARD_ERROR, Step, UncountedGroup, UncountedRows,
};
use bekker::report::verdict_in_words;

/// Candidates that are listed.
const LISTED: usize = 10;

/// Prints the verdict and what it rests on.
pub fn print(diagnosis: &Diagnosis) -> Result<()> {
    say!("{}: {}", diagnosis.experiment.name, verdict_in_words(diagnosis));
    print_steps(diagnosis)?;
    print_candidates(diagnosis)?;
    print_parameters(diagnosis)?;
    if !diagnosis.cautions.is_empty() {
        say!("\nbeware:");
        for caution in &diagnosis.cautions {
            say!("  - {caution}");
        }
    }
    print_uncounted(&diagnosis.uncounted, "")?;
    print_whole(diagnosis)?;
    print_partial(diagnosis)?;
    let mut suggestions = diagnosis.suggestions.iter();
    if let Some(first) = suggestions.next() {
        say!("\nnext experiment: {}", first.text);
        for suggestion in suggestions {
            say!("  or: {}", suggestion.text);
        }
    }
    Ok(())
}

/// Stretches of rows that do not count which are printed.
const MOST_UNCOUNTED: usize = 8;

/// Which rows no fit counts, and why.
pub fn print_uncounted(uncounted: &[UncountedRows], indent: &str) -> Result<()> {
    let groups = UncountedGroup::of(uncounted);
    if groups.is_empty() {
        return Ok(());
    }
    let count: usize = groups.iter().map(UncountedGroup::count).sum();
    say!("\n{indent}not counted: {count} rows");
    for group in groups.iter().take(MOST_UNCOUNTED) {
        say!("{indent}  {group}");
    }
    if groups.len() > MOST_UNCOUNTED {
        say!("{indent}  and {} more stretches", groups.len() - MOST_UNCOUNTED);
    }
    Ok(())
}

/// How a drive was cut, and what the final model does over the whole of it.
fn print_whole(diagnosis: &Diagnosis) -> Result<()> {
    let Some(whole) = &diagnosis.whole_drive else { return Ok(()) };
    say!("\njudged in {} windows, each from the measured state", whole.windows);
    if whole.rmse.is_empty() {
        return Ok(());
    }
    let errors: Vec<String> = whole.rmse.iter().map(|(signal, rmse)| format!("{signal} {rmse:.3e}")).collect();
    say!("the final model over the whole of {} runs, error (RMS, SI): {}", whole.runs.len(), errors.join(", "));
    Ok(())
}

/// What is missing from a result that was interrupted or that had a budget of time.
fn print_partial(diagnosis: &Diagnosis) -> Result<()> {
    if diagnosis.interrupted {
        say!("\ninterrupted: this is what was known by then");
    }
    if !diagnosis.not_tried.is_empty() {
        say!("\nnot tried: {}", diagnosis.not_tried.join("; "));
    }
    Ok(())
}

/// Errors step by step, fitted and on what was left out.
fn print_steps(diagnosis: &Diagnosis) -> Result<()> {
    say!("\nerror (RMS, SI) fitted / on what was left out; noise floor: {}", diagnosis.noise_floor_source.name());
    let wide = column(diagnosis.baseline().rmse.keys());
    let added = |step: &Step| step.added.as_ref().map_or_else(|| "calibrated".to_owned(), |id| format!("+ {id}"));
    let names: Vec<String> = diagnosis.steps.iter().map(added).collect();
    let of_step = names.iter().map(String::len).max().unwrap_or(0).max(23);
    let mut header = format!("  {:wide$}", "signal");
    if diagnosis.given.is_some() {
        header += &format!(" {:>10}", "as given");
    }
    for name in &names {
        header += &format!(" {name:>of_step$}");
    }
    say!("{header} {:>10}", "noise");
    let cell = |value: Option<f64>| value.map_or_else(|| "-".to_owned(), |value| format!("{value:.3e}"));
    for signal in diagnosis.baseline().rmse.keys() {
        let mut line = format!("  {signal:wide$}");
        if let Some(given) = &diagnosis.given {
            line += &format!(" {:>10}", cell(given.rmse.get(signal).copied()));
        }
        for step in &diagnosis.steps {
            let (fitted, held) = (step.rmse.get(signal).copied(), step.heldout_rmse.get(signal).copied());
            line += &format!(" {:>of_step$}", format!("{} / {}", cell(fitted), cell(held)));
        }
        let floor = diagnosis.noise_floor.get(signal).and_then(|floor| floor.value());
        say!("{line} {:>10}", cell(floor));
    }
    let lack = &diagnosis.lack_of_fit;
    say!(
        "  baseline: chi-square {:.0} for {} degrees of freedom (p = {:.3}), along the conditions p = {:.3}",
        lack.chi_square,
        lack.degrees_of_freedom,
        lack.p_value,
        lack.p_structure
    );
    Ok(())
}

fn print_candidates(diagnosis: &Diagnosis) -> Result<()> {
    let wide = column(diagnosis.candidates.iter().take(LISTED).map(|candidate| &candidate.effect));
    if !diagnosis.candidates.is_empty() {
        say!("\ncandidates (p not below {:.4}):", diagnosis.smallest_p);
        say!("  {:wide$} {:>11} {:>8} {:>10} {:>9} {:>9}", "effect", "probability", "p", "gain", "held out", "visible");
    }
    for candidate in diagnosis.candidates.iter().take(LISTED) {
        say!("{}", line(candidate, wide, &diagnosis.possible_beside));
    }
    let rest: Vec<&str> = diagnosis.candidates.iter().skip(LISTED).map(|other| other.effect.as_str()).collect();
    if !rest.is_empty() {
        say!("  less probable: {}", rest.join(", "));
    }
    say!(
        "  {:wide$} {:>11}\n  {:wide$} {:>11}",
        "the baseline is enough",
        probability(diagnosis.share.enough),
        "something else",
        probability(diagnosis.share.other)
    );
    if !diagnosis.invisible.is_empty() {
        say!("  invisible to this experiment, and so not judged: {}", diagnosis.invisible.join(", "));
    }
    for [a, b] in &diagnosis.confused_with {
        say!("  {a} and {b} look alike here");
    }
    Ok(())
}

/// A probability, or a dash where some effects were not tried.
fn probability(p: f64) -> String {
    if p.is_nan() { "-".to_owned() } else { format!("{p:.3}") }
}

/// Width of a column of names.
fn column<'n>(names: impl Iterator<Item = &'n String>) -> usize {
    names.map(String::len).max().unwrap_or(0).max(22)
}

fn line(candidate: &CandidateResult, wide: usize, beside: &[String]) -> String {
    let held = candidate
        .heldout_gain
        .map_or_else(|| "-".to_owned(), |gain| format!("{:+.1}", (10.0 * gain).round() / 10.0 + 0.0));
    let marks = match (candidate.tied, candidate.refitted) {
        (true, _) => "  tied",
        _ if beside.contains(&candidate.effect) => "  perhaps besides",
        (false, false) => "  only screened",
        (false, true) => "",
    };
    format!(
        "  {:wide$} {:>11} {:>8.4} {:>10.1} {held:>9} {:>7.0} %{marks}",
        candidate.effect,
        probability(candidate.probability),
        candidate.p_value,
        // No sign before a zero.
        (10.0 * candidate.gain).round() / 10.0 + 0.0,
        100.0 * candidate.visible_share
    )
}

/// Free parameters of the final model, with bounds and flags.
fn print_parameters(diagnosis: &Diagnosis) -> Result<()> {
    say!("\nfree parameters of the final model (+- is the {STANDARD_ERROR}):");
    let (factors, parameters): (Vec<&ParameterResult>, Vec<&ParameterResult>) =
        diagnosis.last().parameters.iter().partition(|own| own.fitted.variable.name.starts_with(SCATTER));
    let wide = column(parameters.iter().map(|own| &own.fitted.variable.name)).max(26);
    for parameter in parameters {
        let interval = diagnosis.profiles.iter().find(|profile| profile.name == parameter.fitted.variable.name);
        say!("{}", parameter_line(parameter, wide, interval.map(|profile| profile.interval)));
    }
    if !factors.is_empty() {
        say!("  soil of each experiment over that of all: {}", scattered(&factors));
    }
    Ok(())
}

/// Factors on the soil of each experiment.
fn scattered(factors: &[&ParameterResult]) -> String {
    let mut parts: Vec<(&str, Vec<String>)> = Vec::new();
    for factor in factors {
        let name = factor.fitted.variable.name.trim_start_matches(SCATTER);
        let (part, what) = name.rsplit_once('.').unwrap_or(("", name));
        let words = format!("{what} {:.3}", factor.fitted.value);
        match parts.iter_mut().find(|(known, _)| *known == part) {
            Some((_, own)) => own.push(words),
            None => parts.push((part, vec![words])),
        }
    }
    parts.iter().map(|(part, own)| format!("{part}: {}", own.join(", "))).collect::<Vec<_>>().join("; ")
}

/// How the names of these factors begin.
const SCATTER: &str = "soil_scatter in ";

fn parameter_line(parameter: &ParameterResult, wide: usize, interval: Option<(Option<f64>, Option<f64>)>) -> String {
    let (fitted, variable) = (&parameter.fitted, &parameter.fitted.variable);
    let deviation = fitted.deviation.map_or_else(String::new, |deviation| format!(" +- {deviation:.2e}"));
    let unit = Some(variable.unit.symbol).filter(|symbol| *symbol != "1").unwrap_or_default();
    let value = format!("{:.4e}{deviation} {unit}", fitted.value);
    let mut flags = Vec::new();
    if let Some((low, high)) = interval {
        let side = |end: Option<f64>| end.map_or_else(|| "open".to_owned(), |end| format!("{end:.3e}"));
        flags.push(format!("95 %: {} .. {}", side(low), side(high)));
    }
    flags.push(format!("bounds {:e} .. {:e}", variable.min, variable.max));
    if let Some(note) = fitted.bound_note() {
        flags.push(note.to_uppercase());
    } else if fitted.deviation.is_none() {
        flags.push("NOT DETERMINED".to_owned());
    }
    if let Some(shift) = fitted.prior_shift() {
        flags.push(format!("{shift:+.1} sigma from its prior"));
    }
    let kind = if parameter.effect { "effect" } else { "" };
    format!("  {:wide$} {value:34} {kind:6} ({})", variable.name, flags.join("; "))
}
