//! What of a model an FMU offers.

use bekker::model::{ControlKind, Model, ModelKind};
use std::str::FromStr;

/// What of a model an FMU offers: `kind` in the section `[fmu]` of the packed model file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// The plant: wheel torques or speeds in (whichever the model has, torques where it has a controller), true and
    /// measured signals out.
    Rover,
    /// The controller: measurements in, torques out.
    Controller,
    /// The model as it is.
    RoverWithController,
    /// A wheel on a carriage: load, slip and wheel speed in; drawbar pull, torque and sinkage out. The only kind of such a
    /// model, and of no other.
    Carriage,
}

/// The words of the doors, for people.
impl FromStr for Kind {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text {
            "rover" => Ok(Self::Rover),
            "controller" => Ok(Self::Controller),
            "closed-loop" => Ok(Self::RoverWithController),
            "carriage" => Ok(Self::Carriage),
            _ => Err("expected rover, controller, closed-loop or carriage".into()),
        }
    }
}

impl Kind {
    /// The word in model files.
    #[must_use]
    pub fn word(self) -> &'static str {
        match self {
            Self::Rover => "rover",
            Self::Controller => "controller",
            Self::RoverWithController => "rover_with_controller",
            Self::Carriage => "carriage",
        }
    }

    fn from_word(word: &str) -> Result<Self, String> {
        let all = [Self::Rover, Self::Controller, Self::RoverWithController, Self::Carriage];
        let found = all.into_iter().find(|kind| kind.word() == word);
        found.ok_or_else(|| format!("`fmu.kind` = `{word}`: expected one of {}", all.map(Self::word).join(", ")))
    }

    /// What the FMU is, for people.
    pub(super) fn about(self) -> &'static str {
        match self {
            Self::Rover => "a rover on deformable soil",
            Self::Controller => "control of a rover on rough terrain",
            Self::RoverWithController => "a rover on deformable soil",
            Self::Carriage => "a wheel on a carriage on deformable soil",
        }
    }

    /// The usual kind: a model without a controller is a plant.
    #[must_use]
    pub fn usual(model: &Model) -> Self {
        if model.kind == ModelKind::Carriage {
            return Self::Carriage;
        }
        match model.control.kind {
            ControlKind::Torque | ControlKind::Speed => Self::Rover,
            _ => Self::RoverWithController,
        }
    }
}

/// The section `[fmu]` of a packed model file: what of the model the FMU offers, and how.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Offer {
    /// What of the model; the usual kind where missing.
    pub kind: Option<Kind>,
    /// Whether FMI 3.0 shows the same quantity of every wheel, link or obstacle as one array, see
    /// [`Arrays`](bekker_modeldescription::xml::Arrays).
    pub arrays: bool,
}

impl Offer {
    /// What a model file asks for.
    ///
    /// # Errors
    /// A sentence where the file is not TOML or the section has something unknown.
    pub fn of(text: &str) -> Result<Self, String> {
        let mut file: toml::Table = toml::from_str(text).map_err(|error| error.to_string())?;
        let section = match file.remove("fmu") {
            None => return Ok(Self::default()),
            Some(toml::Value::Table(section)) => section,
            Some(other) => return Err(wrong("fmu", "a table", &other)),
        };
        let mut offer = Self::default();
        for (key, value) in section {
            match (key.as_str(), value) {
                ("kind", toml::Value::String(word)) => offer.kind = Some(Kind::from_word(&word)?),
                ("arrays", toml::Value::Boolean(arrays)) => offer.arrays = arrays,
                ("kind", other) => return Err(wrong("fmu.kind", "a text", &other)),
                ("arrays", other) => return Err(wrong("fmu.arrays", "true or false", &other)),
                _ => return Err(format!("`fmu.{key}`: expected one of the keys kind, arrays")),
            }
        }
        Ok(offer)
    }

    /// `text`, the model file of `model`, with this offer in it. What is usual is not written.
    pub(super) fn written(self, model: &Model, mut text: String) -> String {
        let kind = self.kind.filter(|kind| *kind != Kind::usual(model));
        if kind.is_some() || self.arrays {
            text += "\n[fmu]\n";
        }
        if let Some(kind) = kind {
            text += &format!("kind = \"{}\"\n", kind.word());
        }
        if self.arrays {
            text += "arrays = true\n";
        }
        text
    }
}

fn wrong(key: &str, expected: &str, found: &toml::Value) -> String {
    format!("`{key}`: expected {expected}, found {}", found.type_str())
}

impl From<Kind> for Offer {
    fn from(kind: Kind) -> Self {
        Self { kind: Some(kind), ..Self::default() }
    }
}
