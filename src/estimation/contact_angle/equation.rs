//! The kinematic equations (2.29) and (2.30) at one state, with their derivatives.

use super::filter::{ALPHA, GAMMA, SPEED, State};
use nalgebra::Matrix2;

/// The points' part of a kinematic equation: its value, derivative, and second derivatives in (v, gamma - alpha).
pub(super) struct Equation {
    pub value: f64,
    pub row: State,
    pub bends: [Matrix2<f64>; 2],
}

impl Equation {
    /// Of (2.30) where `turning`, of (2.29) otherwise.
    pub fn of(x: &State, turning: bool) -> Self {
        let mut equation = Self { value: 0.0, row: State::zeros(), bends: [Matrix2::zeros(); 2] };
        for k in [0, 1] {
            let (speed, (sin, cos)) = (x[SPEED[k]], (x[GAMMA[k]] - x[ALPHA]).sin_cos());
            // v sin or v cos: without the v, its derivative in the angle, and the sign with which it counts.
            let (part, turned) = if turning { (sin, cos) } else { (cos, -sin) };
            let sign = if turning == (k == 1) { 1.0 } else { -1.0 };
            equation.value += sign * speed * part;
            equation.row[SPEED[k]] = sign * part;
            equation.row[GAMMA[k]] = sign * speed * turned;
            equation.row[ALPHA] -= sign * speed * turned;
            equation.bends[k] = Matrix2::new(0.0, sign * turned, sign * turned, -sign * speed * part);
        }
        equation
    }
}
