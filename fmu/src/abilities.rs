//! What a model offers beyond values and steps, found out by asking it.

use crate::model::FmuModel;
use bekker_modeldescription::xml::{Abilities, Causality, Kind};

/// The capabilities that the model description claims for `model`.
///
/// # Errors
/// A sentence where the model does not start.
pub fn abilities(model: &mut dyn FmuModel) -> Result<Abilities, String> {
    model.start().map_err(|failure| failure.to_string())?;
    let first = |wanted: Causality| {
        let entries = &model.description().entries;
        entries.iter().position(|entry| entry.causality == wanted && entry.kind == Kind::Real)
    };
    let pair = first(Causality::Output).zip(first(Causality::Input));
    let (mut directional, mut adjoint) = (false, false);
    if let Some((unknown, known)) = pair {
        directional = model.directional(&[unknown], &[known], &[1.0], &mut [0.0]).is_ok();
        adjoint = model.adjoint(&[unknown], &[known], &[1.0], &mut [0.0]).is_ok();
    }
    let states_as_bytes = model.serialise().is_ok();
    let exchange = model.continuous().map(|equations| equations.indicators());
    Ok(Abilities { states_as_bytes, directional, adjoint, exchange })
}
