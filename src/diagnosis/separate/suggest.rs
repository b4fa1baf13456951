//! Which experiment to make next.
//!
//! Variations of the experiment at hand are simulated with the calibrated model, and chosen by what they would tell
//! apart: the cosine of what two effects change beyond the calibration, and the size of it against the noise. What no
//! variation separates is looked up among experiments in which one cause acts alone.

use super::Suggestion;
use super::look::Look;
use super::separation::{expect_all, models, planned_noise};
use super::special::special;
use super::strength::smallest;
use super::variation::{Variation, variations};
use crate::diagnosis::diagnose::{ALIKE, DETECTABLE, Verdict};
use crate::diagnosis::failure::Failure;
use crate::diagnosis::linear_algebra::norm;
use crate::diagnosis::noise::NoiseModel;
use crate::diagnosis::problem::Problem;
use crate::parallel::map_in_order;
use bekker_modeldescription::Role;
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
    pub stop: &'a dyn Fn() -> bool,
}

/// Effects and pairs named in one suggestion.
const NAMED: usize = 4;
/// A fall of a cosine by less is no reason for an experiment.
const NOTABLE: f64 = 0.1;

/// A variation and what it would see.
struct Answer {
    variation: Variation,
    /// Cosines of the pairs; 1 where one of the two is not seen.
    cosines: Vec<f64>,
    /// Whether each of the question's blind effects would be found at full strength.
    seen: Vec<bool>,
}

impl Answer {
    fn solved(&self) -> usize {
        self.cosines.iter().filter(|cosine| **cosine < ALIKE).count()
    }

    fn shows(&self) -> usize {
        self.seen.iter().filter(|seen| **seen).count()
    }

    fn worth(&self) -> (usize, usize) {
        (self.solved(), self.shows())
    }
}

/// What to do next, the most useful first.
pub(crate) fn suggest(question: &Question) -> Vec<Suggestion> {
    let mut suggestions = Vec::new();
    if question.verdict == Verdict::Unexplained {
        suggestions.extend(where_it_fails(question));
    }
    if question.verdict == Verdict::Undetermined && !question.named.is_empty() && question.pairs.is_empty() {
        suggestions.push(Suggestion {
            text: "test the soil anew (plate, shear ring) and measure under conditions outside the present ranges: what was left out of the fit, or a prior, contradicts the effect"
                .to_owned(),
            effects: question.named.to_vec(),
        });
    }
    if !question.repeated {
        suggestions.push(Suggestion {
            text: "repeat every run at least three times: without repeats the noise, and with it every answer here, is uncertain"
                .to_owned(),
            effects: Vec::new(),
        });
    }
    let answers = if (question.stop)() { Vec::new() } else { answers(question) };
    let now = cosines_now(question);
    let mut open_pairs: Vec<usize> = (0..question.pairs.len()).collect();
    let mut open_effects: Vec<usize> = (0..question.blind.len()).collect();
    if let Some(best) = best(&answers, &now) {
        // What contradicts the verdict comes first, then figures, then the plea for repeats.
        let first = usize::from(suggestions.len() > usize::from(!question.repeated));
        suggestions.insert(first, described(question, best, &now));
        open_pairs.retain(|k| best.cosines[*k] >= ALIKE);
        open_effects.retain(|k| !best.seen[*k]);
    }
    suggestions.extend(specials(question, &open_pairs, &open_effects));
    suggestions
}

/// Special experiments for what no variation separates or shows; one that serves several effects is listed once.
fn specials(question: &Question, pairs: &[usize], effects: &[usize]) -> Vec<Suggestion> {
    let mut found: Vec<(&'static str, Vec<String>)> = Vec::new();
    let mut add = |text: &'static str, ids: &[String]| {
        let at = found.iter().position(|(known, _)| *known == text).unwrap_or_else(|| {
            found.push((text, Vec::new()));
            found.len() - 1
        });
        let new: Vec<String> = ids.iter().filter(|id| !found[at].1.contains(id)).cloned().collect();
        found[at].1.extend(new);
    };
    for pair in pairs.iter().map(|k| &question.pairs[*k]) {
        let [a, b] = pair;
        if let Some(text) = special(a, Some(b)).or_else(|| special(b, Some(a))) {
            add(text, pair);
        }
    }
    for id in effects.iter().map(|k| &question.blind[*k]) {
        if let Some(text) = special(id, None) {
            add(text, std::slice::from_ref(id));
        }
    }
    let worded = |(text, effects): (&str, Vec<String>)| Suggestion {
        text: format!("for {}: {text}", effects.join(", ")),
        effects,
    };
    found.into_iter().map(worded).collect()
}

/// Where the residual is largest there is most to learn of what no effect explains.
fn where_it_fails(question: &Question) -> Option<Suggestion> {
    let worst = question.failures.first()?;
    let level = &worst.level;
    let text = format!(
        "measure more densely where {} = {:.3} .. {:.3} and record every signal that can be had: there {} is off by {:+.2e} (SI) and no known effect accounts for it",
        worst.condition, level.low, level.high, worst.signal, level.mean
    );
    Some(Suggestion { text, effects: Vec::new() })
}

/// The answer that separates most, then shows most, then is the least work, then has the smallest cosines.
fn best<'a>(answers: &'a [Answer], now: &[f64]) -> Option<&'a Answer> {
    let mean = |cosines: &[f64]| cosines.iter().sum::<f64>() / cosines.len().max(1) as f64;
    let helps =
        |answer: &&Answer| answer.shows() > 0 || answer.cosines.iter().zip(now).any(|(then, now)| now - then > NOTABLE);
    answers.iter().filter(helps).min_by(|a, b| {
        let work = a.variation.cost.cmp(&b.variation.cost);
        b.worth().cmp(&a.worth()).then(work).then(mean(&a.cosines).total_cmp(&mean(&b.cosines)))
    })
}

/// Cosines in the experiment at hand.
fn cosines_now(question: &Question) -> Vec<f64> {
    if question.pairs.is_empty() {
        return Vec::new();
    }
    match Look::new(question.problem, question.values, question.noise) {
        Ok(look) => question.pairs.iter().map(|[a, b]| look.cosine(a, b)).collect(),
        Err(_) => vec![1.0; question.pairs.len()],
    }
}

/// All variations that the model can compute.
fn answers(question: &Question) -> Vec<Answer> {
    if question.pairs.is_empty() && question.blind.is_empty() {
        return Vec::new();
    }
    let model = question.problem.improved(&question.problem.base, question.values);
    let variations = variations(&model, &question.problem.experiment);
    let ask = |variation: &Variation| {
        if (question.stop)() {
            return None;
        }
        with_look(question, variation, |_, look| {
            let seen = |id: &String| look.size(id) >= DETECTABLE;
            let cosine = |[a, b]: &[String; 2]| if seen(a) && seen(b) { look.cosine(a, b) } else { 1.0 };
            Answer {
                variation: variation.clone(),
                cosines: question.pairs.iter().map(cosine).collect(),
                seen: question.blind.iter().map(seen).collect(),
            }
        })
    };
    // One after the other: `stop` need not be shared, and each is spread over the threads itself.
    variations.iter().filter_map(ask).collect()
}

/// Calls `f` with the variation's problem and what it would see of the question's effects.
fn with_look<R>(question: &Question, variation: &Variation, f: impl FnOnce(&Problem, &Look) -> R) -> Option<R> {
    let given = question.problem.again(&question.problem.base, question.values);
    let mut added: Vec<String> = Vec::new();
    for free in question.problem.base.iter().filter(|free| free.variable.role == Role::Effect) {
        let id = free.variable.name.split('.').next().unwrap_or_default().to_owned();
        if !added.contains(&id) {
            added.push(id);
        }
    }
    let mut problem = Problem::new(given, &variation.experiment, &added).ok()?;
    let asked = |id: &String| question.blind.contains(id) || question.pairs.iter().any(|pair| pair.contains(id));
    problem.library.retain(|candidate| asked(&candidate.id));
    expect_all(&mut problem);
    let values: Vec<f64> = problem.base.iter().map(|free| free.start).collect();
    let modelled = problem.predict(&problem.base, |predict| predict.values(&values)).ok()?.ok()?;
    let mut noise = models(&planned_noise(&problem, &modelled));
    for (signal, model) in &mut noise {
        if let Some(known) = question.noise.get(signal) {
            *model = *known;
        }
    }
    let look = Look::new(&problem, &values, &noise).ok()?;
    Some(f(&problem, &look))
}

/// A variation in words, with its figures.
fn described(question: &Question, answer: &Answer, now: &[f64]) -> Suggestion {
    let mut effects: Vec<String> = Vec::new();
    let mut reasons = Vec::new();
    for (k, pair) in question.pairs.iter().enumerate() {
        if now[k] - answer.cosines[k] > NOTABLE {
            let [a, b] = pair;
            reasons.push(format!("the cosine of {a} and {b} falls from {:.2} to {:.2}", now[k], answer.cosines[k]));
            effects.extend(pair.iter().filter(|id| !effects.contains(id)).cloned().collect::<Vec<_>>());
        }
    }
    let hidden = reasons.len().saturating_sub(NAMED);
    reasons.truncate(NAMED);
    if hidden > 0 {
        reasons.push(format!("{hidden} more pairs come apart"));
    }
    let shown: Vec<&String> =
        question.blind.iter().zip(&answer.seen).filter(|(_, seen)| **seen).map(|(id, _)| id).collect();
    if !shown.is_empty() {
        let mut words = strengths(question, answer, &shown[..shown.len().min(NAMED)]);
        if shown.len() > NAMED {
            words.push(format!("{} more", shown.len() - NAMED));
        }
        reasons.push(format!("it would show {}", words.join(", ")));
        effects.extend(shown.into_iter().cloned());
    }
    Suggestion { text: format!("repeat with {}: {}", answer.variation.text, reasons.join("; ")), effects }
}

/// Effects with the smallest strength that the variation would find: `coulomb_friction from 0.03 N.m`.
fn strengths(question: &Question, answer: &Answer, ids: &[&String]) -> Vec<String> {
    let of = |problem: &Problem, look: &Look| {
        let values: Vec<f64> = problem.base.iter().map(|free| free.start).collect();
        map_in_order(ids, |id| weakest(problem, look, &values, id).unwrap_or_else(|| (*id).clone()))
    };
    with_look(question, &answer.variation, of).unwrap_or_else(|| ids.iter().map(|id| (*id).clone()).collect())
}

fn weakest(problem: &Problem, look: &Look, values: &[f64], id: &str) -> Option<String> {
    let candidate = problem.candidate(id)?;
    let k = look.ids().position(|known| known == id)?;
    let view = look.sensitivities.signatures[k].views.first()?;
    let (member, slope) = match view.members() {
        Some(members) => {
            let sized = members.iter().zip(look.projected.views[k].first()?);
            sized.map(|(member, column)| (*member, norm(column))).max_by(|a, b| a.1.total_cmp(&b.1))?
        }
        None if candidate.free.len() == 1 => (0, f64::NAN),
        None => return None,
    };
    let strength = smallest(problem, look, values, candidate, member, slope);
    let unit = match strength.variable.unit.symbol {
        "1" => "",
        symbol => symbol,
    };
    Some(format!("{id} from {:.2e} {unit}", (strength.value? - strength.neutral).abs()).trim_end().to_owned())
}
