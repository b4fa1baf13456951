//! Which runs can go side by side.

use crate::model::Run;
use crate::rover::Rover;
use crate::signals::Drive;
use bekker_modeldescription::Parameters;

/// What runs side by side must share: everything about which the code branches for all of them at once.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Kind {
    pub(super) drive: Drive,
    profile: std::mem::Discriminant<crate::terrain::Profile>,
    /// Parents of the links, bodies of the wheels.
    tree: Vec<usize>,
    /// For every parameter whether it is 0 or 1, the neutral values of effects and limits.
    neutral: Vec<[bool; 2]>,
}

impl Kind {
    /// The kind of a run; none where it has to go on by itself: bodies of a rigid-body engine, effects of the user's own.
    pub fn of(run: &Run) -> Option<Self> {
        let simulation = run.in_joint_coordinates()?;
        let effects = &simulation.rover().effects;
        let own = effects.custom.iter().next().is_some() || !effects.registered.is_empty();
        (!own).then(|| Self::of_rover(simulation.rover(), run.drive()))
    }

    /// The kind of a rover under this drive. Effects of the user's own, which keep a run out of every group, are not looked at.
    pub fn of_rover(rover: &Rover, drive: Drive) -> Self {
        let mut neutral = Vec::new();
        rover.motor.values(&mut |x| neutral.push([x == 0.0, x == 1.0]));
        rover.effects.values(&mut |x| neutral.push([x == 0.0, x == 1.0]));
        let links = rover.links.iter().map(|link| link.parent);
        let tree = links.chain(rover.wheels.iter().map(|wheel| wheel.body)).collect();
        let profile = std::mem::discriminant(&rover.terrain.profile);
        Self { drive, profile, tree, neutral }
    }
}
