//! From fits and p-values to the verdict.

use super::bootstrap::p_value;
use super::doubts::Doubt;
use super::result::Verdict;
use super::search::Search;
use super::stage::Stage;
use crate::diagnosis::linear_algebra::{dot, norm};
use crate::diagnosis::prediction::PredictionError;
use crate::diagnosis::thresholds::{ALIKE, MAY_BE_UNANSWERED, MAY_STAY, MISFIT, REACH, REACH_SHARE, TOO_MUCH};

/// A verdict and what it rests on.
#[derive(Clone, Debug)]
pub(crate) struct Judgement {
    pub verdict: Verdict,
    /// Effects that the verdict names, in full or in part; none where it is undetermined.
    pub effects: Vec<String>,
    /// Effects that remain possible where it is undetermined, the best first.
    pub tied: Vec<String>,
    /// An effect and a candidate that could stand in its place.
    pub rivals: Vec<(String, String)>,
    /// Effects one of which may act beside those that are named, the best first; another form of the named ones does as well.
    pub beside: Vec<String>,
    pub cautions: Vec<String>,
}

impl Judgement {
    fn plain(verdict: Verdict, cautions: Vec<String>) -> Self {
        Self { verdict, effects: Vec::new(), tied: Vec::new(), rivals: Vec::new(), beside: Vec::new(), cautions }
    }

    /// Whether it names effects with confidence.
    pub fn names(&self) -> bool {
        self.verdict == Verdict::EffectMissing
    }

    /// Nothing is decided; what would have been named stays possible.
    pub fn undecided(&mut self) {
        self.verdict = Verdict::Undetermined;
        self.tied.splice(0..0, self.effects.drain(..));
    }

    /// The same with the reason.
    pub fn open(&mut self, caution: String) {
        self.undecided();
        self.cautions.push(caution);
    }

    /// Rows that the calibrated baseline cannot answer count against the model: beyond a share of them it explains nothing
    /// in full.
    pub fn with_unanswered(&mut self, share: f64) {
        if share <= MAY_BE_UNANSWERED {
            return;
        }
        let words = format!("the model has no answer in {:.0} % of the rows, which counts against it", 100.0 * share);
        match self.verdict {
            Verdict::Explained => {
                self.verdict = Verdict::Unexplained;
                self.cautions.push(words);
            }
            Verdict::EffectMissing => self.open(words),
            Verdict::Unexplained | Verdict::Undetermined => self.cautions.push(words),
        }
    }

    /// Effects named or possible.
    pub fn involved(&self) -> Vec<String> {
        self.effects.iter().chain(&self.tied).cloned().collect()
    }
}

/// P-values of the baseline's misfit.
pub(crate) struct Misfit {
    /// In all.
    pub all: f64,
    /// In what repeats have in common.
    pub common: f64,
    /// Along the conditions.
    pub structure: f64,
}

/// Whether the baseline leaves more than noise, by three statistics.
pub(crate) fn misfit(stage: &Stage) -> Misfit {
    let (draws, observed) = (&stage.draws, &stage.observed);
    Misfit {
        all: p_value(draws, |draw| draw.chi_square, observed.chi_square),
        common: p_value(draws, |draw| draw.common, observed.common),
        structure: p_value(draws, |draw| draw.structure, observed.structure),
    }
}

/// Whether a p-value of so many draws says that noise alone does not do it. With few draws the smallest p that they can give
/// counts, so that the test can always fail.
pub(crate) fn is_misfit(p: f64, draws: usize) -> bool {
    p <= MISFIT.max(1.0 / (draws as f64 + 1.0))
}

/// Share of the baseline's explainable chi-square that a fitted set leaves, and whether what stays is more than noise.
pub(crate) fn left(search: &Search, stage: &Stage, effects: &[String], residual: &[f64]) -> (f64, bool) {
    let (before, _) = stage.structure(&stage.residual, &[]);
    let columns: Vec<&Vec<f64>> = effects.iter().flat_map(|id| stage.columns(id)).collect();
    let (after, p) = stage.structure(&stage.projected.base.outside(residual), &columns);
    // What an effect explains is explainable, even where the flexible curves are blind to it.
    let explainable = before.max(search.gain(effects)).max(f64::MIN_POSITIVE);
    ((after / explainable).clamp(0.0, 1.0), is_misfit(p, stage.draws.len()))
}

/// Rivals within reach of a fitted set: candidates that could stand in the place of one of its effects.
///
/// # Errors
/// [`PredictionError`] where the model has no answer at a fit.
pub(crate) fn rivals(
    search: &Search,
    stage: &Stage,
    effects: &[String],
    all: &[String],
) -> Result<Vec<(String, String)>, PredictionError> {
    let gain = search.net_gain(effects);
    let mut found = Vec::new();
    for own in effects {
        let part = gain - search.net_gain(&without(effects, own));
        let reach = REACH.max(REACH_SHARE * part);
        let of_alikes = search.problem.strategy().alikes(search.problem, own).map(|alikes| alikes.reach(part));
        for id in all.iter().filter(|id| !effects.contains(id)) {
            let in_place = swapped(effects, own, id);
            if search.fits.get(&in_place).is_none() {
                continue;
            }
            let behind = gain - search.net_gain(&in_place);
            let ties_as_alike = match of_alikes.filter(|of_alikes| behind > reach && behind <= *of_alikes) {
                Some(_) => are_alike(search, stage, effects, own, id)?,
                None => false,
            };
            if behind <= reach || ties_as_alike {
                found.push((own.clone(), id.clone()));
            }
        }
    }
    Ok(found)
}

/// Whether an effect of a fitted set and one in its place change much the same: by their signatures about the baseline, or where they
/// stand at their own fits. The baseline bends its soil to stand in for what it lacks, so that signatures there may differ more.
///
/// # Errors
/// [`PredictionError`] where the model has no answer at a fit.
pub(crate) fn are_alike(
    search: &Search,
    stage: &Stage,
    set: &[String],
    own: &str,
    other: &str,
) -> Result<bool, PredictionError> {
    if stage.cosine(own, other) > ALIKE {
        return Ok(true);
    }
    let residual = |effects: &[String]| match search.fits.get(effects) {
        Some(fit) => search.whitened_residual(effects, &fit.values()).map(Some),
        None => Ok(None),
    };
    let rest = without(set, own);
    let (Some(rest), Some(own), Some(other)) = (residual(&rest)?, residual(set)?, residual(&swapped(set, own, other))?)
    else {
        return Ok(false);
    };
    let change = |fitted: &[f64]| -> Vec<f64> { fitted.iter().zip(&rest).map(|(a, b)| a - b).collect() };
    let (own, other) = (change(&own), change(&other));
    Ok(dot(&own, &other) > ALIKE * norm(&own) * norm(&other))
}

/// A set without one of its effects.
fn without(effects: &[String], own: &str) -> Vec<String> {
    effects.iter().filter(|id| *id != own).cloned().collect()
}

/// What the verdict needs to know of the final set.
pub(crate) struct Case<'a> {
    pub effects: &'a [String],
    /// Share of the explainable chi-square that stays, and whether that is more than noise.
    pub left: (f64, bool),
    /// Whether the set gains more than noise alone gives the best of all candidates.
    pub more_than_noise_alone: bool,
    /// Effects of the set with a look-alike that the fits do not tell from them, or a rival that fits about as well.
    pub imitating: Vec<String>,
    pub rivals: Vec<(String, String)>,
    /// Whether left-out data were predicted, and whether better than by the baseline.
    pub predicted: bool,
    pub confirmed: bool,
    /// Whether the naming holds with the priors all but removed; `None` without priors.
    pub without_priors: Option<bool>,
    /// Why the probabilities do not allow the name, where they do not.
    pub improbable: Option<String>,
    pub doubts: &'a [Doubt],
}

/// The verdict where effects gain more than noise alone.
pub(crate) fn with_effects(case: &Case) -> Judgement {
    let (left, more_than_noise) = case.left;
    if more_than_noise && left > MAY_STAY {
        let cautions = case.doubts.iter().map(Doubt::words).collect();
        return Judgement { effects: partial(case), ..Judgement::plain(Verdict::Unexplained, cautions) };
    }
    let cautions = against(case);
    let rivals = case.rivals.clone();
    if cautions.is_empty() && rivals.is_empty() {
        let effects = case.effects.to_vec();
        return Judgement { effects, ..Judgement::plain(Verdict::EffectMissing, cautions) };
    }
    let mut tied = case.effects.to_vec();
    for (_, rival) in &rivals {
        if !tied.contains(rival) {
            tied.push(rival.clone());
        }
    }
    Judgement { tied, rivals, ..Judgement::plain(Verdict::Undetermined, cautions) }
}

/// The effects of a set that are worth listing although much is left: over half of what could be explained is gone with
/// them, and none of them only imitates something else. The effect that gains most stands first in a set; one behind an
/// imitation fits what the imitation leaves, and is not known either.
fn partial(case: &Case) -> Vec<String> {
    let imitates = |id: &String| case.imitating.contains(id) || case.doubts.iter().any(|doubt| doubt.is_against(id));
    if case.left.0 > TOO_MUCH || !case.confirmed {
        return Vec::new();
    }
    case.effects.iter().take_while(|id| !imitates(id)).cloned().collect()
}

/// Reasons against naming a set that leaves little, or nothing but noise.
fn against(case: &Case) -> Vec<String> {
    let mut cautions: Vec<String> = case.doubts.iter().map(Doubt::words).collect();
    if case.left.0 > TOO_MUCH {
        cautions.push(format!(
            "{} accounts for {:.0} % only of what could be explained; the rest may be noise, but it is too much to name anything",
            case.effects.join(" with "),
            100.0 * (1.0 - case.left.0)
        ));
    }
    if !case.more_than_noise_alone {
        cautions
            .push(format!("{} gains no more than the best candidate may by noise alone", case.effects.join(" with ")));
    }
    if case.without_priors == Some(false) {
        cautions.push(
            "without the priors the effect is not needed: a prior may be wrong, which looks like a missing effect"
                .to_owned(),
        );
    }
    if !case.confirmed {
        let why = if case.predicted {
            "left-out conditions do not confirm the effect: it fits, but does not predict better"
        } else {
            "left-out conditions were not predicted, so that nothing confirms the effect"
        };
        cautions.push(why.to_owned());
    }
    cautions.extend(case.improbable.clone());
    cautions
}

/// The verdict where no effect gains more than noise alone; `blind` is the share of visible effects that could be there
/// at full physical strength without showing.
pub(crate) fn without_effects(stage: &Stage, blind: f64) -> Judgement {
    let Misfit { all, common, structure } = misfit(stage);
    let mut cautions = Vec::new();
    let draws = stage.draws.len();
    let verdict = if [all, common, structure].into_iter().any(|p| is_misfit(p, draws)) {
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
    Judgement::plain(verdict, cautions)
}

/// Whether an effect of a set has a look-alike that the fits do not tell from it.
pub(crate) fn is_imitation(search: &Search, stage: &Stage, set: &[String], own: &str) -> bool {
    stage.sensitivities.signatures.iter().any(|signature| {
        !set.contains(&signature.id)
            && stage.cosine(own, &signature.id) > ALIKE
            && !told_apart(search, set, own, &signature.id)
    })
}

/// Pairs that look alike here and of which one is named or tied, less those that the data tell apart.
pub(crate) fn confused(search: &Search, stage: &Stage, judgement: &Judgement, chosen: &[String]) -> Vec<[String; 2]> {
    let mut pairs: Vec<[String; 2]> = Vec::new();
    for own in &judgement.involved() {
        // The set in which `own` plays its part: the chosen one, or that with it in its rival's place.
        let part_of = |(found, rival): &(String, String)| (rival == own).then(|| swapped(chosen, found, own));
        let set = judgement.rivals.iter().find_map(part_of).unwrap_or_else(|| chosen.to_vec());
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

/// A set with one effect in the place of another.
pub(crate) fn swapped(effects: &[String], out: &str, into: &str) -> Vec<String> {
    effects.iter().map(|id| if id == out { into } else { id.as_str() }.to_owned()).collect()
}

/// Whether the fits tell two effects apart although their signatures are alike: in the place of `own`, `other` gains less
/// than the share that the cosine `ALIKE` stands for. A cosine accounts neither for signs and bounds nor for the nonlinearity of
/// large effects.
fn told_apart(search: &Search, set: &[String], own: &str, other: &str) -> bool {
    let in_place = swapped(set, own, other);
    if set.iter().any(|id| id == other) || search.fits.get(&in_place).is_none() {
        return false;
    }
    let rest = search.net_gain(&without(set, own));
    search.net_gain(&in_place) - rest < ALIKE * ALIKE * (search.net_gain(set) - rest)
}

#[cfg(test)]
mod tests {
    use super::{Case, with_effects};

    #[test]
    fn property_what_is_found_beside_an_imitation_is_not_listed_in_part() {
        let effects = ["slip_sinkage", "grousers", "drag"].map(str::to_owned);
        let listed = |imitating: &[&str]| {
            let case = Case {
                effects: &effects,
                left: (0.3, true),
                more_than_noise_alone: true,
                imitating: imitating.iter().map(|id| (*id).to_owned()).collect(),
                rivals: Vec::new(),
                predicted: true,
                confirmed: true,
                without_priors: None,
                improbable: None,
                doubts: &[],
            };
            with_effects(&case).effects
        };
        assert_eq!(listed(&[]), effects);
        assert_eq!(listed(&["drag"]), effects[..2]);
        assert_eq!(listed(&["grousers"]), effects[..1]);
        assert!(listed(&["slip_sinkage"]).is_empty());
    }
}
