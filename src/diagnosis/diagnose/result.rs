//! What a diagnosis finds. All figures are in SI units; arrays are by run and signal as in [`Fit`].
//!
//! The JSON of a diagnosis follows from these types; `result.schema.json` beside them says its form, and a test holds one
//! against the other. Keys may be added, none changes its meaning.

use super::drive::WholeDrive;
use super::serialised::{by_name, deviations, name_of, plain};
use crate::diagnosis::calibrate::{CalibratedParameter, Calibration};
use crate::diagnosis::curves::Curves;
use crate::diagnosis::fit::Fit;
use crate::diagnosis::noise::{FloorSource, NoiseModel};
use crate::diagnosis::problem::plain_effect;
use crate::diagnosis::separate::Suggestion;
use crate::diagnosis::{Failure, NoiseFloor, UnansweredRows, UncountedRows, Workbench};
use crate::measurement::Experiment;
use crate::model::Model;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// The answer.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// The calibrated model without any added effect already leaves only noise.
    Explained,
    /// The listed effects account for the structure.
    EffectMissing,
    /// There is structure that no candidate accounts for; the listed effects are none or partial.
    Unexplained,
    /// Two or more candidates tie, or the experiment cannot see the difference, or something known contradicts it.
    Undetermined,
}

impl Verdict {
    /// The word for reports and JSON.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Explained => "explained",
            Self::EffectMissing => "effect_missing",
            Self::Unexplained => "unexplained",
            Self::Undetermined => "undetermined",
        }
    }
}

/// A parameter of a fit; bounds, unit and prior are in `fitted`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ParameterResult {
    /// Value, standard error, bounds, whether on a bound, prior.
    #[serde(flatten)]
    pub fitted: CalibratedParameter,
    /// Whether it belongs to an added effect rather than to the calibration.
    pub effect: bool,
}

/// A parameter of the final model with its profile likelihood.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FinalParameter {
    /// Name of the parameter.
    #[serde(rename = "parameter")]
    pub name: String,
    /// 95 % interval of the profile likelihood; `None` where a side is open within the bounds.
    pub interval: (Option<f64>, Option<f64>),
    /// Values at which the profile was taken, and the rise of chi-square over the minimum, all others refitted.
    pub profile: Vec<(f64, f64)>,
}

/// One step from the calibrated baseline to the final model.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Step {
    /// The effect added at this step; `None` for the baseline.
    pub added: Option<String>,
    /// RMS of measured minus modelled by signal, in the signal's unit.
    pub rmse: BTreeMap<String, f64>,
    /// The same on conditions or runs that were left out of the fit.
    pub heldout_rmse: BTreeMap<String, f64>,
    /// Free parameters and their values.
    #[serde(serialize_with = "by_name")]
    pub parameters: Vec<ParameterResult>,
    /// Sum of the squared whitened residuals, and its degrees of freedom.
    pub chi_square: f64,
    /// Measured values and priors less free parameters.
    pub degrees_of_freedom: usize,
    /// Share of the baseline's explainable chi-square that is left, 1 at the baseline.
    pub left: f64,
    /// Measured, modelled, residual.
    #[serde(skip)]
    pub fit: Fit,
}

/// One candidate effect, added to the baseline alone (or beside the effects named before it).
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct CandidateResult {
    /// Effect id.
    pub effect: String,
    /// Probability that the effect is part of the explanation; not a number where some were not tried.
    pub probability: f64,
    /// Whether it remains possible where the verdict is undetermined.
    pub tied: bool,
    /// Gain in log predictive density on left-out data over the baseline, nats; `None` where only screened.
    pub heldout_gain: Option<f64>,
    /// Probability, by a bootstrap over left-out conditions, that it predicts better than the baseline; `None` where only
    /// screened.
    pub better: Option<f64>,
    /// Probability that noise alone gives the best of all candidates as large a gain.
    pub p_value: f64,
    /// Fall of chi-square after refitting everything; from the sensitivities where only screened.
    pub gain: f64,
    /// Share of the baseline's explainable chi-square that is left with it.
    pub left: f64,
    /// Whether it was refitted, or only screened by its sensitivities.
    pub refitted: bool,
    /// The part of its signature that the calibrated parameters cannot absorb, 0 to 1.
    pub visible_share: f64,
    /// The parameters of the effect after the fit; empty where only screened.
    #[serde(serialize_with = "by_name")]
    pub parameters: Vec<ParameterResult>,
}

/// A fit of the baseline with some effects.
#[derive(Clone, Debug, PartialEq)]
pub struct TriedFit {
    /// Effect ids.
    pub effects: Vec<String>,
    /// All parameters that were fitted.
    pub calibration: Calibration,
}

/// Two effects added to the baseline at once.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PairResult {
    /// The two ids.
    pub effects: [String; 2],
    /// Fall of chi-square against the baseline.
    pub gain: f64,
    /// Whether it was refitted, or only screened.
    pub refitted: bool,
}

/// Whether what the baseline leaves is more than noise.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct LackOfFit {
    /// Sum of squared whitened residuals of the calibrated baseline.
    pub chi_square: f64,
    /// Its degrees of freedom.
    pub degrees_of_freedom: usize,
    /// Probability of as large a chi-square by noise alone, the noise model being uncertain too.
    pub p_value: f64,
    /// Probability of as large a part that repeats have in common by noise alone: the model's error is all in that part, the
    /// noise only with a share.
    pub p_common: f64,
    /// The part along the conditions (slip, load, speed, position, time ...), less what noise puts there.
    pub explainable: f64,
    /// Probability of as large a part along the conditions by noise alone.
    pub p_structure: f64,
}

/// Probabilities of the two answers that are no effect; not numbers where some effects were not tried.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Share {
    /// The baseline is enough.
    #[serde(rename = "probability_enough")]
    pub enough: f64,
    /// Something else than any candidate.
    #[serde(rename = "probability_other")]
    pub other: f64,
}

/// All that a diagnosis finds.
#[derive(Clone, Debug, Serialize)]
pub struct Diagnosis {
    /// The experiment.
    #[serde(serialize_with = "name_of")]
    pub experiment: Experiment,
    /// The answer.
    pub verdict: Verdict,
    /// Effects that account for the structure, or a part of it where unexplained; none where undetermined: all that remain
    /// possible there stand in `candidates` with `tied`. Where several experiments were diagnosed together, an effect that acts in some of
    /// them only has their names behind its own (`slip_sinkage in wheel_2`); in JSON the ids are plain.
    #[serde(serialize_with = "plain")]
    pub effects: Vec<String>,
    /// Where several experiments were diagnosed together: for each effect that is named or tied the experiments in which it acts. In JSON
    /// those that are named, by their plain ids, as `where`.
    #[serde(skip)]
    pub places: BTreeMap<String, Vec<String>>,
    /// Effects one of which may act beside those that are named, the best first: what the named ones leave is more than noise, and one of
    /// these, or another form of a named effect's law, accounts for it. Empty unless effects are named with confidence, and where there was no
    /// time to look. Names have the experiments behind them as `effects` has, in JSON too.
    pub possible_beside: Vec<String>,
    /// Noise floor of each signal: standard deviation of one sample.
    #[serde(serialize_with = "deviations")]
    pub noise_floor: BTreeMap<String, NoiseFloor>,
    /// Where the noise floor comes from.
    pub noise_floor_source: FloorSource,
    /// The noise models used for whitening.
    #[serde(rename = "noise_models")]
    pub noise: BTreeMap<String, NoiseModel>,
    /// The model before calibration, where it can compute the experiment.
    #[serde(skip)]
    pub given: Option<Fit>,
    /// The baseline and each effect added.
    pub steps: Vec<Step>,
    /// The model of each step as curves over the inputs that were varied; none for a traverse.
    pub curves: Vec<Curves>,
    /// Single candidates, the most probable first.
    pub candidates: Vec<CandidateResult>,
    /// Pairs of candidates, the best first.
    pub pairs: Vec<PairResult>,
    /// Candidates without any signature in this experiment.
    pub invisible: Vec<String>,
    /// "Enough" and "something else".
    #[serde(flatten)]
    pub share: Share,
    /// Lack of fit of the calibrated baseline.
    pub lack_of_fit: LackOfFit,
    /// Smallest p-value that the bootstrap can give.
    pub smallest_p: f64,
    /// Share of the explainable chi-square that the final model accounts for.
    pub explained_share: f64,
    /// Pairs of effects that this experiment hardly tells apart: one of them named or tied, cosine of signatures over 0.8.
    pub confused_with: Vec<[String; 2]>,
    /// Profile likelihood of the final model's parameters; empty if interrupted before.
    pub profiles: Vec<FinalParameter>,
    /// Where the baseline fails most, by signal and condition, the worst first.
    #[serde(skip)]
    pub failures: Vec<Failure>,
    /// The same of the final model.
    #[serde(skip)]
    pub failures_left: Vec<Failure>,
    /// What to measure next, the most useful first.
    pub suggestions: Vec<Suggestion>,
    /// Rows that are left out of everything, since the calibrated baseline has no answer there.
    pub unanswered: Vec<UnansweredRows>,
    /// All rows that no fit counts, and why: starts of runs, what follows a gap, odd stretches, and rows without an answer.
    pub uncounted: Vec<UncountedRows>,
    /// The final model over the whole of each run, where runs were cut into windows.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub whole_drive: Option<WholeDrive>,
    /// What the reader should beware of, in words.
    pub cautions: Vec<String>,
    /// The final model: calibrated, effects switched on; what the experiment says of single runs is not part of it, nor are
    /// errors of its sensors.
    /// It states all its values: compared with the same experiment it gives the same errors, those of the whole drive where runs
    /// were cut into windows. A wheel on a carriage where a
    /// single wheel was measured and no rover is named.
    #[serde(skip)]
    pub improved: Model,
    /// Of several experiments the same for each, by its name; empty for one experiment.
    #[serde(skip)]
    pub improved_parts: Vec<(String, Model)>,
    /// The experiment with the calibrated baseline, on which other models can be tried.
    #[serde(skip)]
    pub workbench: Workbench,
    /// The fits of the effects that were tried: each alone, and those of the steps.
    #[serde(skip)]
    pub tried: Vec<TriedFit>,
    /// What was taken from where, in words, where two places disagree; priors of a class of soil; what drives the rover where no
    /// command was recorded.
    pub sources: Vec<String>,
    /// Whether the work was cut short; what was not done is missing from the lists.
    pub interrupted: bool,
    /// What was not tried, because the work was cut short or a budget had no time for it: one line a kind of work, for
    /// example `fits of drag, tether, payload, rate and 3 more`. Empty where everything was tried.
    pub not_tried: Vec<String>,
}

impl Diagnosis {
    /// What to measure next, in one line.
    #[must_use]
    pub fn next_experiment(&self) -> String {
        self.suggestions.first().map_or_else(String::new, |suggestion| suggestion.text.clone())
    }

    /// Effects that remain possible where the verdict is undetermined, those of the best fit first.
    #[must_use]
    pub fn tied(&self) -> Vec<&str> {
        let added: Vec<&str> = self.steps.iter().filter_map(|step| step.added.as_deref()).collect();
        let mut tied: Vec<&str> = self.candidates.iter().filter(|c| c.tied).map(|c| c.effect.as_str()).collect();
        tied.sort_by_key(|id| added.iter().position(|known| known == id).unwrap_or(added.len()));
        tied
    }

    /// Effects that the verdict is about: those that it names, or those that remain possible.
    #[must_use]
    pub fn involved(&self) -> Vec<String> {
        if self.effects.is_empty() {
            self.tied().into_iter().map(str::to_owned).collect()
        } else {
            self.effects.clone()
        }
    }

    /// The same in words, with where they act if several experiments were diagnosed together.
    #[must_use]
    pub fn involved_in_words(&self) -> Vec<String> {
        let words = |id: String| match self.places.get(&id) {
            Some(places) if plain_effect(&id) == id => format!("{id} in {}", places.join(" and ")),
            _ => id,
        };
        self.involved().into_iter().map(words).collect()
    }

    /// Where the named effects act, by their plain ids; one that acts in one experiment and, with another strength, in more, acts in all of
    /// them. Empty for one experiment.
    #[must_use]
    pub fn named_places(&self) -> BTreeMap<&str, Vec<&str>> {
        let mut all: BTreeMap<&str, Vec<&str>> = BTreeMap::new();
        for (id, parts) in self.effects.iter().filter_map(|id| Some((id, self.places.get(id)?))) {
            let own = all.entry(plain_effect(id)).or_default();
            for part in parts {
                if !own.contains(&part.as_str()) {
                    own.push(part);
                }
            }
        }
        all
    }

    /// Which model [`improved`](Self::improved) is, in words.
    #[must_use]
    pub fn improved_is(&self) -> String {
        let added: Vec<&str> = self.steps.iter().filter_map(|step| step.added.as_deref()).collect();
        match (self.verdict, added.is_empty()) {
            (_, true) => "the calibrated baseline, without any added effect".to_owned(),
            (Verdict::EffectMissing, _) => format!("the calibrated model with {}", added.join(" and ")),
            (Verdict::Undetermined, _) => {
                format!(
                    "the best fit, with {}, which is not decided: {} tie",
                    added.join(" and "),
                    self.tied().join(", ")
                )
            }
            _ => format!("the best fit, with {}, which explains a part only", added.join(" and ")),
        }
    }

    /// The calibrated baseline.
    #[must_use]
    pub fn baseline(&self) -> &Step {
        &self.steps[0]
    }

    /// The last step.
    #[must_use]
    pub fn last(&self) -> &Step {
        &self.steps[self.steps.len() - 1]
    }
}
