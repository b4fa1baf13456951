//! Pages of several experiments that are fitted together: one of each, with its own model.

use super::comparison::page_with;
use super::diagnosis::verdict_in_words;
use super::saved::{saved_comparison, saved_part};
use crate::diagnosis::{CompareError, CompareOptions, Comparison, Diagnosis, Given, compare};
use crate::measurement::Experiment;

/// The page of one of several experiments that were fitted together, part number `part`, with its own model; it says at first what was
/// `found` of all of them.
///
/// # Errors
/// [`CompareError`] where the model does not fit the part.
pub fn part_page(
    experiment: &Experiment,
    part: usize,
    model: impl Into<Given>,
    found: &str,
) -> Result<String, CompareError> {
    let comparison = of_part(experiment, part, model)?;
    Ok(page_with(&comparison, &saved_comparison(&comparison), Some(&note(experiment, found))))
}

/// The page of one of several experiments that were diagnosed together, part number `part`: its improved model, and each effect that was
/// tried and acts in it along its strength.
///
/// # Errors
/// [`CompareError`] where a model does not fit the part.
pub fn diagnosed_part_page(diagnosis: &Diagnosis, part: usize) -> Result<String, CompareError> {
    let experiment = &diagnosis.experiment;
    let comparison = of_part(experiment, part, &diagnosis.improved_parts[part].1)?;
    let note = note(experiment, &verdict_in_words(diagnosis));
    Ok(page_with(&comparison, &saved_part(diagnosis, part)?, Some(&note)))
}

fn of_part(experiment: &Experiment, part: usize, model: impl Into<Given>) -> Result<Comparison, CompareError> {
    compare(model, &experiment.parts[part].experiment, &CompareOptions::default())
}

fn note(experiment: &Experiment, found: &str) -> String {
    format!("One of {}, fitted together: {found}.", experiment.name)
}
