//! What the hooks of an effect see and change.

use super::winding_heat::Warming;
use crate::contact::{Forces, Surface};
use crate::motor::{Geared, TorqueRange};
use crate::scalar::{MapScalar, Scalar, lanes};
use crate::soil::Soil;
use crate::wheel::Wheel;
use bekker_modeldescription::Over;

/// Where and how a wheel touches the ground.
#[derive(Clone, Copy, Debug, MapScalar)]
pub struct Place<S = f64> {
    /// Wheel, 0 at the rear.
    pub wheel: usize,
    /// Position of the contact foot along x, m; none on a carriage, whose ground is the same everywhere.
    pub x: Option<S>,
    /// Wheels that have passed this ground, see [`Track`](super::Track); 0 where no effect counts them.
    pub passes: S,
    /// Contact angle, uphill positive, rad.
    pub contact_angle: S,
    /// Slip as far as it is established, see [`crate::contact::Motion::established_slip`].
    pub slip: S,
    /// Slip to which the ground under the wheel is dug: in steady motion the size of the slip, at most 1. It follows the slip with the
    /// length that [`Effect::digging_length`](super::Effect::digging_length) gives; where no effect gives one it has no meaning.
    pub dug_slip: S,
    /// Sinkage of the wheel's undeformed outline, m.
    pub sinkage: S,
    /// Velocity of the wheel centre along the normal, m/s.
    pub normal_velocity: S,
    /// Velocity of the wheel centre along the tangent, m/s.
    pub velocity: S,
}

/// Wheel and soil as one contact sees them; effects may change them.
#[derive(Clone, Copy, Debug)]
pub struct Local<S = f64> {
    /// The wheel.
    pub wheel: Wheel<S>,
    /// The soil under it.
    pub soil: Soil<S>,
    /// How the rim meets the soil.
    pub surface: Surface<S>,
}

#[lanes]
impl<S: Scalar> Local<S> {
    /// A smooth rigid wheel.
    #[must_use]
    pub fn new(wheel: Wheel<S>, soil: Soil<S>) -> Self {
        Self { wheel, soil, surface: Surface::default() }
    }
}

/// Motion of the chassis reference point.
#[derive(Clone, Copy, Debug)]
pub struct BodyMotion<S = f64> {
    /// Position along x since the start, m.
    pub travelled: S,
    /// Velocity along x, m/s.
    pub velocity: S,
}

/// Lists the numbers of a struct, so that it can be taken over to another scalar.
macro_rules! over {
    ($part:ident { $($number:ident),* $(,)? }) => {
        impl<S: Copy, T: Copy> Over<S, T> for $part<S> {
            type Output = $part<T>;

            fn over(&self, f: &dyn Fn(S) -> T) -> $part<T> {
                $part { $($number: f(self.$number)),* }
            }

            fn merge(&mut self, other: &$part<T>, f: &dyn Fn(S, T) -> S) {
                $(self.$number = f(self.$number, other.$number);)*
            }
        }
    };
}

over!(BodyMotion { travelled, velocity });
over!(Forces { normal, drawbar, torque });
over!(Geared { torque, by_torque, by_speed });
over!(Surface {
    exit_ratio,
    arc,
    arm,
    compliance,
    arm_share,
    arc_by_sinkage,
    arc_by_load,
    shear_radius,
    cohesion_gain,
    friction_gain,
    grip,
    rounding,
    resistance,
    lead,
    lead_by_root,
});
over!(TorqueRange { least, most, least_slope, most_slope });
over!(Warming { end, time_constant });

impl<S: Copy, T: Copy> Over<S, T> for Local<S> {
    type Output = Local<T>;

    fn over(&self, f: &dyn Fn(S) -> T) -> Local<T> {
        let (wheel, soil, surface) = (self.wheel.over(f), self.soil.over(f), self.surface.over(f));
        Local { wheel, soil, surface }
    }

    fn merge(&mut self, other: &Local<T>, f: &dyn Fn(S, T) -> S) {
        self.wheel.merge(&other.wheel, f);
        self.soil.merge(&other.soil, f);
        self.surface.merge(&other.surface, f);
    }
}
