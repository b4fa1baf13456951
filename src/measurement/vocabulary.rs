//! What a name means: parameters of the model, signals and inputs of an experiment.

use super::experiment::Kind;
use crate::effects::EffectDefinition;
use crate::model::Model;
use crate::soil_test::TestRig;
use bekker_modeldescription::{Lookup, Role, Unit, Variable, nearest};
use std::borrow::Cow;

/// The built-in model with the most parts: its parameters, with any number in brackets, are all there are.
const LARGEST: &str = "rocker_bogie_speed";

/// Description of a parameter, by its name; a number in brackets may be any.
///
/// # Errors
/// A message with names that look alike.
pub(super) fn parameter(name: &str, effects: &[EffectDefinition]) -> Result<Variable, String> {
    let all = parameters(effects);
    let plain = unnumbered(name);
    match all.iter().find(|variable| unnumbered(&variable.name) == plain) {
        Some(variable) => Ok(Variable { name: name.to_owned(), ..variable.clone() }),
        None => {
            let near = nearest(name, all.into_iter().map(|variable| variable.name));
            let near = if near.is_empty() { String::new() } else { format!("; did you mean {}?", near.join(", ")) };
            Err(format!("unknown parameter `{name}`{near}"))
        }
    }
}

fn parameters(effects: &[EffectDefinition]) -> Vec<Variable> {
    let mut library = Model::preset(LARGEST).map(|mut model| model.list()).unwrap_or_default();
    library.extend(TestRig::default().list());
    let own = effects.iter().flat_map(|effect| {
        effect.parameters.iter().map(|(name, parameter)| Variable {
            name: format!("{}.{name}", effect.id),
            doc: Cow::Owned(parameter.about.clone()),
            unit: Unit::of_symbol(&parameter.unit).unwrap_or(Unit::ONE),
            default: parameter.neutral,
            min: parameter.min,
            max: parameter.max,
            role: Role::Effect,
            source: Cow::Owned(parameter.source.clone()),
        })
    });
    library.into_iter().map(|(variable, _)| variable).chain(own).collect()
}

/// A name with its numbers in brackets left out.
fn unnumbered(name: &str) -> String {
    let mut inside = false;
    let kept = |c: &char| {
        inside = (inside || *c == '[') && *c != ']';
        !inside || *c == '['
    };
    name.chars().filter(kept).collect()
}

/// The unit of a field of a group of signals.
pub(super) fn unit_in(mut group: impl Lookup, field: &str) -> Option<Unit> {
    group.list().into_iter().find(|(variable, _)| variable.name == field).map(|(variable, _)| variable.unit)
}

/// Parts of a name such as `wheel[2].torque`, or `wheel[1+2].current`, which is a sum over wheels 1 and 2.
pub(super) fn numbered(name: &str) -> Option<(&str, &str, Vec<usize>)> {
    let (part, rest) = name.split_once('[')?;
    let (numbers, field) = rest.split_once("].")?;
    let numbers: Vec<usize> = numbers.split('+').map(|n| n.parse().ok()).collect::<Option<_>>()?;
    let rising = numbers.windows(2).all(|pair| pair[0] < pair[1]);
    (rising && numbers.first().is_some_and(|first| *first > 0)).then_some((part, field, numbers))
}

/// The signals of a model whose sum is recorded as `name`: wheels 1 and 2 of `wheel[1+2].current`, mostly `name` alone.
#[must_use]
pub fn summands(name: &str) -> Vec<String> {
    match numbered(name) {
        Some((part, field, numbers)) if numbers.len() > 1 => {
            numbers.into_iter().map(|number| format!("{part}[{number}].{field}")).collect()
        }
        _ => vec![name.to_owned()],
    }
}

/// Names of an experiment of this kind that look like `name`.
pub(super) fn alike(kind: Kind, name: &str) -> Vec<String> {
    let number = numbered(name).and_then(|(_, _, numbers)| numbers.first().copied()).unwrap_or(1);
    nearest(name, kind.format().signal_names().into_iter().map(|known| known.replace("[k]", &format!("[{number}]"))))
}
