//! What a variation of the experiment at hand would see of the effects in question, by simulation and sensitivities.

use super::look::Look;
use super::separation::{expect_all, models, planned_noise};
use super::strength::smallest;
use super::suggest::Question;
use super::variation::Variation;
use crate::diagnosis::diagnose::Untried;
use crate::diagnosis::linear_algebra::norm;
use crate::diagnosis::problem::Problem;
use crate::diagnosis::thresholds::{ALIKE, DETECTABLE};
use crate::parallel::map_in_order;
use bekker_modeldescription::Role;

/// What simulating a variation costs, in single fits.
const SIMULATION: f64 = 0.3;

/// A variation and what it would see.
pub(super) struct Answer {
    pub variation: Variation,
    /// Cosines of the pairs; 1 where one of the two is not seen.
    pub cosines: Vec<f64>,
    /// Whether each of the question's blind effects would be found at full strength.
    pub seen: Vec<bool>,
    /// Size of each named effect beyond the calibration, in standard deviations of the noise.
    pub sizes: Vec<f64>,
}

impl Answer {
    pub fn solved(&self) -> usize {
        self.cosines.iter().filter(|cosine| **cosine < ALIKE).count()
    }

    pub fn shows(&self) -> usize {
        self.seen.iter().filter(|seen| **seen).count()
    }
}

/// The same of the experiment at hand: cosines of the pairs, sizes of the named effects.
pub(super) struct Now {
    pub cosines: Vec<f64>,
    pub sizes: Vec<f64>,
}

impl Now {
    pub fn of(question: &Question) -> Self {
        match Look::new(question.problem, question.values, question.noise) {
            Ok(look) => Self {
                cosines: question.pairs.iter().map(|[a, b]| look.cosine(a, b)).collect(),
                sizes: question.named.iter().map(|id| look.size(id)).collect(),
            },
            Err(_) => Self { cosines: vec![1.0; question.pairs.len()], sizes: vec![0.0; question.named.len()] },
        }
    }
}

/// All variations that the model can compute, as far as there is time.
pub(super) fn answers(question: &Question) -> Vec<Answer> {
    if question.pairs.is_empty() && question.blind.is_empty() && question.named.is_empty() {
        return Vec::new();
    }
    let model = question.problem.improved(&question.problem.base, question.values);
    let strategy = question.problem.strategy();
    let variations = strategy.variations(&model, &question.problem.experiment, question.problem.halt);
    let ask = |variation: &Variation| {
        with_look(question, variation, |_, look| {
            let seen = |id: &String| look.size(id) >= DETECTABLE;
            let cosine = |[a, b]: &[String; 2]| if seen(a) && seen(b) { look.cosine(a, b) } else { 1.0 };
            Answer {
                variation: variation.clone(),
                cosines: question.pairs.iter().map(cosine).collect(),
                seen: question.blind.iter().map(seen).collect(),
                sizes: question.named.iter().map(|id| look.size(id)).collect(),
            }
        })
    };
    let words = |variation: &Variation| variation.text.clone();
    let untried = |variation: &Variation| Untried::Variation(variation.text.clone());
    question.watch.pieces(&variations, SIMULATION, words, untried, ask).into_iter().flatten().collect()
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
    problem.halt = question.problem.halt;
    problem.step_as(question.problem);
    let asked = |id: &String| {
        question.blind.contains(id)
            || question.named.contains(id)
            || question.pairs.iter().any(|pair| pair.contains(id))
    };
    problem.library.retain(|candidate| asked(&candidate.id));
    expect_all(&mut problem);
    let values: Vec<f64> = problem.base.iter().map(|free| free.start).collect();
    let modelled = problem.predict(&problem.base, |predict| predict.values(&values)).ok()?.ok()?;
    let mut noise = models(&planned_noise(&problem, &modelled));
    problem.layout.scale = problem.strategy().noise_scale(&problem, &modelled);
    for (signal, model) in &mut noise {
        if let Some(known) = question.noise.get(signal) {
            *model = *known;
        }
    }
    let look = Look::new(&problem, &values, &noise).ok()?;
    Some(f(&problem, &look))
}

/// Effects with the smallest strength that the variation would find: `coulomb_friction from 0.03 N.m`.
pub(super) fn strengths(question: &Question, answer: &Answer, ids: &[&String]) -> Vec<String> {
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
    Some(format!("{id} from {} {unit}", rounded((strength.value? - strength.neutral).abs())).trim_end().to_owned())
}

/// A number as people write it: two significant digits, a power of ten only where it saves zeros.
pub(crate) fn rounded(value: f64) -> String {
    let handy = super::plan::handy(value);
    if handy != 0.0 && !(1e-3..1e6).contains(&handy.abs()) { format!("{value:.1e}") } else { handy.to_string() }
}
