//! Models that are built in.

use super::{ControlKind, Model, ModelError};
use crate::rover::Rover;
use crate::terrain::{Profile, Terrain, Waves};

/// Names and meanings of the built-in models.
pub const PRESETS: &[(&str, &str)] = &[
    ("two_wheeled", "two-wheeled 10 kg rover of Iagnemma 2001, 4.4.1 on flat thesis sand, wheel torques commanded"),
    ("two_wheeled_speed", "the same, wheel speeds commanded and followed exactly"),
    ("gentle_velocity", "the same on gently rolling ground under individual-wheel velocity control"),
    ("gentle_rtc", "the same on gently rolling ground under rough-terrain control"),
    (
        "rocker_bogie",
        "one side of a six-wheeled rocker-bogie rover, half of 6.1 kg, on flat dry sand, wheel torques commanded",
    ),
    ("rocker_bogie_speed", "the same, wheel speeds commanded and followed exactly"),
    ("rocker_bogie_velocity", "the same on gently rolling ground under individual-wheel velocity control"),
];

impl Model {
    /// A built-in model by its name, see [`PRESETS`].
    ///
    /// # Errors
    /// [`ModelError::UnknownPreset`] with the names that exist.
    pub fn preset(name: &str) -> Result<Self, ModelError> {
        let (vehicle, kind, terrain) = match name {
            "two_wheeled" => (Rover::two_wheeled(), ControlKind::Torque, Terrain::default()),
            "two_wheeled_speed" => (Rover::two_wheeled(), ControlKind::Speed, Terrain::default()),
            "gentle_velocity" => (Rover::two_wheeled(), ControlKind::Velocity, gentle(2.5)),
            "gentle_rtc" => (Rover::two_wheeled(), ControlKind::Rtc, gentle(2.5)),
            "rocker_bogie" => (Rover::rocker_bogie(), ControlKind::Torque, Terrain::default()),
            "rocker_bogie_speed" => (Rover::rocker_bogie(), ControlKind::Speed, Terrain::default()),
            "rocker_bogie_velocity" => (Rover::rocker_bogie(), ControlKind::Velocity, gentle(1.0)),
            _ => return Err(ModelError::UnknownPreset { name: name.to_owned() }),
        };
        let mut model = Self::new(name, vehicle);
        model.rover.terrain = terrain;
        model.control.kind = kind;
        if name == "rocker_bogie_velocity" {
            // Lighter wheels than the controller's default gains are for.
            model.control.velocity.kp = 0.1;
            model.control.velocity.ki = 5.0;
        }
        Ok(model)
    }
}

/// Gently rolling ground, the stand-in for the thesis's figure 4.6, which gives no numbers: waves whose
/// steepest slope is 5 degrees, behind half a metre of level ground.
fn gentle(wavelength: f64) -> Terrain {
    let steepest = 5.0_f64.to_radians().tan();
    let amplitude = steepest * wavelength / std::f64::consts::TAU;
    Terrain::new(Profile::Waves(Waves { amplitude, wavelength, start: 0.5 }))
}
