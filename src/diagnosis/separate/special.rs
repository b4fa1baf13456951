//! Experiments that the model is not asked about, because what separates there is known beforehand: a single cause acts.
//! Each effect advises its own, see [`Advice`](crate::effects::Advice).

use crate::diagnosis::problem::{Problem, plain_effect};
use crate::effects::{Advice, Equipment};
use crate::measurement::{Experiment, Kind};
use crate::model::Model;
use bekker_modeldescription::Role;

/// What a rig can do, and the effects that may act on it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Rig<'a> {
    /// Kinds of experiments that were made with it.
    pub kinds: Kinds,
    pub joints: bool,
    /// Whether a test of the soil would tell something new.
    pub untested_soil: bool,
    pub model: &'a Model,
}

/// Kinds of experiments, of which a joint one has several.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Kinds([bool; Kind::ALL.len()]);

impl Kinds {
    fn of(experiment: &Experiment) -> Self {
        let parts = experiment.parts.iter().map(|part| part.experiment.kind);
        let made: Vec<Kind> = if experiment.parts.is_empty() { vec![experiment.kind] } else { parts.collect() };
        Self(Kind::ALL.map(|kind| made.contains(&kind)))
    }

    fn has(self, kind: Kind) -> bool {
        Kind::ALL.iter().zip(self.0).any(|(known, made)| *known == kind && made)
    }
}

impl<'a> Rig<'a> {
    /// The rig on which an experiment was made.
    pub fn of(problem: &'a Problem) -> Self {
        let soil = |name: &str| name.starts_with("soil.");
        let free = problem.base.iter().any(|free| free.variable.role == Role::Calibrated && soil(&free.variable.name));
        let (experiment, kinds) = (&*problem.experiment, Kinds::of(&problem.experiment));
        let parts = experiment.parts.iter().map(|part| &part.experiment);
        let known = parts.chain([experiment]).any(|one| one.priors.keys().any(|name| soil(name)));
        let soil_test = Kind::ALL.into_iter().any(|kind| kind.is_soil_test() && kinds.has(kind));
        Self {
            kinds,
            joints: problem.models.iter().any(|model| !model.rover.links.is_empty()),
            untested_soil: free && problem.joint.is_none() && !known && !soil_test,
            model: &problem.known,
        }
    }

    /// Whether it has what an experiment takes.
    pub fn has(&self, equipment: Equipment) -> bool {
        match equipment {
            Equipment::Carriage => self.kinds.has(Kind::SingleWheel),
            Equipment::Rover => self.kinds.has(Kind::Traverse),
            Equipment::JointedRover => self.kinds.has(Kind::Traverse) && self.joints,
            Equipment::SoilTest => self.untested_soil,
            Equipment::Plate => self.kinds.has(Kind::PlateSinkage),
            Equipment::ShearBox => self.kinds.has(Kind::Shear),
        }
    }

    /// What an effect advises, whatever it takes; nothing where the effect is given as an expression.
    fn advice(&self, effect: &str) -> &'static [Advice] {
        self.model.facts_of(plain_effect(effect)).map_or(&[], |facts| facts.advice)
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

    fn only(kind: Kind) -> Kinds {
        Kinds(Kind::ALL.map(|known| known == kind))
    }

    fn carriage(model: &Model) -> Rig<'_> {
        Rig { kinds: only(Kind::SingleWheel), joints: false, untested_soil: true, model }
    }

    fn rover(model: &Model) -> Rig<'_> {
        Rig { kinds: only(Kind::Traverse), ..carriage(model) }
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
        for id in ["multi_pass", "tether", "soft_patch", "pitch_bias", "sensor_lag", "tracking_delay", "winding_heat"] {
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
