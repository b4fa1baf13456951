//! Experiments that the model is not asked about, because what separates there is known beforehand: a single cause acts.
//! Each effect advises its own, see [`Advice`](crate::effects::Advice).

use crate::diagnosis::problem::Problem;
use crate::effects::{Advice, Equipment};
use crate::measurement::Kind;
use crate::model::Model;
use bekker_modeldescription::Role;

/// What a rig can do, and the effects that may act on it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Rig<'a> {
    pub kind: Kind,
    pub joints: bool,
    /// Whether a test of the soil would tell something new.
    pub untested_soil: bool,
    pub model: &'a Model,
}

impl<'a> Rig<'a> {
    /// The rig on which an experiment was made.
    pub fn of(problem: &'a Problem) -> Self {
        let soil = |name: &str| name.starts_with("soil.");
        let free = problem.base.iter().any(|free| free.variable.role == Role::Calibrated && soil(&free.variable.name));
        let tested = problem.joint.is_some() || problem.experiment.priors.keys().any(|name| soil(name));
        Self {
            kind: problem.experiment.kind,
            joints: !problem.known.rover.links.is_empty(),
            untested_soil: free && !tested && !problem.experiment.kind.is_soil_test(),
            model: &problem.known,
        }
    }

    /// Whether it has what an experiment takes.
    pub fn has(&self, equipment: Equipment) -> bool {
        match equipment {
            Equipment::Carriage => self.kind == Kind::SingleWheel,
            Equipment::Rover => self.kind == Kind::Traverse,
            Equipment::JointedRover => self.kind == Kind::Traverse && self.joints,
            Equipment::SoilTest => self.untested_soil,
            Equipment::Plate => self.kind == Kind::PlateSinkage,
            Equipment::ShearBox => self.kind == Kind::Shear,
        }
    }

    /// What an effect advises, whatever it takes; nothing where the effect is given as an expression.
    fn advice(&self, effect: &str) -> &'static [Advice] {
        self.model.facts_of(effect).map_or(&[], |facts| facts.advice)
    }
}

/// An experiment that this rig can make and that shows `effect` apart from `other` (or from the calibration where there is
/// no other).
pub(crate) fn special(rig: &Rig, effect: &str, other: Option<&str>) -> Option<&'static str> {
    let others = other.map_or(&[][..], |other| rig.advice(other));
    let possible = || rig.advice(effect).iter().filter(|advice| rig.has(advice.equipment));
    // An experiment made for the very pair comes first.
    let both = possible().find(|advice| others.contains(advice));
    both.or_else(|| possible().next()).map(|advice| advice.text)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effects::{EFFECTS, SOIL_TEST};
    use crate::rover::Rover;

    fn carriage(model: &Model) -> Rig<'_> {
        Rig { kind: Kind::SingleWheel, joints: false, untested_soil: true, model }
    }

    fn rover(model: &Model) -> Rig<'_> {
        Rig { kind: Kind::Traverse, ..carriage(model) }
    }

    #[test]
    fn property_a_rig_is_asked_for_nothing_that_it_cannot_do() {
        let model = Model::new("", Rover::two_wheeled());
        let (carriage, rover) = (carriage(&model), rover(&model));
        for (id, _) in EFFECTS {
            let words = special(&carriage, id, None).unwrap_or_default();
            assert!(!words.contains("rover") && !words.contains("wheel by wheel"), "{id}: {words}");
            let words = special(&rover, id, None).unwrap_or_default();
            assert!(!words.contains("carriage"), "{id}: {words}");
        }
        for id in ["multi_pass", "tether", "soft_patch", "pitch_bias", "sensor_lag", "winding_heat"] {
            assert_eq!(special(&carriage, id, None), None, "a carriage lacks {id} by its nature");
            assert!(special(&rover, id, None).is_some(), "{id}");
        }
        assert_eq!(special(&rover, "suspension_friction", None), None);
        assert!(special(&Rig { joints: true, ..rover }, "suspension_friction", None).is_some());
    }

    #[test]
    fn property_a_tested_soil_is_not_tested_again() {
        let model = Model::new("", Rover::two_wheeled());
        let tested = Rig { untested_soil: false, ..carriage(&model) };
        for (id, _) in EFFECTS {
            assert!(special(&tested, id, None).is_none_or(|words| words != SOIL_TEST.text), "{id}");
        }
        assert_eq!(special(&carriage(&model), "slip_sinkage", None), Some(SOIL_TEST.text));
    }

    #[test]
    fn property_an_experiment_made_for_a_pair_comes_first() {
        let model = Model::new("", Rover::two_wheeled());
        let text = special(&rover(&model), "centre_of_mass", Some("pitch_bias")).unwrap_or_default();
        assert!(text.contains("heading reversed"), "{text}");
        let text = special(&rover(&model), "centre_of_mass", Some("drag")).unwrap_or_default();
        assert!(text.contains("weigh the rover"), "{text}");
    }
}
