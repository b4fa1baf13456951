//! One instant's optimisation problem: the balance (4.3) and the constraints (4.13), (4.14), (4.16).

use super::distribution::Distribution;
use super::solver::Rows;
use super::strength::Strength;
use crate::control::{ControlError, Nominal};

/// Column of T_i among the unknowns x = [T_1, N_1, .., T_n, N_n].
#[must_use]
pub fn traction_of(wheel: usize) -> usize {
    2 * wheel
}

/// Column of N_i among the unknowns.
#[must_use]
pub fn load_of(wheel: usize) -> usize {
    2 * wheel + 1
}

/// Which contact forces are admissible. Set up once, renewed every control period without allocating.
#[derive(Clone, Debug, PartialEq)]
pub struct Problem {
    /// The balance G x = f_s.
    pub distribution: Distribution,
    /// Least normal force on every wheel (4.13), N.
    pub minimum_load: f64,
    /// Least and largest tractive force of each drive, N: -+ tau_max / r (4.14; wheel side, errata 9), narrower in the last rounds of
    /// RTC with wheel-speed loops; `None` without limit.
    pub drive_limits: Option<Vec<[f64; 2]>>,
    /// Usable strength that grows with the load (4.16), of that load, one a wheel: tan phi by Mohr and Coulomb.
    pub friction: Vec<f64>,
    /// Usable strength that does not, A_i c (4.16), N, one a wheel.
    pub adhesion: Vec<f64>,
    /// Wheels off the ground: the balance knows nothing of their forces.
    pub lifted: Vec<bool>,
    /// Loads of a rover at rest, from which the contact areas follow, N, one a wheel.
    pub expected_loads: Vec<f64>,
    /// Weights (a, b) of a T_i^2/2 + b T_i in the power that is minimised, for T_i in weights, one a wheel; `None` is (4.10),
    /// the same weight on all squares.
    pub costs: Option<Vec<[f64; 2]>>,
    /// Mass of the rover, kg.
    mass: f64,
    /// Units in which the optimiser counts: force, N, and length, m.
    unit: (f64, f64),
    /// Room for the least-norm solution.
    forces: Vec<f64>,
}

impl Problem {
    /// Constraints of the nominal rover, with the minimum load in N.
    #[must_use]
    pub fn new(nominal: &Nominal, minimum_load: f64) -> Self {
        let wheels = nominal.wheels();
        Self {
            distribution: Distribution::new(nominal),
            minimum_load,
            drive_limits: nominal.torque_limit().map(|torque| {
                let limit = torque / nominal.wheel.radius;
                vec![[-limit, limit]; wheels]
            }),
            friction: vec![0.0; wheels],
            adhesion: vec![0.0; wheels],
            lifted: vec![false; wheels],
            expected_loads: vec![0.0; wheels],
            costs: None,
            mass: nominal.mass,
            unit: (nominal.weight(), 0.5 * nominal.base()),
            forces: vec![0.0; 2 * wheels],
        }
    }

    /// Number of wheels.
    #[must_use]
    pub fn wheels(&self) -> usize {
        self.adhesion.len()
    }

    /// Unit of force of the optimiser's unknowns, N: the rover's weight.
    #[must_use]
    pub fn force_unit(&self) -> f64 {
        self.unit.0
    }

    /// Number of rows of the balance.
    #[must_use]
    pub fn rows(&self) -> usize {
        self.distribution.rows()
    }

    /// Unit of row `row` of the balance in the optimiser: N for the first two, N m for moments.
    #[must_use]
    pub fn row_unit(&self, row: usize) -> f64 {
        let (force, length) = self.unit;
        if row < 2 { force } else { force * length }
    }

    /// Estimates the loads by the least-norm forces that carry the weight alone, kept at the minimum load
    /// at least. The wanted acceleration stays out: strength must not grow with what is asked for.
    ///
    /// # Errors
    /// [`ControlError::Singular`] where all contact points coincide, or those of the wheels that a joint carries do.
    pub fn expect_loads(&mut self, nominal: &Nominal, pitch: f64) -> Result<(), ControlError> {
        let carried = self.distribution.carry_weight(nominal, self.unit.1, &mut self.forces);
        carried.ok_or(ControlError::Singular { pitch })?;
        for (wheel, load) in self.expected_loads.iter_mut().enumerate() {
            *load = self.forces[load_of(wheel)].max(self.minimum_load);
        }
        Ok(())
    }

    /// Renews the usable strength, all but the share `margin` of it, at the expected loads.
    pub fn renew_strength(&mut self, nominal: &Nominal, margin: f64, strength: Strength) {
        let wheels = self.adhesion.iter_mut().zip(&mut self.friction);
        for ((adhesion, friction), &load) in wheels.zip(&self.expected_loads) {
            let limit = strength.limit(&nominal.soil, &nominal.wheel, load, 1.0 - margin);
            (*adhesion, *friction) = (limit.adhesion, limit.friction);
        }
    }

    /// Writes G x + slack = f_s, in the optimiser's units: the unknowns after the forces are slack of the
    /// first `slacks` rows, and the horizontal force is asked for within `limit` weights.
    ///
    /// What the horizontal force falls short of, the rover does not accelerate, and the bodies on joints do not either: the
    /// first slack and the cut by `limit` stand in the joints' rows too.
    pub(super) fn write_balance(&self, rows: &mut Rows, slacks: usize, limit: f64) {
        let (force, length) = self.unit;
        let wish = self.distribution.wanted(0) / force;
        let asked = wish.clamp(-limit, limit);
        for row in 0..self.rows() {
            let scale = if row < 2 { 1.0 } else { length };
            let wanted = self.distribution.wanted(row) / (force * scale);
            // Moment about a joint of one weight less of horizontal force on the whole rover.
            let inert = if row < 3 { 0.0 } else { self.distribution.joints[row - 3].inertia / (self.mass * length) };
            match row {
                0 => rows.row(asked),
                1 | 2 => rows.row(wanted),
                _ => rows.row(wanted + inert * (wish - asked)),
            };
            for wheel in 0..self.wheels() {
                let contact = if self.lifted[wheel] { [0.0; 2] } else { self.distribution.coefficients(row, wheel) };
                rows.term(traction_of(wheel), contact[0] / scale).term(load_of(wheel), contact[1] / scale);
            }
            if row < slacks {
                rows.term(2 * self.wheels() + row, 1.0);
            }
            if row >= 3 && slacks > 0 {
                rows.term(2 * self.wheels(), -inert);
            }
        }
    }

    /// Writes (4.13), (4.14) and (4.16), in the optimiser's units.
    pub(super) fn write_limits(&self, rows: &mut Rows) {
        let unit = self.force_unit();
        for wheel in 0..self.wheels() {
            rows.row(-self.minimum_load / unit).term(load_of(wheel), -1.0); // (4.13)
            for (side, sign) in [(1, 1.0), (0, -1.0)] {
                let strength = rows.row(self.adhesion[wheel] / unit); // (4.16)
                strength.term(traction_of(wheel), sign).term(load_of(wheel), -self.friction[wheel]);
                if let Some(limits) = &self.drive_limits {
                    rows.row(sign * limits[wheel][side] / unit).term(traction_of(wheel), sign); // (4.14)
                }
            }
        }
    }

    /// What of the balance `forces` = x leave open, f_s - G x, in the units of
    /// [`wanted`](Distribution::wanted); a joint's for the acceleration that the horizontal force does give.
    #[must_use]
    pub fn shortfall(&self, row: usize, forces: &[f64]) -> f64 {
        self.shortfall_beyond(row, forces, |_| 0.0)
    }

    /// The same where the soil gives `beyond` (of a row) in addition to G x.
    pub(super) fn shortfall_beyond(&self, row: usize, forces: &[f64], beyond: impl Fn(usize) -> f64) -> f64 {
        let missing = |row: usize| self.distribution.wanted(row) - self.distribution.sum(row, forces) - beyond(row);
        match row.checked_sub(3) {
            None => missing(row),
            Some(joint) => missing(row) + self.distribution.joints[joint].inertia * missing(0) / self.mass,
        }
    }

    /// Largest ratio |T_i| / N_i of `forces` = x (4.5).
    #[must_use]
    pub fn ratio(&self, forces: &[f64]) -> f64 {
        forces.chunks_exact(2).map(|pair| pair[0].abs() / pair[1]).fold(0.0, f64::max)
    }
}
