//! What an optimisation has found.

use super::{Criterion, Found, Problem, load_of};
use crate::control::Nominal;
use crate::snapshot::{Moving, Reader, SnapshotError, Writer, load_grown, loaded, moving_code};

/// Load over the minimum, of the weight, up to which a wheel counts as about to lift off.
const LIGHT: f64 = 1e-6;

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
    /// Whether the forces balance the wanted body force; otherwise they are the nearest admissible ones or, with wheel-speed loops, may
    /// balance it on the linearised soil only, or are those of the command before where the optimiser gave up.
    pub feasible: bool,
    /// Whether the forces are the criterion's optimum; see [`Found::optimal`].
    pub optimal: bool,
    /// P in W (4.10) where power is the criterion, or R (4.5).
    pub objective: f64,
    /// x = [T_1, N_1, .., T_n, N_n]: tractive and normal forces, N.
    pub forces: Vec<f64>,
    /// The wanted body force f_s: N, N, N m.
    pub body_force: [f64; 3],
    /// f_s - G x: what of the body force is missing; N, N, N m. Of the first the rover does not accelerate.
    pub shortfall: [f64; 3],
    /// The same about every passive joint, for the acceleration that is left, N m.
    pub joint_shortfall: Vec<f64>,
    /// How every wheel stands.
    pub footing: Vec<Footing>,
    /// What the wheels' speed loops add to the torques r T_i, N m.
    pub trim: Vec<f64>,
    /// Linear programs of the traction search.
    pub steps: usize,
}

impl Outcome {
    /// Takes the forces x of a problem over, reusing its memory; `torques` are the commanded ones, N m.
    pub(super) fn renew(
        &mut self,
        nominal: &Nominal,
        problem: &Problem,
        forces: &[f64],
        criterion: Criterion,
        found: Found,
        torques: &[f64],
    ) {
        let radius = nominal.wheel.radius;
        self.forces.clear();
        self.forces.extend_from_slice(forces);
        self.criterion = criterion;
        (self.feasible, self.optimal, self.steps) = (found.feasible, found.optimal, found.steps);
        self.objective = match criterion {
            // P = sum R r^2 / (K_t^2 gear^2) T_i^2 (4.10), W.
            Criterion::Power | Criterion::ElectricalPower => {
                forces.iter().step_by(2).map(|traction| nominal.winding_power(radius * traction)).sum()
            }
            Criterion::Traction => problem.ratio(forces),
        };
        self.body_force = problem.distribution.body_force;
        self.shortfall = std::array::from_fn(|row| problem.shortfall(row, forces));
        self.joint_shortfall.clear();
        self.joint_shortfall.extend((3..problem.rows()).map(|row| problem.shortfall(row, forces)));
        self.footing.clear();
        self.footing.extend((0..problem.wheels()).map(|wheel| footing(problem, forces, wheel)));
        self.trim.clear();
        let pairs = torques.iter().zip(forces.iter().step_by(2));
        self.trim.extend(pairs.map(|(torque, traction)| torque - radius * traction));
    }
}

fn footing(problem: &Problem, forces: &[f64], wheel: usize) -> Footing {
    let over = forces[load_of(wheel)] - problem.minimum_load;
    match problem.lifted[wheel] {
        true => Footing::Lifted,
        false if over <= LIGHT * problem.force_unit() => Footing::Light,
        false => Footing::Loaded,
    }
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
