//! One instant's optimisation problem: the balance (4.3) and the constraints (4.13), (4.14), (4.16).

use super::distribution::Distribution;
use super::solver::Rows;
use super::strength::contact_area;
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
    /// Largest tractive force of a drive, tau_max / r (4.14; wheel side, errata 9), N; `None` without limit.
    pub drive_limit: Option<f64>,
    /// Usable part of tan phi: strength that grows with the load (4.16, errata 12), dimensionless.
    pub friction: f64,
    /// Usable part of A_i c: strength that does not (4.16, errata 12), N, one a wheel.
    pub adhesion: Vec<f64>,
    /// Loads of a rover at rest, from which the contact areas follow, N, one a wheel.
    pub expected_loads: Vec<f64>,
    /// Units in which the optimiser counts: force, N, and length, m.
    unit: (f64, f64),
    /// Room for the least-norm solution.
    forces: Vec<f64>,
}

impl Problem {
    /// Constraints of the nominal rover: minimum load in N, and the share `margin` of the soil's strength
    /// that is kept in reserve.
    #[must_use]
    pub fn new(nominal: &Nominal, minimum_load: f64, margin: f64) -> Self {
        let wheels = nominal.wheels();
        Self {
            distribution: Distribution::new(wheels),
            minimum_load,
            drive_limit: nominal.torque_limit().map(|torque| torque / nominal.wheel.radius),
            friction: (1.0 - margin) * nominal.soil.friction_angle.tan(),
            adhesion: vec![0.0; wheels],
            expected_loads: vec![0.0; wheels],
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

    /// Units of the three rows of the balance in the optimiser: N, N, N m.
    #[must_use]
    pub fn row_units(&self) -> [f64; 3] {
        let (force, length) = self.unit;
        [force, force, force * length]
    }

    /// Estimates the loads by the least-norm forces that carry the weight alone, kept at the minimum load
    /// at least. The wanted acceleration stays out: strength must not grow with what is asked for.
    ///
    /// # Errors
    /// [`ControlError::Singular`] where all contact points coincide.
    pub fn expect_loads(&mut self, pitch: f64) -> Result<(), ControlError> {
        let (weight, length) = self.unit;
        let carried = self.distribution.least_norm([0.0, weight, 0.0], length, &mut self.forces);
        carried.ok_or(ControlError::Singular { pitch })?;
        for (wheel, load) in self.expected_loads.iter_mut().enumerate() {
            *load = self.forces[load_of(wheel)].max(self.minimum_load);
        }
        Ok(())
    }

    /// Renews the usable adhesion (1 - margin) A_i c from the expected loads by (4.18).
    pub fn renew_adhesion(&mut self, nominal: &Nominal, margin: f64) {
        for (adhesion, &load) in self.adhesion.iter_mut().zip(&self.expected_loads) {
            let area = contact_area(&nominal.soil, &nominal.wheel, load);
            *adhesion = (1.0 - margin) * area * nominal.soil.cohesion;
        }
    }

    /// Largest tractive force that ground and drive allow wheel `wheel` under the load `load` (N), N.
    #[must_use]
    pub fn traction_limit(&self, wheel: usize, load: f64) -> f64 {
        let strength = self.adhesion[wheel] + self.friction * load;
        self.drive_limit.map_or(strength, |limit| limit.min(strength))
    }

    /// Writes G x + slack = f_s, in the optimiser's units: the unknowns after the forces are slack of the
    /// first `slacks` rows, and the horizontal force is asked for within `limit` weights.
    pub(super) fn write_balance(&self, rows: &mut Rows, slacks: usize, limit: f64) {
        let (force, length) = self.unit;
        for (row, scale) in [1.0, 1.0, length].into_iter().enumerate() {
            let wanted = self.distribution.body_force[row] / (force * scale);
            rows.row(if row == 0 { wanted.clamp(-limit, limit) } else { wanted });
            for (wheel, contact) in self.distribution.contacts.iter().enumerate() {
                rows.term(traction_of(wheel), contact.traction_column()[row] / scale);
                rows.term(load_of(wheel), contact.load_column()[row] / scale);
            }
            if row < slacks {
                rows.term(2 * self.wheels() + row, 1.0);
            }
        }
    }

    /// Writes (4.13), (4.14) and (4.16), in the optimiser's units.
    pub(super) fn write_limits(&self, rows: &mut Rows) {
        let unit = self.force_unit();
        for wheel in 0..self.wheels() {
            rows.row(-self.minimum_load / unit).term(load_of(wheel), -1.0); // (4.13)
            for sign in [1.0, -1.0] {
                let strength = rows.row(self.adhesion[wheel] / unit); // (4.16)
                strength.term(traction_of(wheel), sign).term(load_of(wheel), -self.friction);
                if let Some(limit) = self.drive_limit {
                    rows.row(limit / unit).term(traction_of(wheel), sign); // (4.14)
                }
            }
        }
    }

    /// Largest ratio |T_i| / N_i of `forces` = x (4.5).
    #[must_use]
    pub fn ratio(&self, forces: &[f64]) -> f64 {
        forces.chunks_exact(2).map(|pair| pair[0].abs() / pair[1]).fold(0.0, f64::max)
    }
}
