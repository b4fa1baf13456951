//! Which experiment to make next.
//!
//! Variations of the experiment at hand are simulated with the calibrated model, and chosen by what they would tell
//! apart: the cosine of what two effects change beyond the calibration, and the size of it against the noise. What no
//! variation separates is looked up among experiments in which one cause acts alone, as far as this rig can make them.

use super::Suggestion;
use super::answer::{Answer, Now, answers, rounded, strengths};
use super::special::{Rig, special};
use crate::diagnosis::diagnose::{Verdict, Watch};
use crate::diagnosis::failure::{Failure, quantity};
use crate::diagnosis::noise::NoiseModel;
use crate::diagnosis::problem::Problem;
use crate::diagnosis::thresholds::{ALIKE, CLEARER, NOTABLE};
use crate::effects::SOIL_TEST;
use std::collections::BTreeMap;

/// What a diagnosis could not decide.
pub(crate) struct Question<'a> {
    pub problem: &'a Problem<'a>,
    /// Values of the baseline's parameters.
    pub values: &'a [f64],
    pub noise: &'a BTreeMap<String, NoiseModel>,
    pub verdict: Verdict,
    /// Effects that the verdict names.
    pub named: &'a [String],
    /// Pairs that tie or look alike.
    pub pairs: &'a [[String; 2]],
    /// Effects that could be there without showing.
    pub blind: &'a [String],
    /// Where the model still fails, the worst first.
    pub failures: &'a [Failure],
    /// Whether the noise came from repeats.
    pub repeated: bool,
    pub watch: &'a Watch<'a>,
}

/// Most suggestions.
const MOST: usize = 3;
/// Effects and pairs named in one suggestion.
const LISTED: usize = 3;

/// What to do next, the most decisive first: what contradicts a verdict, what separates a tie or confirms a name, where the
/// misfit is, what the noise is, and last what could not be seen at all. Nothing after a stop.
pub(crate) fn suggest(question: &Question) -> Vec<Suggestion> {
    let answers = answers(question);
    if question.watch.stopped() {
        return Vec::new();
    }
    let (now, rig) = (Now::of(question), Rig::of(question.problem));
    let mut suggestions = Vec::new();
    if question.verdict == Verdict::Undetermined && !question.named.is_empty() && question.pairs.is_empty() {
        suggestions.push(contradiction(question, &rig));
    }
    let mut open_pairs: Vec<usize> = (0..question.pairs.len()).collect();
    let mut open_effects: Vec<usize> = (0..question.blind.len()).collect();
    let mut figures = None;
    if let Some(best) = best(&answers, &now) {
        figures = Some(described(question, best, &now));
        open_pairs.retain(|k| best.cosines[*k] >= ALIKE);
        open_effects.retain(|k| !best.seen[*k]);
    } else if question.pairs.is_empty() {
        figures = confirming(question, &answers, &now);
    }
    let repeats = (!question.repeated && !all_stated(question)).then(|| Suggestion {
        text: "repeat every run at least three times: without repeats the noise, and with it every answer here, is uncertain"
            .to_owned(),
        effects: Vec::new(),
    });
    if question.verdict == Verdict::Unexplained {
        suggestions.extend(where_it_fails(question));
    }
    suggestions.extend(figures);
    suggestions.extend(specials(question, &rig, &open_pairs));
    suggestions.extend(repeats);
    suggestions.extend(unseen(question, &rig, &open_effects));
    suggestions.truncate(MOST);
    suggestions
}

/// Whether the experiment states the noise of everything measured.
fn all_stated(question: &Question) -> bool {
    let experiment = &question.problem.experiment;
    experiment.signals().iter().all(|signal| experiment.noise.contains_key(signal))
}

/// What to do where left-out data or a prior speak against a name.
fn contradiction(question: &Question, rig: &Rig) -> Suggestion {
    let names = question.named.join(", ");
    let text = if rig.untested_soil {
        format!(
            "{}; and measure outside the present ranges: what was left out of the fit speaks against {names}",
            SOIL_TEST.text
        )
    } else {
        format!(
            "measure outside the present ranges, and check the priors: what was left out of the fit, or a prior, speaks against {names}"
        )
    };
    Suggestion { text, effects: question.named.to_vec() }
}

/// Special experiments for pairs that no variation separates; one that serves several pairs is listed once.
fn specials(question: &Question, rig: &Rig, pairs: &[usize]) -> Vec<Suggestion> {
    let mut found: Vec<(&'static str, Vec<&[String; 2]>)> = Vec::new();
    for pair in pairs.iter().map(|k| &question.pairs[*k]) {
        let [a, b] = pair;
        let Some(text) = special(rig, a, Some(b)).or_else(|| special(rig, b, Some(a))) else { continue };
        match found.iter_mut().find(|(known, _)| *known == text) {
            Some((_, served)) => served.push(pair),
            None => found.push((text, vec![pair])),
        }
    }
    // The one that decides most comes first; the table's order stays otherwise.
    found.sort_by_key(|(_, served)| std::cmp::Reverse(served.len()));
    let worded = |(text, served): (&str, Vec<&[String; 2]>)| {
        let between: Vec<String> = served.iter().take(LISTED).map(|[a, b]| format!("{a} and {b}")).collect();
        let mut effects: Vec<String> = served.iter().flat_map(|pair| pair.iter().cloned()).collect();
        effects.sort();
        effects.dedup();
        Suggestion { text: format!("{text}; this decides between {}", between.join(", and between ")), effects }
    };
    found.into_iter().map(worded).collect()
}

/// The one special experiment that shows most of the effects that neither this experiment nor a variation shows.
fn unseen(question: &Question, rig: &Rig, effects: &[usize]) -> Option<Suggestion> {
    let mut found: Vec<(&'static str, Vec<String>)> = Vec::new();
    for id in effects.iter().map(|k| &question.blind[*k]) {
        let Some(text) = special(rig, id, None) else { continue };
        match found.iter_mut().find(|(known, _)| *known == text) {
            Some((_, served)) => served.push(id.clone()),
            None => found.push((text, vec![id.clone()])),
        }
    }
    found.sort_by_key(|(_, served)| std::cmp::Reverse(served.len()));
    let (text, effects) = found.into_iter().next()?;
    Some(Suggestion { text: format!("{text}; this would show {}", effects.join(", ")), effects })
}

/// Where the residual is largest there is most to learn of what no effect explains.
fn where_it_fails(question: &Question) -> Option<Suggestion> {
    let worst = question.failures.first()?;
    let place = worst.place().map_or_else(String::new, |place| format!(" at {place}"));
    let side = if worst.level.mean > 0.0 { "above" } else { "below" };
    let text = format!(
        "measure more densely{place} and record every signal that the rig has: there the measured {} lies {} {side} the model, and no known effect accounts for it",
        worst.signal,
        quantity(&worst.signal, worst.level.mean.abs())
    );
    Some(Suggestion { text, effects: Vec::new() })
}

/// The answer that separates most, then shows most, then is the least work, then has the smallest cosines.
fn best<'a>(answers: &'a [Answer], now: &Now) -> Option<&'a Answer> {
    let mean = |cosines: &[f64]| cosines.iter().sum::<f64>() / cosines.len().max(1) as f64;
    let worth = |answer: &Answer| (answer.solved(), answer.shows());
    let helps = |answer: &&Answer| {
        answer.shows() > 0 || answer.cosines.iter().zip(&now.cosines).any(|(then, now)| now - then > NOTABLE)
    };
    answers.iter().filter(helps).min_by(|a, b| {
        let work = a.variation.cost.cmp(&b.variation.cost);
        worth(b).cmp(&worth(a)).then(work).then(mean(&a.cosines).total_cmp(&mean(&b.cosines)))
    })
}

/// The variation in which the weakest of the named effects stands out most, where that is clearly more than now.
fn confirming(question: &Question, answers: &[Answer], now: &Now) -> Option<Suggestion> {
    if question.verdict != Verdict::EffectMissing || now.sizes.iter().any(|size| *size <= 0.0) {
        return None;
    }
    let gain = |answer: &Answer| {
        answer.sizes.iter().zip(&now.sizes).map(|(then, now)| then / now).fold(f64::INFINITY, f64::min)
    };
    let clear = answers.iter().map(|answer| (gain(answer), answer)).filter(|(gain, _)| gain.is_finite());
    let (gain, best) = clear.max_by(|a, b| a.0.total_cmp(&b.0)).filter(|(gain, _)| *gain >= CLEARER)?;
    Some(Suggestion {
        text: format!(
            "repeat with {}: this confirms {}, whose signature then stands out from the noise {} times as far",
            best.variation.text,
            question.named.join(" and "),
            rounded(gain)
        ),
        effects: question.named.to_vec(),
    })
}

/// A variation in words, with its figures.
fn described(question: &Question, answer: &Answer, now: &Now) -> Suggestion {
    let mut effects: Vec<String> = Vec::new();
    let mut reasons = Vec::new();
    for (k, pair) in question.pairs.iter().enumerate() {
        let (before, then) = (now.cosines[k], answer.cosines[k]);
        if before - then > NOTABLE {
            let [a, b] = pair;
            let verb = if then < ALIKE { "decides" } else { "helps to decide" };
            reasons.push(format!(
                "it {verb} between {a} and {b}, the cosine of whose signatures falls from {before:.2} to {then:.2}"
            ));
            effects.extend(pair.iter().filter(|id| !effects.contains(id)).cloned().collect::<Vec<_>>());
        }
    }
    let hidden = reasons.len().saturating_sub(LISTED);
    reasons.truncate(LISTED);
    if hidden > 0 {
        reasons.push(format!("{hidden} more pairs come apart"));
    }
    let shown: Vec<&String> =
        question.blind.iter().zip(&answer.seen).filter(|(_, seen)| **seen).map(|(id, _)| id).collect();
    if !shown.is_empty() {
        let mut words = strengths(question, answer, &shown[..shown.len().min(LISTED)]);
        if shown.len() > LISTED {
            words.push(format!("{} more", shown.len() - LISTED));
        }
        reasons.push(format!("it would show {}", words.join(", ")));
        effects.extend(shown.into_iter().cloned());
    }
    Suggestion { text: format!("repeat with {}: {}", answer.variation.text, reasons.join("; ")), effects }
}
