//! Pages of several experiments that are fitted together: one of each, with its own model.

use super::comparison::page_with;
use crate::diagnosis::{CompareError, CompareOptions, Given, compare};
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
    let comparison = compare(model, &experiment.parts[part].experiment, &CompareOptions::default())?;
    let note = format!("One of {}, fitted together: {found}.", experiment.name);
    Ok(page_with(&comparison, Some(&note)))
}
