//! The JSON of a diagnosis: a stable interface. Keys may be added, none changes its meaning.

use super::diagnose::{CandidateResult, Diagnosis, ParameterResult, Step};
use serde_json::{Map, Value, json};
use std::collections::BTreeMap;

impl Diagnosis {
    /// The diagnosis as JSON. Numbers that are not finite are null.
    #[must_use]
    pub fn to_json(&self) -> Value {
        let floors: Map<String, Value> =
            self.noise_floor.iter().map(|(signal, floor)| (signal.clone(), json!(floor.value()))).collect();
        json!({
            "experiment": self.experiment.name,
            "verdict": self.verdict.name(),
            "effects": self.effects,
            "noise_floor": floors,
            "noise_floor_source": self.noise_floor_source.name(),
            "noise_models": self.noise,
            "steps": self.steps.iter().map(step).collect::<Vec<_>>(),
            "curves": self.curves,
            "candidates": self.candidates.iter().map(candidate).collect::<Vec<_>>(),
            "probability_enough": number(self.share.enough),
            "probability_other": number(self.share.other),
            "pairs": self.pairs.iter().map(|pair| json!({
                "effects": pair.effects, "gain": number(pair.gain), "refitted": pair.refitted,
            })).collect::<Vec<_>>(),
            "invisible": self.invisible,
            "lack_of_fit": {
                "chi_square": number(self.lack_of_fit.chi_square),
                "degrees_of_freedom": self.lack_of_fit.degrees_of_freedom,
                "p_value": number(self.lack_of_fit.p_value),
                "p_common": number(self.lack_of_fit.p_common),
                "explainable": number(self.lack_of_fit.explainable),
                "p_structure": number(self.lack_of_fit.p_structure),
            },
            "smallest_p": number(self.smallest_p),
            "explained_share": number(self.explained_share),
            "confused_with": self.confused_with,
            "profiles": self.profiles.iter().map(|profile| json!({
                "parameter": profile.name,
                "interval": [profile.interval.0.map(number), profile.interval.1.map(number)],
                "profile": profile.profile.iter().map(|(value, rise)| [number(*value), number(*rise)]).collect::<Vec<_>>(),
            })).collect::<Vec<_>>(),
            "next_experiment": self.next_experiment(),
            "suggestions": self.suggestions.iter().map(|suggestion| json!({
                "text": suggestion.text, "effects": suggestion.effects,
            })).collect::<Vec<_>>(),
            "improved_is": self.improved_is(),
            "unanswered": self.unanswered.iter().map(|rows| json!({
                "run": rows.run, "first_row": rows.rows.0, "last_row": rows.rows.1, "reason": rows.reason,
            })).collect::<Vec<_>>(),
            "cautions": self.cautions,
            "interrupted": self.interrupted,
            "not_tried": self.not_tried,
        })
    }
}

fn number(x: f64) -> Value {
    if x.is_finite() { json!(x) } else { Value::Null }
}

fn numbers(values: &BTreeMap<String, f64>) -> Value {
    values.iter().map(|(name, value)| (name.clone(), number(*value))).collect::<Map<_, _>>().into()
}

fn step(step: &Step) -> Value {
    json!({
        "added": step.added,
        "rmse": numbers(&step.rmse),
        "heldout_rmse": numbers(&step.heldout_rmse),
        "parameters": parameters(&step.parameters),
        "chi_square": number(step.chi_square),
        "degrees_of_freedom": step.degrees_of_freedom,
        "left": number(step.left),
    })
}

fn parameters(all: &[ParameterResult]) -> Value {
    let one = |parameter: &ParameterResult| {
        let fitted = &parameter.fitted;
        let value = json!({
            "value": number(fitted.value),
            "std": fitted.deviation.map(number),
            "at_bound": fitted.at_bound,
            "unit": fitted.variable.unit.symbol,
            "bounds": [number(fitted.variable.min), number(fitted.variable.max)],
            "prior_shift": fitted.prior_shift().map(number),
            "effect": parameter.effect,
        });
        (fitted.variable.name.clone(), value)
    };
    all.iter().map(one).collect::<Map<_, _>>().into()
}

fn candidate(candidate: &CandidateResult) -> Value {
    json!({
        "effect": candidate.effect,
        "probability": number(candidate.probability),
        "tied": candidate.tied,
        "heldout_gain": candidate.heldout_gain.map(number),
        "better": candidate.better.map(number),
        "p_value": number(candidate.p_value),
        "gain": number(candidate.gain),
        "left": number(candidate.left),
        "refitted": candidate.refitted,
        "visible_share": number(candidate.visible_share),
        "parameters": parameters(&candidate.parameters),
    })
}
