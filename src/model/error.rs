//! Why a model cannot be read or written.

use super::PRESETS;
use crate::effects::DefinitionError;
use crate::terrain::TerrainSpecError;
use bekker_modeldescription::ParameterError;

/// Why a model cannot be read.
#[derive(Debug, thiserror::Error)]
pub enum ModelError {
    /// The text is not TOML, or has an unknown key or a value of the wrong type.
    #[error("the model file cannot be read: {0}")]
    Syntax(#[from] toml::de::Error),
    /// The model cannot be written.
    #[error("the model cannot be written: {0}")]
    Unwritable(#[from] toml::ser::Error),
    /// The file cannot be opened.
    #[error("{file}: {source}")]
    Unreadable {
        /// The file.
        file: String,
        /// What the system says.
        source: std::io::Error,
    },
    /// A parameter is unknown or out of range.
    #[error(transparent)]
    Parameter(#[from] ParameterError),
    /// A parameter's value is not a number.
    #[error("parameter `{name}`: expected a number, found {found}")]
    NotANumber {
        /// The parameter.
        name: String,
        /// The type found.
        found: &'static str,
    },
    /// No built-in model has this name.
    #[error("unknown preset `{name}`; the presets are {}", preset_names())]
    UnknownPreset {
        /// The name asked for.
        name: String,
    },
    /// The vehicle's structure makes no sense.
    #[error("vehicle: {0}")]
    Vehicle(String),
    /// An effect of the user's own is refused.
    #[error(transparent)]
    Effect(#[from] DefinitionError),
    /// The terrain cannot be built.
    #[error(transparent)]
    Terrain(#[from] TerrainSpecError),
    /// The model has obstacles, and its plant computes contact with soil only.
    #[error(
        "{0} [[obstacle]] given, but the plant is in joint coordinates; expected simulation.plant = \"rigid_bodies\""
    )]
    Obstacles(usize),
    /// A wheel on a carriage or a test of a soil with something that only a rover has.
    #[error(
        "[rig]: a wheel on a carriage or a test of a soil has no [{0}]; expected [parameters] and [[effect]] beside it"
    )]
    Rig(&'static str),
    /// A name of neither a file nor a built-in model.
    #[error("`{name}` is neither a file nor a built-in model ({})", preset_names())]
    Neither {
        /// The name.
        name: String,
    },
    /// A model file is refused.
    #[error("in `{file}`: {source}")]
    File {
        /// The file.
        file: String,
        /// Why.
        source: Box<ModelError>,
    },
    /// A number of `[simulation]` is out of range.
    #[error("simulation.{name} = {value}: expected {expected}")]
    Simulation {
        /// The key.
        name: &'static str,
        /// Its value.
        value: f64,
        /// The allowed range.
        expected: &'static str,
    },
}

fn preset_names() -> String {
    PRESETS.iter().map(|(name, _)| *name).collect::<Vec<_>>().join(", ")
}
