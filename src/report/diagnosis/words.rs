//! The verdict and its reasons in plain sentences, from the numbers of a diagnosis.

use crate::diagnosis::{Diagnosis, Step, Verdict};
use crate::effects::EFFECTS;
use crate::report::units::{digits, of_column, short, spoken};
use crate::report::words::{NOISE_ONLY, first_capital};
use crate::soil_test::TEST_EFFECTS;

/// Signals that a sentence names at most.
const MOST_NAMED: usize = 3;

/// What an effect is, in one line of the library; empty for one that it does not have.
pub(super) fn meaning(effect: &str) -> String {
    EFFECTS
        .iter()
        .chain(TEST_EFFECTS)
        .find(|(id, _)| *id == effect)
        .map_or_else(String::new, |(_, meaning)| meaning.trim().to_owned())
}

/// The effects of the final model that the verdict is about, and those that tie with them.
pub(super) fn named_and_tied(diagnosis: &Diagnosis) -> (Vec<String>, Vec<String>) {
    let added: Vec<String> = diagnosis.steps.iter().filter_map(|step| step.added.clone()).collect();
    diagnosis.involved().into_iter().partition(|effect| added.contains(effect))
}

/// Effects that the last step has but the verdict does not name.
pub(super) fn tried(diagnosis: &Diagnosis) -> Vec<String> {
    let (added, involved) = (diagnosis.steps.iter().filter_map(|step| step.added.clone()), diagnosis.involved());
    added.filter(|effect| !involved.contains(effect)).collect()
}

/// `a`, `a and b`, `a, b and c`.
pub(super) fn listed(names: &[String], word: &str) -> String {
    let names: Vec<String> = names.iter().map(|name| spoken(name)).collect();
    match names.as_slice() {
        [] => String::new(),
        [one] => one.clone(),
        [first @ .., last] => format!("{} {word} {last}", first.join(", ")),
    }
}

/// A share between 0 and 1 as people read it; never 100 % where something is left.
pub(super) fn percent(share: f64) -> String {
    let hundred = 100.0 * share;
    if share < 1.0 && hundred > 99.0 {
        "over 99 %".to_owned()
    } else if share > 0.0 && hundred < 1.0 {
        "under 1 %".to_owned()
    } else {
        format!("{hundred:.0} %")
    }
}

/// A p-value; the bootstrap cannot give less than `smallest`.
pub(super) fn p_value(p: f64, smallest: f64) -> String {
    if p <= smallest * (1.0 + 1e-9) { format!("\u{2264} {}", short(smallest)) } else { digits(p) }
}

/// The verdict in a line: its name, and what it says.
#[must_use]
pub fn verdict_in_words(diagnosis: &Diagnosis) -> String {
    let effects = diagnosis.involved_in_words().join(", ");
    let share = 100.0 * diagnosis.explained_share;
    let word = diagnosis.verdict.name();
    let beside = beside(diagnosis).map_or_else(String::new, |clause| format!("; {clause}"));
    match (diagnosis.verdict, diagnosis.involved().len()) {
        (Verdict::Explained, _) => format!("{word}. The calibrated model leaves only noise; no effect is missing"),
        (Verdict::EffectMissing, 1) => {
            format!(
                "{word}. {effects} is missing from the model and accounts for {share:.0} % of the structure{beside}"
            )
        }
        (Verdict::EffectMissing, _) => {
            format!(
                "{word}. {effects} are missing from the model and account for {share:.0} % of the structure{beside}"
            )
        }
        (Verdict::Unexplained, 0) => {
            format!("{word}. There is more than noise in what the model leaves, and no known effect accounts for it")
        }
        (Verdict::Unexplained, _) => {
            format!("{word}. {effects} accounts for {share:.0} % of the structure only; something else is missing too")
        }
        (Verdict::Undetermined, 0) => {
            format!("{word}. This experiment cannot tell whether an effect is missing")
        }
        (Verdict::Undetermined, _) => format!("{word}. This experiment cannot decide on {effects}"),
    }
}

/// What may act beside the effects that are named.
fn beside(diagnosis: &Diagnosis) -> Option<String> {
    let possible = &diagnosis.possible_beside;
    (!possible.is_empty()).then(|| format!("perhaps {} acts besides", listed(possible, "or")))
}

/// The verdict in one sentence.
pub(super) fn answer(diagnosis: &Diagnosis) -> String {
    let (named, tied) = named_and_tied(diagnosis);
    match diagnosis.verdict {
        Verdict::Explained => {
            "Nothing is missing that this experiment could show: the calibrated model leaves only noise.".to_owned()
        }
        Verdict::EffectMissing if named.len() > 1 => {
            format!("{} effects are missing from the model: {}.", named.len(), listed(&named, "and"))
        }
        Verdict::EffectMissing => {
            format!("One effect is missing from the model: {}.", listed(&diagnosis.effects, "and"))
        }
        Verdict::Unexplained if diagnosis.effects.is_empty() => {
            "The model misses something that no known effect explains.".to_owned()
        }
        Verdict::Unexplained => format!(
            "{} explain{} only part of what the model misses ({}); the rest matches no known effect.",
            first_capital(&listed(&diagnosis.effects, if tied.is_empty() { "and" } else { "or" })),
            if diagnosis.effects.len() > 1 && tied.is_empty() { "" } else { "s" },
            percent(diagnosis.explained_share)
        ),
        Verdict::Undetermined if !tied.is_empty() => undecided(&named, &tied),
        Verdict::Undetermined if !named.is_empty() => {
            format!(
                "Undecided: {} would account for the misfit, but the evidence does not hold.",
                listed(&named, "and")
            )
        }
        Verdict::Undetermined => "This experiment cannot decide whether an effect is missing.".to_owned(),
    }
}

fn undecided(named: &[String], tied: &[String]) -> String {
    if named.len() > 1 {
        format!(
            "The model misses {}, but {} could stand in the place of one of them: this experiment cannot tell.",
            listed(named, "and"),
            listed(tied, "or")
        )
    } else {
        let all: Vec<String> = named.iter().chain(tied).cloned().collect();
        format!("The model misses something, but this experiment cannot tell what: {}.", listed(&all, "or"))
    }
}

/// The reasons under the verdict.
pub(super) fn reasons(diagnosis: &Diagnosis) -> Vec<String> {
    let mut sentences = Vec::new();
    if diagnosis.interrupted {
        sentences.push(
            "The work was interrupted: this is a partial result, and what was not done is missing below.".to_owned(),
        );
    }
    if !diagnosis.not_tried.is_empty() {
        sentences.push(format!("Not tried: {}.", diagnosis.not_tried.join("; ")));
    }
    let (named, _) = named_and_tied(diagnosis);
    let fit = &diagnosis.lack_of_fit;
    let p = equals(fit.p_structure.min(fit.p_value), diagnosis.smallest_p);
    match diagnosis.verdict {
        Verdict::Explained => sentences.push(format!(
            "What the calibrated model leaves is no larger than noise alone makes it (p {p}), and no candidate effect gains more than chance."
        )),
        Verdict::Undetermined if named.is_empty() => sentences.push(format!(
            "What the calibrated model leaves may be noise (p {p}), but an effect could hide in it."
        )),
        _ => sentences.push(format!("The calibrated model without any added effect leaves more than noise (p {p}).")),
    }
    sentences.push(error_sentence(diagnosis, &named));
    let tried = tried(diagnosis);
    if !tried.is_empty() {
        sentences.push(format!(
            "The nearest candidate, {}, leaves {} of what could be explained: too much to name it.",
            listed(&tried, "with"),
            percent(diagnosis.last().left)
        ));
    } else if !named.is_empty() {
        sentences.push(format!(
            "{} for {} of what could be explained.",
            if named.len() > 1 { "Together they account" } else { "It accounts" },
            percent(diagnosis.explained_share)
        ));
    }
    if let Some(clause) = beside(diagnosis) {
        sentences.push(format!("{}; this experiment cannot tell.", first_capital(&clause)));
    }
    if let (false, Some(p)) = (named.is_empty(), only_candidate(diagnosis, &named)) {
        let p = equals(p, diagnosis.smallest_p);
        sentences.push(format!("Noise alone lets some candidate gain as much with p {p}."));
    }
    sentences
}

/// `= 0.3`, or `≤ 0.002` at the smallest.
fn equals(p: f64, smallest: f64) -> String {
    let text = p_value(p, smallest);
    if text.starts_with('\u{2264}') { text } else { format!("= {text}") }
}

/// The p-value of the effect where only one is named.
fn only_candidate(diagnosis: &Diagnosis, named: &[String]) -> Option<f64> {
    let [only] = named else { return None };
    diagnosis.candidates.iter().find(|candidate| candidate.effect == *only).map(|candidate| candidate.p_value)
}

/// Which errors are above the noise, of the model with what is named.
fn error_sentence(diagnosis: &Diagnosis, named: &[String]) -> String {
    let step = shown_step(diagnosis);
    let mut above: Vec<(f64, String)> = Vec::new();
    let mut unknown = Vec::new();
    for (signal, rmse) in &step.rmse {
        match diagnosis.noise_floor.get(signal).and_then(|floor| floor.value()) {
            Some(floor) if *rmse > NOISE_ONLY * floor => {
                let text =
                    format!("{} {} times ({})", spoken(signal), digits(rmse / floor), of_column(signal).number(*rmse));
                above.push((rmse / floor, text));
            }
            Some(_) => {}
            None => unknown.push(signal.clone()),
        }
    }
    above.sort_by(|a, b| b.0.total_cmp(&a.0));
    let model = match named {
        [] => "Its error".to_owned(),
        [one] => format!("With {} the error", spoken(one)),
        _ => "With them the error".to_owned(),
    };
    let mut sentence = if !above.is_empty() {
        let rest = above.len().saturating_sub(MOST_NAMED);
        let mut names: Vec<String> = above.into_iter().take(MOST_NAMED).map(|(_, text)| text).collect();
        if rest > 0 {
            names.push(format!("{rest} more"));
        }
        format!("{model} is above the noise: {}.", names.join(", "))
    } else if unknown.len() == step.rmse.len() {
        String::new()
    } else {
        let signals = if unknown.is_empty() { "every signal" } else { "every signal whose noise is known" };
        let but = if diagnosis.verdict == Verdict::Unexplained {
            ", but what is left follows the conditions, which noise does not"
        } else {
            ""
        };
        format!("{model} is as small as the noise in {signals}{but}.")
    };
    if !unknown.is_empty() {
        sentence.push_str(&format!(
            " Noise floor unknown for {}: nothing was repeated and no noise is stated.",
            listed(&unknown, "and")
        ));
    }
    sentence.trim().to_owned()
}

/// The step that the first screen shows as the end: the last one, unless what it added is not named.
pub(super) fn shown_step(diagnosis: &Diagnosis) -> &Step {
    if named_and_tied(diagnosis).0.is_empty() { diagnosis.baseline() } else { diagnosis.last() }
}

/// A probability as people read it: never certain; a dash where it was not computed.
pub(super) fn probability(p: f64) -> String {
    if p.is_nan() {
        "\u{2013}".to_owned()
    } else if p > 0.99 {
        "over 99 %".to_owned()
    } else if p < 0.01 {
        "under 1 %".to_owned()
    } else {
        format!("{:.0} %", 100.0 * p)
    }
}
