//! From fits and p-values to the verdict.

use super::bootstrap::p_value;
use super::held_out::HeldOut;
use super::probability::better;
use super::result::Verdict;
use super::search::Search;
use super::stage::Stage;

/// An effect is named below this p-value, corrected for the number of candidates.
pub(crate) const NAMED: f64 = 0.01;
/// The baseline misses something below this p-value; two tests share the risk of a false alarm.
const MISFIT: f64 = 0.005;
/// Probability from which an effect predicts better than the baseline.
const BETTER: f64 = 0.95;
/// Share of the explainable chi-square that may stay, and from which nothing is named.
pub(crate) const MAY_STAY: f64 = 0.2;
pub(crate) const TOO_MUCH: f64 = 0.5;
/// A rival ties within this fall of chi-square (a likelihood ratio of 20), or within this share of the gain, which form
/// errors of the effects' laws reach.
pub(crate) const REACH: f64 = 6.0;
const REACH_SHARE: f64 = 0.02;
/// Cosine of signatures from which two effects can stand for each other.
pub(crate) const ALIKE: f64 = 0.8;

/// What was found.
#[derive(Clone, Debug)]
pub(crate) struct Finding {
    pub verdict: Verdict,
    pub effects: Vec<String>,
    /// An effect and a candidate that could stand in its place.
    pub ties: Vec<(String, String)>,
    pub cautions: Vec<String>,
}

impl Finding {
    /// Whether an effect could stand in another's place, or another in its.
    pub fn is_tied(&self, id: &str) -> bool {
        self.ties.iter().any(|(own, rival)| own == id || rival == id)
    }

    /// Effects found, and those that tie with them.
    pub fn involved(&self) -> Vec<String> {
        let mut all = self.effects.clone();
        for (_, rival) in &self.ties {
            if !all.contains(rival) {
                all.push(rival.clone());
            }
        }
        all
    }

    /// What the verdict lists: the effects found and, where it is undetermined, those that tie with them.
    pub fn listed(&self) -> Vec<String> {
        if self.verdict == Verdict::Undetermined { self.involved() } else { self.effects.clone() }
    }
}

/// P-values of the baseline's misfit: in all, and along the conditions.
pub(crate) fn misfit(stage: &Stage) -> (f64, f64) {
    let all = p_value(&stage.draws, |draw| draw.chi_square, stage.observed.chi_square);
    (all, p_value(&stage.draws, |draw| draw.structure, stage.observed.structure))
}

/// Share of the baseline's explainable chi-square that a fitted set leaves, and whether what stays is more than noise.
pub(crate) fn left(search: &Search, stage: &Stage, effects: &[String], residual: &[f64]) -> (f64, bool) {
    let (before, _) = stage.structure(&stage.residual, &[]);
    let columns: Vec<&Vec<f64>> = effects.iter().flat_map(|id| stage.columns(id)).collect();
    let (after, p) = stage.structure(&stage.projected.base.outside(residual), &columns);
    // What an effect explains is explainable, even where the flexible curves are blind to it.
    let explainable = before.max(search.gain(effects)).max(f64::MIN_POSITIVE);
    ((after / explainable).clamp(0.0, 1.0), p < MISFIT)
}

/// Rivals within reach of a fitted set: candidates that could stand in the place of one of its effects.
pub(crate) fn rivals(search: &Search, effects: &[String], all: &[String]) -> Vec<(String, String)> {
    let gain = search.net_gain(effects);
    let mut found = Vec::new();
    for own in effects {
        let without: Vec<String> = effects.iter().filter(|id| *id != own).cloned().collect();
        let part = gain - search.net_gain(&without);
        let reach = REACH.max(REACH_SHARE * part);
        for id in all.iter().filter(|id| !effects.contains(id)) {
            let mut swapped = without.clone();
            swapped.push(id.clone());
            if search.fits.get(&swapped).is_some() && search.net_gain(&swapped) >= gain - reach {
                found.push((own.clone(), id.clone()));
            }
        }
    }
    found
}

/// What the verdict needs to know of the final set.
pub(crate) struct Case<'a> {
    pub effects: &'a [String],
    pub left: (f64, bool),
    pub rivals: Vec<(String, String)>,
    pub baseline: Option<&'a HeldOut>,
    pub held_out: Option<&'a HeldOut>,
    /// Whether the naming holds with the priors all but removed; `None` without priors.
    pub without_priors: Option<bool>,
}

/// The verdict where at least one effect gains more than noise alone.
pub(crate) fn with_effects(case: &Case) -> Finding {
    let mut cautions = Vec::new();
    let ties = case.rivals.clone();
    let confirmed = match (case.held_out, case.baseline) {
        (Some(ours), Some(baseline)) => better(&ours.density, &baseline.density) > BETTER,
        _ => false,
    };
    let (left, more_than_noise) = case.left;
    let effects = case.effects.to_vec();
    let verdict = if more_than_noise && left > TOO_MUCH {
        return Finding { verdict: Verdict::Unexplained, effects: Vec::new(), ties: Vec::new(), cautions };
    } else if more_than_noise && left > MAY_STAY {
        Verdict::Unexplained
    } else if case.without_priors == Some(false) {
        cautions.push(
            "without the priors the effect is not needed: a prior may be wrong, which looks like a missing effect"
                .to_owned(),
        );
        Verdict::Undetermined
    } else if !confirmed {
        let predicted = case.held_out.is_some() && case.baseline.is_some();
        let why = if predicted {
            "left-out conditions do not confirm the effect: it fits, but does not predict better"
        } else {
            "left-out conditions were not predicted, so that nothing confirms the effect"
        };
        cautions.push(why.to_owned());
        Verdict::Undetermined
    } else if !ties.is_empty() {
        Verdict::Undetermined
    } else {
        Verdict::EffectMissing
    };
    Finding { verdict, effects, ties, cautions }
}

/// The verdict where no effect gains more than noise alone; `blind` is the share of visible effects that could be there
/// at full physical strength without showing.
pub(crate) fn without_effects(stage: &Stage, blind: f64) -> Finding {
    let (all, structure) = misfit(stage);
    let mut cautions = Vec::new();
    let verdict = if all < MISFIT || structure < MISFIT {
        Verdict::Unexplained
    } else if blind > TOO_MUCH {
        cautions.push(format!(
            "this experiment cannot tell: {:.0} % of the effects that it could show may be there at full physical strength without showing",
            100.0 * blind
        ));
        Verdict::Undetermined
    } else {
        Verdict::Explained
    };
    Finding { verdict, effects: Vec::new(), ties: Vec::new(), cautions }
}

/// Pairs that look alike here and of which one is named or tied, less those that the data tell apart.
pub(crate) fn confused(search: &Search, stage: &Stage, finding: &Finding) -> Vec<[String; 2]> {
    let mut pairs: Vec<[String; 2]> = Vec::new();
    for own in &finding.involved() {
        // The set in which `own` plays its part: the effects found, or those with it in its rival's place.
        let part_of = |(found, rival): &(String, String)| (rival == own).then(|| swapped(&finding.effects, found, own));
        let set = finding.ties.iter().find_map(part_of).unwrap_or_else(|| finding.effects.clone());
        for signature in &stage.sensitivities.signatures {
            let known = |pair: &[String; 2]| pair.contains(own) && pair.contains(&signature.id);
            if signature.id != *own
                && stage.cosine(own, &signature.id) > ALIKE
                && !told_apart(search, &set, own, &signature.id)
                && !pairs.iter().any(known)
            {
                pairs.push([own.clone(), signature.id.clone()]);
            }
        }
    }
    pairs
}

fn swapped(effects: &[String], out: &str, into: &str) -> Vec<String> {
    effects.iter().map(|id| if id == out { into } else { id.as_str() }.to_owned()).collect()
}

/// Whether the fits tell two effects apart although their signatures are alike: in the place of `own`, `other` gains less
/// than the share that the cosine `ALIKE` stands for. A cosine knows neither of signs and bounds nor of large effects.
fn told_apart(search: &Search, set: &[String], own: &str, other: &str) -> bool {
    let in_place = swapped(set, own, other);
    if set.iter().any(|id| id == other) || search.fits.get(&in_place).is_none() {
        return false;
    }
    let without: Vec<String> = set.iter().filter(|id| *id != own).cloned().collect();
    let rest = search.net_gain(&without);
    search.net_gain(&in_place) - rest < ALIKE * ALIKE * (search.net_gain(set) - rest)
}
