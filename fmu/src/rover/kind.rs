//! What of a model an FMU offers.

use serde::Deserialize;

/// What of a model an FMU offers: `kind` in the section `[fmu]` of the packed model file.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Kind {
    /// The plant: wheel torques or speeds in (whichever the model has, torques where it has a controller), true and
    /// measured signals out.
    Rover,
    /// The controller: measurements in, torques out.
    Controller,
    /// The model as it is.
    #[default]
    RoverWithController,
}

impl Kind {
    /// The word in model files.
    #[must_use]
    pub fn word(self) -> &'static str {
        match self {
            Self::Rover => "rover",
            Self::Controller => "controller",
            Self::RoverWithController => "rover_with_controller",
        }
    }

    /// What the FMU is, for people.
    pub(super) fn about(self) -> &'static str {
        match self {
            Self::Rover => "a rover on deformable soil",
            Self::Controller => "control of a rover on rough terrain",
            Self::RoverWithController => "a rover on deformable soil",
        }
    }

    /// The kind that a model file asks for.
    ///
    /// # Errors
    /// A sentence where the file is not TOML or the kind unknown.
    pub fn of(text: &str) -> Result<Self, String> {
        #[derive(Default, Deserialize)]
        #[serde(deny_unknown_fields)]
        struct Section {
            #[serde(default)]
            kind: Kind,
        }
        #[derive(Deserialize)]
        struct File {
            #[serde(default)]
            fmu: Section,
        }
        let file: File = toml::from_str(text).map_err(|error| error.to_string())?;
        Ok(file.fmu.kind)
    }

    /// `text`, the model file of a model, with this kind in it. The usual kind is not written.
    pub(super) fn written(self, text: String) -> String {
        if self == Self::default() { text } else { format!("{text}\n[fmu]\nkind = \"{}\"\n", self.word()) }
    }
}
