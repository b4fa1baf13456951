//! What several experiments may have in common.

use serde::{Deserialize, Serialize};

/// A thing of which several experiments may have the same.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Share {
    /// The soil: all parameters `soil.*`.
    Soil,
    /// The vehicle or wheel with its drive: dimensions, masses, motor and gear, and what is wrong with them.
    Vehicle,
    /// The drive alone: motor and gear.
    Drive,
}

/// What belongs to a drive: groups of parameters by the name before the dot.
const DRIVE: [&str; 7] = [
    "motor",
    "coulomb_friction",
    "viscous_friction",
    "gear_efficiency",
    "torque_scale",
    "winding_heat",
    "voltage_limit",
];

/// What belongs to a vehicle besides its drive.
const VEHICLE: [&str; 11] = [
    "wheel",
    "rover",
    "link",
    "radius_scale",
    "flexible_wheel",
    "grousers",
    "rim_adhesion",
    "rolling_resistance",
    "payload",
    "centre_of_mass",
    "suspension_friction",
];

impl Share {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Soil, Self::Vehicle, Self::Drive];

    /// Its name in `experiment.toml` and on the command line.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Soil => "soil",
            Self::Vehicle => "vehicle",
            Self::Drive => "drive",
        }
    }

    /// The thing with this name.
    #[must_use]
    pub fn find(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|share| share.name() == name)
    }

    /// The thing to which a parameter belongs; a parameter of the drive belongs to the vehicle, too. None where it is one of the
    /// single experiment: an instrument, the ground, a test rig.
    #[must_use]
    pub fn of(parameter: &str) -> Option<Self> {
        let group = parameter.split(['.', '[']).next().unwrap_or_default();
        match group {
            "soil" => Some(Self::Soil),
            _ if DRIVE.contains(&group) => Some(Self::Drive),
            _ if VEHICLE.contains(&group) => Some(Self::Vehicle),
            _ => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{DRIVE, Share, VEHICLE};
    use crate::model::Model;
    use bekker_modeldescription::Lookup;

    #[test]
    fn property_every_name_that_is_listed_is_one_of_a_model() {
        let list = Model::preset("rocker_bogie").map(|mut model| model.list()).unwrap_or_default();
        for group in DRIVE.iter().chain(&VEHICLE) {
            let known = list.iter().any(|(variable, _)| variable.name.split(['.', '[']).next() == Some(group));
            assert!(known, "{group}");
        }
        assert_eq!(Share::of("wheel[3].x"), Some(Share::Vehicle));
        assert_eq!(Share::of("plate.diameter"), None);
    }
}
