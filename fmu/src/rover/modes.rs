//! What a controller goes by, and what it reads for that.

use bekker::control::Criterion;
use bekker::model::{ControlKind, Model as RoverModel};
use bekker_modeldescription::xml::{Entry, Item, Kind as Type};
use bekker_modeldescription::{Lookup, Role, Unit, Variable};

/// Values of the parameter `mode`.
pub(super) const MODES: &[Item] = &[
    Item { name: "velocity", value: 0, doc: "Every wheel holds its own speed." },
    Item { name: "traction", value: 1, doc: "Rough-terrain control for the most traction (4.5)." },
    Item { name: "power", value: 2, doc: "Rough-terrain control for the least power (4.10)." },
    Item { name: "dual", value: 3, doc: "Rough-terrain control for whichever the ground asks for (4.11)." },
    Item { name: "wheel_speeds", value: 4, doc: "Rough-terrain control with wheel-speed loops." },
];

/// First parts of names that a controller reads.
const READ: [&str; 10] = [
    "gravity",
    "motor",
    "soil",
    "nominal",
    "velocity_control",
    "velocity_tuned",
    "rtc",
    "rtc_speed",
    "contact_angle_estimation",
    "soil_identification",
];
/// What it reads of a vehicle's numbers: those of a data sheet at rest.
const READ_OF_VEHICLE: [&str; 7] = ["x", "z", "mass", "centre_of_mass_x", "centre_of_mass_z", "radius", "width"];

/// Whether a model has a controller that such an FMU can be.
///
/// # Errors
/// A sentence where it has none, or one that has no mode.
pub(super) fn check_kind(model: &RoverModel) -> Result<(), String> {
    match model.control.kind {
        ControlKind::Velocity | ControlKind::VelocityTuned | ControlKind::Rtc | ControlKind::RtcSpeed => Ok(()),
        kind => Err(format!(
            "control.kind = {kind:?} of `{}` is no controller that an FMU of its own can be; expected velocity, \
             velocity_tuned, rtc or rtc_speed",
            model.name
        )),
    }
}

/// The mode that a model has of itself.
pub(super) fn usual_mode(model: &RoverModel) -> f64 {
    match (model.control.kind, model.control.criterion) {
        (ControlKind::Velocity | ControlKind::VelocityTuned | ControlKind::SpeedLoop, _) => 0.0,
        (ControlKind::RtcSpeed, _) => 4.0,
        (_, Some(Criterion::Traction)) => 1.0,
        (_, Some(Criterion::Power | Criterion::ElectricalPower)) => 2.0,
        (_, None) => 3.0,
    }
}

/// The kind of control of a mode, for a model that has `usual` of itself.
pub(super) fn kind_of(usual: ControlKind, mode: f64) -> ControlKind {
    match usual {
        _ if mode == 4.0 => ControlKind::RtcSpeed,
        _ if mode > 0.0 => ControlKind::Rtc,
        ControlKind::VelocityTuned => ControlKind::VelocityTuned,
        _ => ControlKind::Velocity,
    }
}

pub(super) fn in_mode(model: &RoverModel, mode: f64) -> RoverModel {
    let (mut model, usual) = (model.clone(), model.control.kind);
    model.control.kind = kind_of(model.control.kind, mode);
    model.control.criterion = match mode {
        1.0 => Some(Criterion::Traction),
        2.0 => Some(Criterion::Power),
        4.0 if usual == ControlKind::RtcSpeed => model.control.criterion,
        _ => None,
    };
    model
}

pub(super) fn mode_entry(mode: f64) -> Entry {
    let variable = Variable {
        name: "mode".into(),
        doc: "What the controller goes by.".into(),
        unit: Unit::ONE,
        default: 3.0,
        min: 0.0,
        max: 4.0,
        role: Role::Fixed,
        source: "Iagnemma 2001, chapter 4".into(),
    };
    Entry { kind: Type::Enumeration { name: "Mode", items: MODES }, ..Entry::parameter(variable, mode) }
}

/// Everything that the controller reads in any mode, once.
pub(super) fn list(model: &RoverModel) -> Vec<(Variable, f64)> {
    let mut all: Vec<(Variable, f64)> = Vec::new();
    for mode in 0..MODES.len() {
        for (variable, value) in in_mode(model, mode as f64).list() {
            let known = all.iter().any(|(other, _)| other.name == variable.name);
            if !known && reads(model, &variable.name) {
                all.push((variable, value));
            }
        }
    }
    all
}

fn reads(model: &RoverModel, name: &str) -> bool {
    let group = name.split(['.', '[']).next().unwrap_or(name);
    let last = name.rsplit('.').next().unwrap_or(name);
    match group {
        "rover" | "link" | "wheel" => READ_OF_VEHICLE.contains(&last),
        // Its own belief of the soil takes the place of the rover's.
        "soil" => model.control.nominal_soil.is_none(),
        _ => READ.contains(&group),
    }
}
