//! Rovers and their controllers as [`FmuModel`]s: the kinds of FMU that a model file makes.
//!
//! | kind | inputs | outputs |
//! |---|---|---|
//! | [`Kind::Rover`] | torques or speeds of the wheels | signals; `measured.*`, what sensors make of them |
//! | [`Kind::Controller`] | measurements, by the names of the signals, and `velocity_command` | `wheel[k].torque_command` |
//! | [`Kind::RoverWithController`] | those of the model | signals |
//! | [`Kind::Carriage`] | `load`, `slip`, `wheel_speed` | `drawbar_pull`, `torque`, `sinkage` |
//!
//! Without a key `[fmu] kind` in the model file, a wheel on a carriage is itself, a model without a controller a rover, any
//! other the third. With
//! `[fmu] arrays = true` FMI 3.0 has `wheels.slip[2]` in the place of `wheel[1].slip` and `wheel[2].slip`.
//!
//! A rover and a controller of the same model file, wired name by name and stepped by the control period, the controller
//! first, are the third to the last bit: the controller decides at the start of its step, on what is measured then, and
//! its torques hold for the rover's step from there. Where sensors have errors, the rover's `measured.*` are to be wired.
//!
//! # Parameters on the way
//! Soil, gravity, motors, sensors, gains and effects are tunable (see [`RoverModel::is_tunable`]): set between two steps
//! they act from the next inner step on, while everything that moves stays as it is. The rest waits for a start.
//!
//! # Time
//! Inner steps lie at whole multiples of the inner step. A communication point between two of them is served by linear
//! interpolation of the signals between both; the event and what is measured (held by its sensors) are those of the one
//! before. The run is then up to an inner step ahead of the communication point. That inner step has seen the inputs that
//! were set when it was begun; inputs set at the point between act from the next whole inner step on. At whole multiples
//! every value is the core's, bit for bit.

mod by_reference;
#[cfg(feature = "carriage")]
mod carriage;
mod controller;
mod dependencies;
mod derivatives;
mod kind;
mod model_exchange;
mod modes;
mod outputs;
mod plant;
mod state;
mod step_position;
mod tuning;

pub use kind::{Kind, Offer};

use crate::model::FmuModel;
use bekker::model::{Model as RoverModel, ModelKind};
use bekker_modeldescription::xml::{Arrays, Description, Entry, Experiment, identifier};
use bekker_modeldescription::{Exponents, Lookup, Unit};
#[cfg(feature = "carriage")]
use carriage::Carriage;
use controller::Controller;
use plant::RoverFmu;
use std::path::Path;

/// Name of the model file in the resources.
pub const MODEL_FILE: &str = "model.toml";

/// Who made the library and the built-in models, and the line of the licence that says whose they are.
const AUTHOR: &str = "The Bekker developers";
const COPYRIGHT: &str = "Copyright (c) 2026 The Bekker developers";

/// Communication step that is offered, s, as near as whole inner steps come to it.
const USUAL_STEP: f64 = 0.01;

/// Reads the model from an FMU's resources.
///
/// # Errors
/// A sentence where the file cannot be read, or is no valid model.
pub fn load(folder: &Path) -> Result<Box<dyn FmuModel>, String> {
    let file = folder.join(MODEL_FILE);
    let text = std::fs::read_to_string(&file).map_err(|error| format!("cannot read `{}`: {error}", file.display()))?;
    parse(&text).map_err(|error| format!("`{}`: {error}", file.display()))
}

/// The model of a packed model file.
///
/// # Errors
/// A sentence where the text is no valid model, or has not what its kind needs.
pub fn parse(text: &str) -> Result<Box<dyn FmuModel>, String> {
    let model = RoverModel::from_toml(text, None).map_err(|error| error.to_string())?;
    if model.kind == ModelKind::SoilTest {
        return Err(format!(
            "`{}` is a test of a soil, which has no motion in time; expected a rover or a wheel on a carriage",
            model.name
        ));
    }
    let offer = Offer::of(text)?;
    let packed = Packed { text, kind: offer.kind.unwrap_or_else(|| Kind::usual(&model)), arrays: offer.arrays };
    if model.kind == ModelKind::Carriage && packed.kind != Kind::Carriage {
        let (name, kind) = (&model.name, packed.kind.word());
        return Err(format!("`{name}` is a wheel on a carriage and no `{kind}`; expected the kind `carriage`"));
    }
    Ok(match packed.kind {
        #[cfg(feature = "carriage")]
        Kind::Carriage => Box::new(Carriage::new(model, packed)?),
        #[cfg(not(feature = "carriage"))]
        Kind::Carriage => {
            return Err(format!("`{}` is a wheel on a carriage, which this library was built without", model.name));
        }
        Kind::Controller => Box::new(Controller::new(model, packed)?),
        _ => Box::new(RoverFmu::new(model, packed)?),
    })
}

/// A packed model file and what of its model the FMU offers.
#[derive(Clone, Copy)]
struct Packed<'a> {
    text: &'a str,
    kind: Kind,
    arrays: bool,
}

/// Model file and description of a model's FMU, found in the way in which the library will find them again.
///
/// # Errors
/// A sentence where the model does not start.
pub fn describe(model: &RoverModel) -> Result<(String, Description), String> {
    describe_as(model, Offer::default())
}

/// As [`describe`], for an FMU that offers this.
///
/// # Errors
/// A sentence where the model does not start, or has not what the kind needs.
pub fn describe_as(model: &RoverModel, offer: impl Into<Offer>) -> Result<(String, Description), String> {
    let text = offer.into().written(model, model.to_toml().map_err(|error| error.to_string())?);
    let mut read = RoverModel::from_toml(&text, None).map_err(|error| error.to_string())?;
    if read.list() != model.clone().list() || read.control.kind != model.control.kind {
        return Err("its TOML does not read back as the same model".to_owned());
    }
    let description = parse(&text)?.description().clone();
    Ok((text, description))
}

fn description(model: &RoverModel, packed: Packed, inner_step: f64, mut entries: Vec<Entry>) -> Description {
    give_moduli_exponents(&mut entries, model.rover.soil.exponent);
    let step = (USUAL_STEP / inner_step).round().max(1.0) * inner_step;
    let arrays = if packed.arrays { Arrays::of(&entries) } else { Arrays::default() };
    Description {
        name: model.name.clone(),
        identifier: identifier(&model.name),
        description: format!("{}: {}", model.name, packed.kind.about()),
        version: env!("CARGO_PKG_VERSION").into(),
        license: env!("CARGO_PKG_LICENSE").into(),
        author: AUTHOR.into(),
        copyright: COPYRIGHT.into(),
        generation_tool: concat!("Bekker ", env!("CARGO_PKG_VERSION")).into(),
        experiment: Experiment { start: 0.0, stop: model.stepping.duration, step },
        inner_step,
        date: None,
        log_categories: crate::LOG_CATEGORIES,
        content: packed.text.to_owned(),
        entries,
        arrays,
    }
}

/// Gives Bekker's moduli, whose length exponent is the sinkage exponent plus one or two, the exponents that they have at the
/// sinkage exponent `n` of the packed model, where it is a whole number: others no unit of FMI can have.
fn give_moduli_exponents(entries: &mut [Entry], n: f64) {
    if n.fract() != 0.0 {
        return;
    }
    for unit in entries.iter_mut().map(|entry| &mut entry.variable.unit) {
        let further = match unit.symbol {
            symbol if symbol == Unit::COHESIVE_MODULUS.symbol => 1,
            symbol if symbol == Unit::FRICTIONAL_MODULUS.symbol => 2,
            _ => continue,
        };
        // N/m^(n + further) in kg, m and s.
        unit.exponents = Some(Exponents { kg: 1, m: 1 - (n as i8 + further), s: -2, ..Exponents::default() });
    }
}
