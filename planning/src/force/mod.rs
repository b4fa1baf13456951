//! The forces between wheels and ground, (A.7)-(A.13): whether some hold the robot and drive it on, with how much to spare.
//!
//! Unknown are normal force N, traction T and lateral force L of each wheel. They balance weight and thrust (A.7), and, beyond the
//! thesis, the moments about every passive joint, without which a bogie would be held by nothing. They are bounded by contact
//! N >= 0 (A.9), by the drives |T| r <= tau (A.10) and by the soil's strength sqrt(T^2 + L^2) <= A c + N tan phi, which holds
//! (A.11)-(A.13) together: soil that carries traction carries that much less sideways. With errata 12 the limit is that of the
//! contact, A c + N tan phi. All of it is convex: a cone of second order for each wheel.

mod limits;
mod programme;
mod volume;

pub use limits::{Shear, ShearError};
pub use programme::{ForceError, Forces, Programme};
pub use volume::SolutionSpace;

use nalgebra::Vector3;

/// What acts on the robot beside the ground.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Load {
    /// Gravity, m/s^2, along -z.
    pub gravity: f64,
    /// Force at the centre of mass, in the world, N: of a manipulator, a tool, a tether.
    pub force: Vector3<f64>,
    /// Moment, in the world, N m.
    pub moment: Vector3<f64>,
}

impl Default for Load {
    fn default() -> Self {
        Self { gravity: 9.81, force: Vector3::zeros(), moment: Vector3::zeros() }
    }
}

/// How lateral forces come about.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Lateral {
    /// Wheels give sideways like equal springs, so that the lateral forces follow from the body's small sideways shift and turn:
    /// a drive cannot choose them (Hacot 1998, by appendix A).
    #[default]
    Compliant,
    /// Any that the soil bears.
    Free,
}

/// Which equations of equilibrium hold.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Equilibrium {
    /// Of the whole and about every passive joint.
    #[default]
    Jointed,
    /// Of the whole only, as (A.7): the suspension is taken for rigid.
    Rigid,
}

/// What the analysis assumes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Assumptions {
    /// Lateral forces.
    pub lateral: Lateral,
    /// Equilibrium.
    pub equilibrium: Equilibrium,
}
