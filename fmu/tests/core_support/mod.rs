//! Models behind the version-neutral border, by the names of their variables.
#![allow(clippy::unwrap_used, reason = "a test may fail by panicking")]
#![allow(dead_code, reason = "not every test uses all of it")]

use bekker::model::Model as RoverModel;
use bekker_fmu::Kind;
use bekker_fmu::model::FmuModel;
use bekker_modeldescription::xml::Causality;

/// The FMU's model of this kind.
pub fn loaded(model: &RoverModel, kind: Kind) -> Box<dyn FmuModel> {
    let (text, description) = bekker_fmu::describe_as(model, kind).unwrap();
    let loaded = bekker_fmu::rover::parse(&text).unwrap();
    assert_eq!(*loaded.description(), description, "what is described is what is loaded");
    loaded
}

/// The reference of a variable.
pub fn reference(model: &dyn FmuModel, name: &str) -> usize {
    let entries = &model.description().entries;
    entries.iter().position(|entry| entry.variable.name == name).unwrap_or_else(|| panic!("no `{name}`"))
}

pub fn set(model: &mut dyn FmuModel, name: &str, value: f64) {
    model.set(reference(model, name), value);
}

pub fn get(model: &dyn FmuModel, name: &str) -> f64 {
    model.get(reference(model, name))
}

/// References of all variables of a kind.
pub fn all(model: &dyn FmuModel, causality: Causality) -> Vec<usize> {
    let entries = model.description().entries.iter().enumerate();
    entries.filter(|(_, entry)| entry.causality == causality).map(|(reference, _)| reference).collect()
}

/// Bits of all outputs.
pub fn bits(model: &dyn FmuModel) -> Vec<u64> {
    all(model, Causality::Output).into_iter().map(|reference| model.get(reference).to_bits()).collect()
}
