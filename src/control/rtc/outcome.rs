//! What an optimisation has found.

use super::Criterion;
#[cfg(doc)]
use super::Found;
use crate::snapshot::{Moving, Reader, SnapshotError, Writer, load_grown, loaded, moving_code};

/// How a wheel stands, as the controller sees it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Footing {
    /// Its load is over the minimum.
    #[default]
    Loaded,
    /// Its load is the minimum (4.13): it is about to lift off.
    Light,
    /// It is off the ground: its speed ran away under next to no torque. Its loop holds its speed, the others carry.
    Lifted,
}

moving_code!(Footing, "a footing" {
    Footing::Loaded => 0 => Footing::Loaded,
    Footing::Light => 1 => Footing::Light,
    Footing::Lifted => 2 => Footing::Lifted,
});

/// What the last optimisation found.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct Outcome {
    /// What was optimised (4.11).
    pub criterion: Criterion,
    /// Whether the forces balance the wanted body force; otherwise they are the nearest admissible ones.
    pub feasible: bool,
    /// Whether the forces are the criterion's optimum; see [`Found::optimal`].
    pub optimal: bool,
    /// Value of the criterion: P in W (4.10) or R (4.5).
    pub objective: f64,
    /// x = [T_1, N_1, .., T_n, N_n]: tractive and normal forces, N.
    pub forces: Vec<f64>,
    /// The wanted body force f_s: N, N, N m.
    pub body_force: [f64; 3],
    /// f_s - G x: what of the body force is missing; N, N, N m.
    pub shortfall: [f64; 3],
    /// The same about every passive joint, N m.
    pub joint_shortfall: Vec<f64>,
    /// How every wheel stands.
    pub footing: Vec<Footing>,
    /// What the wheels' speed loops add to the torques r T_i, N m.
    pub trim: Vec<f64>,
    /// Linear programs of the traction search.
    pub steps: usize,
}

impl Moving for Outcome {
    fn save(&self, to: &mut Writer) {
        let Self {
            criterion,
            feasible,
            optimal,
            objective,
            forces,
            body_force,
            shortfall,
            joint_shortfall,
            footing,
            trim,
            steps,
        } = self;
        criterion.save(to);
        (*feasible, *optimal).save(to);
        objective.save(to);
        forces.save(to);
        (*body_force, *shortfall).save(to);
        joint_shortfall.save(to);
        footing.save(to);
        trim.save(to);
        steps.save(to);
    }

    fn load(&mut self, from: &mut Reader) -> Result<(), SnapshotError> {
        self.criterion.load(from)?;
        (self.feasible, self.optimal) = loaded(from)?;
        self.objective.load(from)?;
        load_grown(&mut self.forces, from)?;
        (self.body_force, self.shortfall) = loaded(from)?;
        load_grown(&mut self.joint_shortfall, from)?;
        load_grown(&mut self.footing, from)?;
        load_grown(&mut self.trim, from)?;
        self.steps.load(from)
    }
}
