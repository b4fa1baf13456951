//! What the page of one of several experiments holds: the models of the diagnosis of all of them as they act in this one, and the model
//! along the strength of each effect that acts in it.

use super::whole::{fits, found_of, steps, values_of};
use super::{Saved, Step, Tried};
use crate::diagnosis::{Axis, Calibration, CompareError, Diagnosis, Trial, Workbench, plain_effect};
use serde_json::{Value, json};
use std::borrow::Cow;
use std::collections::BTreeMap;

/// The data of the page of part number `part`.
///
/// # Errors
/// [`CompareError`] where a model of the diagnosis has no answer there.
pub(in crate::report) fn saved_part(diagnosis: &Diagnosis, part: usize) -> Result<Value, CompareError> {
    let bench = &diagnosis.workbench;
    let own = &bench.parts()[part];
    let best = best(diagnosis, part);
    let saved = Saved {
        experiment: own.experiment(),
        workbench: own,
        steps: steps(diagnosis).into_iter().map(|step| of_part(bench, part, step)).collect::<Result<_, _>>()?,
        tried: best.iter().map(|(effects, fit)| tried(bench, part, effects, fit)).collect::<Result<_, _>>()?,
        diagnosis: Some(found(diagnosis, &best)),
    };
    Ok(saved.json())
}

/// A step of the whole as the part shows it, under names of its own.
fn of_part<'a>(bench: &Workbench, part: usize, step: Step<'a>) -> Result<Step<'a>, CompareError> {
    let whole = Trial { fit: step.fit.into_owned(), unanswered: step.unanswered.into_owned(), failures: Vec::new() };
    let Trial { fit, unanswered, failures } = bench.trial_of_part(part, &whole, &step.values, true)?;
    let mut curves = Vec::new();
    for axis in Axis::ALL {
        curves.extend(bench.sketch_of_part(part, axis, &step.values)?.map(|curves| (Cow::Owned(curves), None)));
    }
    Ok(Step {
        label: step.label,
        effects: step.effects.iter().filter_map(|id| own_effect(bench, part, id)).collect(),
        values: bench.values_of_part(part, &step.values)?,
        fit: Cow::Owned(fit),
        failures,
        unanswered: Cow::Owned(unanswered),
        curves,
        toml: bench.model_of_part(part, &step.values)?.to_toml().ok(),
    })
}

/// Effects and values of a fit of the whole.
type WholeFit<'a> = (&'a [String], &'a Calibration);

/// The fits whose effects all act in the part, by what these are called there. One effect may have been tried in all experiments, in one,
/// and in all but one: the best of these fits is shown.
fn best(diagnosis: &Diagnosis, part: usize) -> BTreeMap<Vec<String>, WholeFit<'_>> {
    let mut best: BTreeMap<Vec<String>, WholeFit> = BTreeMap::new();
    for (effects, calibration) in fits(diagnosis) {
        let own = effects.iter().map(|id| own_effect(&diagnosis.workbench, part, id)).collect::<Option<Vec<_>>>();
        let Some(mut own) = own else { continue };
        own.sort();
        if best.get(&own).is_none_or(|(_, known)| calibration.chi_square < known.chi_square) {
            best.insert(own, (effects, calibration));
        }
    }
    best
}

/// A fit of the whole as the part shows it. Standard errors are those of the whole, under other names, and left out.
fn tried(bench: &Workbench, part: usize, effects: &[String], (_, fit): &WholeFit) -> Result<Tried, CompareError> {
    let values = bench.values_of_part(part, &values_of(fit))?;
    let found = json!({ "effects": effects, "values": values, "chi_square": fit.chi_square, "fitted": null });
    Ok(Tried { effects: effects.to_vec(), values, found })
}

/// What the diagnosis found, with the candidates of the part under the names that they have there.
fn found(diagnosis: &Diagnosis, best: &BTreeMap<Vec<String>, WholeFit>) -> Value {
    let singles: BTreeMap<&String, &String> = best
        .iter()
        .filter_map(|(own, (whole, _))| Some((whole.first().filter(|_| whole.len() == 1)?, &own[0])))
        .collect();
    let mut shown = found_of(diagnosis);
    if let Some(candidates) = shown["candidates"].as_array_mut() {
        candidates.retain_mut(|candidate| {
            let own = candidate["effect"].as_str().and_then(|id| singles.get(&id.to_owned()).copied());
            own.is_some_and(|own| {
                candidate["effect"] = json!(own);
                true
            })
        });
    }
    shown
}

/// What an effect of the whole is called in the part; `None` where it does not act there.
fn own_effect(bench: &Workbench, part: usize, id: &str) -> Option<String> {
    let acts = |parts: &Option<Vec<usize>>| parts.as_ref().is_none_or(|parts| parts.contains(&part));
    let mut of_whole = bench.parameters().iter().filter(|own| own.effect.as_deref() == Some(id));
    let plain = plain_effect(id);
    let is_known = bench.parts()[part].parameters().iter().any(|own| own.effect.as_deref() == Some(plain));
    (of_whole.any(|own| acts(&own.parts)) && is_known).then(|| plain.to_owned())
}
