//! Speeds of the wheels' centres over the ground, from the body's speed and the contact angles.

use super::distribution::Distribution;
use crate::control::Nominal;
use crate::vehicle::MAX_COORDINATES;
use nalgebra::{SMatrix, SVector};

/// Weight of the bodies' turning beside the wheels' motion along their normals, which is next to none: chooses among the
/// motions that the contacts allow where these do not determine it.
const REGULAR: f64 = 1e-6;
/// Least speed of a wheel's centre that counts, of the body's, against readings that contradict each other.
const LEAST: f64 = 0.2;
/// The same at most.
const MOST: f64 = 5.0;

/// One wheel's motion for a body speed of 1 m/s forward.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Rolling {
    /// Speed of its centre along the ground, m/s.
    pub along: f64,
    /// Rate at which the body that carries it turns, nose up, rad/s.
    pub turning: f64,
}

/// Writes how each wheel moves where the chassis reference point moves at 1 m/s forward along its path, and no wheel on the
/// ground moves along its normal: least squares over the velocity of the chassis, its pitch rate and the joints' rates.
///
/// The rows of G (4.3) are these velocities too, by virtual work: a force column times the velocities is its power.
pub(super) fn rolling(distribution: &Distribution, nominal: &Nominal, lifted: &[bool], wheels: &mut [Rolling]) {
    let rows = distribution.rows();
    let mut matrix = SMatrix::<f64, MAX_COORDINATES, MAX_COORDINATES>::zeros();
    let length = nominal.base();
    for row in 2..MAX_COORDINATES {
        matrix[(row, row)] = if row < rows { REGULAR * length * length } else { 1.0 };
    }
    let mut add = |v: SVector<f64, MAX_COORDINATES>| matrix += v * v.transpose();
    let column = |wheel: usize, which: usize| {
        SVector::<f64, MAX_COORDINATES>::from_fn(|row, _| {
            if row < rows { distribution.rim_coefficients(row, wheel)[which] } else { 0.0 }
        })
    };
    for wheel in (0..wheels.len()).filter(|&wheel| !lifted[wheel]) {
        add(column(wheel, 1));
    }
    // Velocity of the reference point: (v_x - q p_z, v_z + q p_x), of which the part along the chassis is 1.
    let [px, pz] = distribution.reference();
    let (sin, cos) = distribution.heading();
    let mut forward = SVector::<f64, MAX_COORDINATES>::zeros();
    (forward[0], forward[1], forward[2]) = (cos, sin, sin * px - cos * pz);
    add(forward);
    let Some(motion) = matrix.cholesky().map(|factor| factor.solve(&forward)) else {
        wheels.fill(Rolling { along: 1.0, turning: 0.0 });
        return;
    };
    let speed = (motion[0] - motion[2] * pz).hypot(motion[1] + motion[2] * px);
    for (wheel, rolling) in wheels.iter_mut().enumerate() {
        let axle = |row: usize| distribution.axle_coefficient(row, wheel);
        let along: f64 = (0..rows).map(|row| axle(row) * motion[row]).sum();
        let turning = motion[2]
            + (3..rows).filter(|&row| distribution.joints[row - 3].carries[wheel]).map(|row| motion[row]).sum::<f64>();
        *rolling = Rolling { along: (along / speed).clamp(LEAST, MOST), turning: turning / speed };
    }
}
