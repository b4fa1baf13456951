//! Experiments that the model is not asked about, because what separates there is known beforehand: a single cause acts.

use crate::diagnosis::problem::Problem;
use crate::measurement::Kind;
use bekker_modeldescription::Role;

/// What a special experiment needs of the rig.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Needs {
    /// A wheel on a carriage, which can be lifted and loaded.
    Carriage,
    /// A rover: several wheels, its own pitch, a way to go.
    Rover,
    /// A rover with passive joints.
    Joints,
    /// A plate and a shear ring beside either rig, and soil parameters that are free and not known from such a test yet.
    Plate,
}

/// An experiment in which some effects act alone or against all others.
pub(crate) struct Special {
    pub effects: &'static [&'static str],
    pub needs: Needs,
    pub text: &'static str,
}

/// The simplest experiments first; an effect that a kind of rig cannot show by its nature has no line for it: a carriage has
/// no second wheel that passes the same ground, no pitch and no cable.
pub(crate) const SPECIAL: [Special; 21] = [
    Special {
        effects: &["coulomb_friction", "viscous_friction"],
        needs: Needs::Carriage,
        text: "spin the lifted wheel at two or more speeds and record its torque: without soil only the friction of the drive is left",
    },
    Special {
        effects: &["coulomb_friction", "viscous_friction"],
        needs: Needs::Rover,
        text: "lift the rover, spin its wheels at two or more speeds and record their torques: without soil only the friction of the drives is left",
    },
    Special {
        effects: &["torque_scale", "gear_efficiency"],
        needs: Needs::Carriage,
        text: "drive and back-drive the wheel against a known torque (a brake or a hanging weight): a scale acts the same way in both, an efficiency does not",
    },
    Special {
        effects: &["torque_scale", "gear_efficiency"],
        needs: Needs::Rover,
        text: "drive and back-drive a lifted wheel against a known torque (a brake or a hanging weight): a scale acts the same way in both, an efficiency does not",
    },
    Special {
        effects: &["radius_scale", "flexible_wheel"],
        needs: Needs::Carriage,
        text: "roll the wheel over a hard plate under two loads and count its turns a metre: without sinkage the radius, and how it changes with load, is read directly",
    },
    Special {
        effects: &["drag"],
        needs: Needs::Carriage,
        text: "move the carriage with the wheel lifted: the force that remains is the resistance of the carriage",
    },
    Special {
        effects: &["radius_scale", "drag", "odometry_scale"],
        needs: Needs::Rover,
        text: "tow the rover over a hard floor and count wheel turns a metre: without sinkage the radius and the resistance are read directly",
    },
    Special {
        effects: &["payload"],
        needs: Needs::Carriage,
        text: "weigh what the wheel carries, the wheel and its mount included: that gives the load without the model",
    },
    Special {
        effects: &["payload", "centre_of_mass"],
        needs: Needs::Rover,
        text: "weigh the rover wheel by wheel: that gives its mass and its centre of mass",
    },
    Special {
        effects: &["pitch_bias", "centre_of_mass"],
        needs: Needs::Rover,
        text: "drive the same ground with the heading reversed: the mean of both pitches is the sensor's bias, and what stays of the split of the wheel loads is the centre of mass",
    },
    Special { effects: &["multi_pass"], needs: Needs::Rover, text: "drive the same rut twice and compare the passes" },
    Special {
        effects: &["rate"],
        needs: Needs::Carriage,
        text: "repeat a steady point at three wheel speeds that span a factor of ten",
    },
    Special {
        effects: &["rate"],
        needs: Needs::Rover,
        text: "repeat a level run at three speeds that span a factor of ten",
    },
    Special {
        effects: &["winding_heat"],
        needs: Needs::Rover,
        text: "let the loaded drive run for half an hour and record current and voltage: only heat changes with time",
    },
    Special {
        effects: &["tether"],
        needs: Needs::Rover,
        text: "drive the same length twice, with the cable held by hand and with the cable laid out",
    },
    Special {
        effects: &["soft_patch"],
        needs: Needs::Rover,
        text: "repeat the run on freshly prepared soil some metres aside: a patch stays where it is",
    },
    Special {
        effects: &["voltage_limit"],
        needs: Needs::Rover,
        text: "drive under load with the wheel speeds recorded beside their commands: a limited supply lets them sag",
    },
    Special {
        effects: &["sensor_lag"],
        needs: Needs::Rover,
        text: "start and stop in steps: a lag shows in transients only",
    },
    Special {
        effects: &["suspension_friction"],
        needs: Needs::Joints,
        text: "drive over a step on a hard floor and back: friction of the joints shows as hysteresis",
    },
    Special {
        effects: &["slope_strength"],
        needs: Needs::Rover,
        text: "drive up and down two slopes of different steepness on the same soil, each after a level stretch",
    },
    Special {
        effects: &["slip_sinkage", "bulldozing", "grousers", "rim_adhesion"],
        needs: Needs::Plate,
        text: SOIL_TEST,
    },
];

/// What a test of the soil is good for.
pub(crate) const SOIL_TEST: &str = "test the soil with a plate and a shear ring and give k_phi, n, cohesion and friction as priors: a calibration then no longer absorbs the effect";

/// What a rig can do.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Rig {
    pub kind: Kind,
    pub joints: bool,
    /// Whether a test of the soil would tell something new.
    pub untested_soil: bool,
}

impl Rig {
    /// The rig on which an experiment was made.
    pub fn of(problem: &Problem) -> Self {
        let soil = |name: &str| name.starts_with("soil.");
        let free = problem.base.iter().any(|free| free.variable.role == Role::Calibrated && soil(&free.variable.name));
        let tested = problem.experiment.priors.keys().any(|name| soil(name));
        Self {
            kind: problem.experiment.kind,
            joints: !problem.known.rover.links.is_empty(),
            untested_soil: free && !tested,
        }
    }

    /// Whether it has what an experiment needs.
    pub fn can(&self, needs: Needs) -> bool {
        match needs {
            Needs::Carriage => self.kind == Kind::SingleWheel,
            Needs::Rover => self.kind == Kind::Traverse,
            Needs::Joints => self.kind == Kind::Traverse && self.joints,
            Needs::Plate => self.untested_soil,
        }
    }
}

/// An experiment that this rig can make and that shows `effect` apart from `other` (or from the calibration where there is
/// no other).
pub(crate) fn special(rig: &Rig, effect: &str, other: Option<&str>) -> Option<&'static str> {
    let apart = |effects: &[&str]| effects.contains(&effect) && other.is_none_or(|other| !effects.contains(&other));
    let both = |effects: &[&str]| effects.contains(&effect) && other.is_some_and(|other| effects.contains(&other));
    let find = |fits: &dyn Fn(&[&str]) -> bool| {
        SPECIAL.iter().find(|special| rig.can(special.needs) && fits(special.effects)).map(|special| special.text)
    };
    // An experiment made for the very pair comes first.
    find(&both).or_else(|| find(&apart))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effects::EFFECTS;

    const CARRIAGE: Rig = Rig { kind: Kind::SingleWheel, joints: false, untested_soil: true };
    const ROVER: Rig = Rig { kind: Kind::Traverse, joints: false, untested_soil: true };

    #[test]
    fn property_a_rig_is_asked_for_nothing_that_it_cannot_do() {
        for (id, _) in EFFECTS {
            let words = special(&CARRIAGE, id, None).unwrap_or_default();
            assert!(!words.contains("rover") && !words.contains("wheel by wheel"), "{id}: {words}");
            let words = special(&ROVER, id, None).unwrap_or_default();
            assert!(!words.contains("carriage"), "{id}: {words}");
        }
        for id in ["multi_pass", "tether", "soft_patch", "pitch_bias", "sensor_lag", "winding_heat"] {
            assert_eq!(special(&CARRIAGE, id, None), None, "a carriage lacks {id} by its nature");
            assert!(special(&ROVER, id, None).is_some(), "{id}");
        }
        assert_eq!(special(&ROVER, "suspension_friction", None), None);
        assert!(special(&Rig { joints: true, ..ROVER }, "suspension_friction", None).is_some());
    }

    #[test]
    fn property_a_tested_soil_is_not_tested_again() {
        let tested = Rig { untested_soil: false, ..CARRIAGE };
        for (id, _) in EFFECTS {
            assert!(special(&tested, id, None).is_none_or(|words| words != SOIL_TEST), "{id}");
        }
        assert_eq!(special(&CARRIAGE, "slip_sinkage", None), Some(SOIL_TEST));
    }

    #[test]
    fn property_the_table_names_effects_of_the_library() {
        // An odometer's scale is a parameter of an effect in models that have one.
        let known = |id: &&&str| EFFECTS.iter().any(|(own, _)| own == *id) || **id == "odometry_scale";
        let strange: Vec<_> = SPECIAL.iter().flat_map(|special| special.effects).filter(|id| !known(id)).collect();
        assert!(strange.is_empty(), "{strange:?}");
    }
}
