//! Wheel loads from the quasi-static balance (2.3.2), with measured torques and contact angles.
//!
//! The forces at wheel k are N along the ground's normal n and T/r - rho N along its tangent t: the gross thrust that
//! the torque makes less a resistance that is the same share rho of every load. Weight, moments and the free joints
//! then give
//!
//! ```text
//! sum F_z = m g,    sum (p x F) + T = moment of the weights,    the same for the wheels beyond each joint,
//! ```
//!
//! linear in the loads, and sum F_x = 0 gives rho; a few passes settle both. A rover with more wheels than equations
//! gets the loads of least norm: on one rigid body they vary linearly along it, as over an elastic ground.

use super::super::EstimationError;
use super::kinematics::{MAX_LINKS, Posture, body_of};
use crate::control::Nominal;
use crate::linear::{Factors, Matrix, Vector, zeros};
use crate::signals::Measurement;
use crate::vehicle::MAX_WHEELS;

/// Passes over loads and resistance; the resistance acts on the loads with the small lever of the wheels' heights.
const PASSES: usize = 4;

/// Equations: force, moment, and one a joint.
const MAX_EQUATIONS: usize = 2 + MAX_LINKS;

/// Masses and centres of mass of the bodies, joints at zero.
#[derive(Clone, Debug, PartialEq)]
struct Masses {
    mass: [f64; MAX_LINKS + 1],
    centre: [[f64; 2]; MAX_LINKS + 1],
}

impl Masses {
    fn of(nominal: &Nominal) -> Self {
        let (mut mass, mut centre) = ([0.0; MAX_LINKS + 1], [[0.0; 2]; MAX_LINKS + 1]);
        mass[0] = nominal.mass;
        let mut moment = nominal.centre_of_mass.map(|c| c * nominal.mass);
        for (j, link) in nominal.links.iter().enumerate() {
            mass[j + 1] = link.mass;
            centre[j + 1] = [link.centre_of_mass_x, link.centre_of_mass_z];
            mass[0] -= link.mass;
            moment[0] -= link.mass * link.centre_of_mass_x;
            moment[1] -= link.mass * link.centre_of_mass_z;
        }
        centre[0] = moment.map(|m| m / mass[0]);
        Self { mass, centre }
    }
}

/// The balance of one rover.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct QuasiStatic {
    masses: Masses,
}

impl QuasiStatic {
    /// The balance of a rover that has been checked.
    pub fn new(nominal: &Nominal) -> Self {
        Self { masses: Masses::of(nominal) }
    }

    /// Loads along the normals, N; those beyond the rover's wheels are 0.
    pub fn loads(
        &self,
        nominal: &Nominal,
        posture: &Posture,
        measured: &Measurement,
    ) -> Result<[f64; MAX_WHEELS], EstimationError> {
        let mut loads = [0.0; MAX_WHEELS];
        let mut resistance = 0.0;
        for _ in 0..PASSES {
            loads = self.at_resistance(nominal, posture, measured, resistance)?;
            let (mut along, mut carried) = (0.0, 0.0);
            for (load, wheel) in loads.iter().zip(&measured.wheels) {
                let (sin, cos) = wheel.contact_angle.sin_cos();
                along += wheel.torque / nominal.wheel.radius * cos - load * sin;
                carried += load * cos;
            }
            resistance = along / carried;
        }
        if loads.iter().all(|load| load.is_finite()) {
            Ok(loads)
        } else {
            Err(EstimationError::Undetermined { what: "loads" })
        }
    }

    /// Loads of least norm with the resistance `rho`.
    fn at_resistance(
        &self,
        nominal: &Nominal,
        posture: &Posture,
        measured: &Measurement,
        rho: f64,
    ) -> Result<[f64; MAX_WHEELS], EstimationError> {
        let equations = 2 + nominal.links.len();
        let mut rows = [[0.0; MAX_WHEELS]; MAX_EQUATIONS];
        let mut right: Vector<f64> = zeros();
        right[0] = nominal.weight();
        for (body, placed) in posture.bodies.iter().enumerate().take(nominal.links.len() + 1) {
            let centre = placed.carry(self.masses.centre[body]).0;
            let weight = self.masses.mass[body] * nominal.gravity;
            // Moments nose up: a weight ahead of the pivot turns the nose down.
            for_each_balance(nominal, body, |row, pivot| right[row] += weight * (centre[0] - pivot[0]), posture);
        }
        for (k, wheel) in measured.wheels.iter().enumerate() {
            let (sin, cos) = wheel.contact_angle.sin_cos();
            let by_load = [-sin - rho * cos, cos - rho * sin];
            let thrust = wheel.torque / nominal.wheel.radius;
            let by_thrust = [thrust * cos, thrust * sin];
            rows[0][k] = by_load[1];
            right[0] -= by_thrust[1];
            let centre = posture.centres[k];
            let add = |row: usize, pivot: [f64; 2]| {
                let lever = [centre[0] - pivot[0], centre[1] - pivot[1]];
                rows[row][k] = lever[0] * by_load[1] - lever[1] * by_load[0];
                right[row] -= lever[0] * by_thrust[1] - lever[1] * by_thrust[0] + wheel.torque;
            };
            for_each_balance(nominal, body_of(nominal, k), add, posture);
        }
        least_norm(&rows, &right, equations, nominal.wheels())
    }
}

/// Calls `f` with the row and pivot of every moment balance in which `body` takes part: the whole rover's, and that of
/// every joint between it and the chassis.
fn for_each_balance(nominal: &Nominal, body: usize, mut f: impl FnMut(usize, [f64; 2]), posture: &Posture) {
    f(1, [0.0, 0.0]);
    let mut beyond = body;
    while beyond > 0 {
        f(1 + beyond, posture.bodies[beyond].origin);
        beyond = nominal.links[beyond - 1].parent;
    }
}

/// The shortest solution of rows x = right.
fn least_norm(
    rows: &[[f64; MAX_WHEELS]; MAX_EQUATIONS],
    right: &Vector<f64>,
    equations: usize,
    wheels: usize,
) -> Result<[f64; MAX_WHEELS], EstimationError> {
    let mut gram: Matrix<f64> = [zeros(); 8];
    for i in 0..equations {
        for j in 0..equations {
            gram[i][j] = (0..wheels).map(|k| rows[i][k] * rows[j][k]).sum();
        }
    }
    let factors = Factors::new(&gram, equations).ok_or(EstimationError::Undetermined { what: "loads" })?;
    let multipliers = factors.solve(right);
    let mut x = [0.0; MAX_WHEELS];
    for (k, value) in x.iter_mut().enumerate().take(wheels) {
        *value = (0..equations).map(|i| rows[i][k] * multipliers[i]).sum();
    }
    Ok(x)
}
