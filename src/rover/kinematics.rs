//! Where the bodies of a rover are and how they move: a tree of links on a chassis, in the plane.
//!
//! Generalised coordinates: x, z and pitch of the chassis, then one angle a passive joint (nose up
//! positive, relative to the parent). All positions of the model are given from the chassis reference
//! point with every angle at zero.

use super::Rover;
use crate::linear::{Vector, zeros};
use crate::scalar::{LaneAccess, Scalar, lanes};
use crate::snapshot::Moving;

/// A body's place at one instant.
#[derive(Clone, Copy, Debug, Moving, LaneAccess)]
pub(crate) struct Frame<S> {
    /// Chassis reference point, or the joint that carries a link.
    origin: [S; 2],
    /// The same point with all angles at zero.
    reference: [S; 2],
    cos: S,
    sin: S,
    /// Angular rate, nose up.
    rate: S,
    /// Acceleration of the origin that is left when all generalised accelerations are zero.
    bias: [S; 2],
}

/// A point fixed on a body: place, bias acceleration, and its Jacobian in the generalised coordinates.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Point<S> {
    pub position: [S; 2],
    pub bias: [S; 2],
    pub jacobian_x: Vector<S>,
    pub jacobian_z: Vector<S>,
}

/// Bodies of a rover at one instant; index 0 is the chassis, k is link k.
#[derive(Clone, Debug, Moving, LaneAccess)]
pub(crate) struct Frames<S> {
    frames: Vec<Frame<S>>,
}

#[lanes]
impl<S: Scalar> Frames<S> {
    pub fn new(rover: &Rover<S>) -> Self {
        let o = S::from(0.0);
        let frame = Frame { origin: [o; 2], reference: [o; 2], cos: o, sin: o, rate: o, bias: [o; 2] };
        Self { frames: vec![frame; 1 + rover.links.len()] }
    }

    /// Places all bodies.
    pub fn update(&mut self, rover: &Rover<S>, position: &[S], rate: &[S]) {
        let zero = S::from(0.0);
        let (sin, cos) = position[2].sine_cosine();
        self.frames[0] = Frame {
            origin: [position[0], position[1]],
            reference: [zero; 2],
            cos,
            sin,
            rate: rate[2],
            bias: [zero; 2],
        };
        let mut angles = [zero; crate::vehicle::MAX_COORDINATES];
        angles[0] = position[2];
        for (j, link) in rover.links.iter().enumerate() {
            let reference = [link.parameters.x, link.parameters.z];
            let parent = self.frames[link.parent];
            let (origin, bias) = parent.carry(reference);
            angles[j + 1] = angles[link.parent] + position[3 + j];
            let (sin, cos) = angles[j + 1].sine_cosine();
            self.frames[j + 1] = Frame { origin, reference, cos, sin, rate: parent.rate + rate[3 + j], bias };
        }
    }

    /// The point of `body` that lies at `reference` when all angles are zero.
    pub fn point(&self, rover: &Rover<S>, body: usize, reference: [S; 2]) -> Point<S> {
        let (position, bias) = self.frames[body].carry(reference);
        let (mut jacobian_x, mut jacobian_z) = (zeros(), zeros());
        jacobian_x[0] = S::from(1.0);
        jacobian_z[1] = S::from(1.0);
        for_each_turn(rover, body, |turning, coordinate| {
            let pivot = self.frames[turning].origin;
            // Nose up turns (dx, dz) into (-dz, dx).
            jacobian_x[coordinate] = pivot[1] - position[1];
            jacobian_z[coordinate] = position[0] - pivot[0];
        });
        Point { position, bias, jacobian_x, jacobian_z }
    }

    /// Angular rate of a body, nose up, rad/s.
    pub fn rate(&self, body: usize) -> S {
        self.frames[body].rate
    }
}

#[lanes]
impl<S: Scalar> Frame<S> {
    /// Place and bias acceleration of the point that lies at `reference` when all angles are zero.
    fn carry(&self, reference: [S; 2]) -> ([S; 2], [S; 2]) {
        let (dx, dz) = (reference[0] - self.reference[0], reference[1] - self.reference[1]);
        let (x, z) = (self.cos * dx - self.sin * dz, self.sin * dx + self.cos * dz);
        let centripetal = self.rate * self.rate;
        ([self.origin[0] + x, self.origin[1] + z], [self.bias[0] - centripetal * x, self.bias[1] - centripetal * z])
    }
}

/// Jacobian of a body's angle: 1 for the pitch and for every joint between it and the chassis.
#[lanes]
pub(crate) fn turn_jacobian<S: Scalar>(rover: &Rover<S>, body: usize) -> Vector<S> {
    let mut jacobian = zeros();
    for_each_turn(rover, body, |_, coordinate| jacobian[coordinate] = S::from(1.0));
    jacobian
}

/// Calls `f` with every body from `body` down to the chassis and the coordinate that turns it.
#[lanes]
fn for_each_turn<S>(rover: &Rover<S>, body: usize, mut f: impl FnMut(usize, usize)) {
    let mut turning = body;
    loop {
        f(turning, 2 + turning);
        if turning == 0 {
            break;
        }
        turning = rover.links[turning - 1].parent;
    }
}

#[lanes]
impl<S: Scalar> Point<S> {
    /// Jacobian of the component along `direction` in the first `n` coordinates.
    pub fn along(&self, direction: [S; 2], n: usize) -> Vector<S> {
        let mut row = zeros();
        for (i, entry) in row.iter_mut().enumerate().take(n) {
            *entry = direction[0] * self.jacobian_x[i] + direction[1] * self.jacobian_z[i];
        }
        row
    }
}
