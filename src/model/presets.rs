//! Models that are built in.

use super::{ControlKind, Model, ModelError};
use crate::rover::Rover;
use crate::terrain::{Incline, LooseDitch, Profile, Rough, Terrain, TerrainSpecError, Waves};

/// Names and meanings of the built-in models.
pub const PRESETS: &[(&str, &str)] = &[
    ("two_wheeled", "two-wheeled 10 kg rover of Iagnemma 2001, 4.4.1 on flat thesis sand, wheel torques commanded"),
    ("two_wheeled_speed", "the same, wheel speeds commanded and followed exactly"),
    ("gentle_velocity", "the same on gently rolling ground under individual-wheel velocity control"),
    ("gentle_rtc", "the same on gently rolling ground under rough-terrain control"),
    ("gentle_rtc_speed", "the same on gently rolling ground under rough-terrain control with wheel-speed loops"),
    (
        "rocker_bogie",
        "one side of a six-wheeled rocker-bogie rover, half of 6.1 kg, on flat dry sand, wheel torques commanded",
    ),
    ("rocker_bogie_speed", "the same, wheel speeds commanded and followed exactly"),
    ("rocker_bogie_velocity", "the same on gently rolling ground under individual-wheel velocity control"),
    ("challenging_velocity", "the two-wheeled rover on ground as steep as the soil's friction angle, velocity control"),
    ("challenging_rtc", "the same under rough-terrain control"),
    ("challenging_rtc_speed", "the same under rough-terrain control with wheel-speed loops"),
    ("fsrl_ditch", "one side of the FSRL rover of appendix C before a ditch of loose sand, velocity control"),
    ("fsrl_incline", "the same before an incline of 20 degrees"),
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
            "gentle_rtc_speed" => (Rover::two_wheeled(), ControlKind::RtcSpeed, gentle(2.5)),
            "rocker_bogie" => (Rover::rocker_bogie(), ControlKind::Torque, Terrain::default()),
            "rocker_bogie_speed" => (Rover::rocker_bogie(), ControlKind::Speed, Terrain::default()),
            "rocker_bogie_velocity" => (Rover::rocker_bogie(), ControlKind::Velocity, gentle(1.0)),
            "challenging_velocity" => (Rover::two_wheeled(), ControlKind::Velocity, rough()?),
            "challenging_rtc" => (Rover::two_wheeled(), ControlKind::Rtc, rough()?),
            "challenging_rtc_speed" => (Rover::two_wheeled(), ControlKind::RtcSpeed, rough()?),
            "fsrl_ditch" => (Rover::fsrl(), ControlKind::Velocity, ditch(&Rover::fsrl())?),
            "fsrl_incline" => (Rover::fsrl(), ControlKind::Velocity, incline()?),
            _ => return Err(ModelError::UnknownPreset { name: name.to_owned() }),
        };
        let mut model = Self::new(name, vehicle);
        model.rover.terrain = terrain;
        model.control.kind = kind;
        if !model.rover.links.is_empty() && kind == ControlKind::Velocity {
            model.control.lighten();
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

/// The ditch of 4.4.2, covered by loose sand: three wheel diameters wide, of the two to four that are stated, its walls as
/// steep as the soil's friction angle of 28 degrees, which is as steep as loose sand lies. Half the stiffness of the dry
/// sand around is an assumption; the loose sand's cohesion is that of the thesis's bevameter sand.
fn ditch(rover: &Rover) -> Result<Terrain, TerrainSpecError> {
    let radius = rover.wheel.radius;
    let ditch = LooseDitch {
        width: 6.0 * radius,
        wall: rover.soil.friction_angle,
        rounding: 1.25 * radius,
        position: 0.7,
        cohesion: 180.0,
        modulus_factor: 0.5,
    };
    ditch.terrain(rover.soil.cohesion)
}

fn rough() -> Result<Terrain, TerrainSpecError> {
    Ok(Rough::default().terrain()?)
}

fn incline() -> Result<Terrain, TerrainSpecError> {
    Ok(Incline::default().terrain()?)
}
