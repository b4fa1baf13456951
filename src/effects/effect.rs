//! What an effect is: hooks into the simulation, and what they see.

use crate::contact::{Forces, Surface};
use crate::motor::Motor;
use crate::rover::Body;
use crate::scalar::Scalar;
use crate::signals::{BodySignals, WheelSignals};
use crate::soil::Soil;
use crate::wheel::Wheel;
use bekker_modeldescription::Parameters;

/// Where and how a wheel touches the ground.
#[derive(Clone, Copy, Debug)]
pub struct Place<S = f64> {
    /// Wheel, 0 at the rear.
    pub wheel: usize,
    /// Position of the contact foot along x, m; none on a carriage, whose ground is the same everywhere.
    pub x: Option<S>,
    /// Wheels that have passed this ground, see [`crate::rover::Track`]; 0 where no effect remembers.
    pub passes: S,
    /// Contact angle, uphill positive, rad.
    pub contact_angle: S,
    /// Slip as far as it is established, see [`crate::contact::Motion::established_slip`].
    pub slip: S,
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
    /// Deflection of the wheel along the normal, m: what the outline sinks deeper than the soil.
    pub deflection: S,
}

impl<S: Scalar> Local<S> {
    /// A smooth rigid wheel.
    #[must_use]
    #[cfg_attr(feature = "batch", inline(always))]
    pub fn new(wheel: Wheel<S>, soil: Soil<S>) -> Self {
        Self { wheel, soil, surface: Surface::default(), deflection: S::from(0.0) }
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

/// Torque behind a gear, N m on the wheel's side, with its slopes in the torque before it and in the wheel speed.
#[derive(Clone, Copy, Debug)]
pub struct Geared<S = f64> {
    /// Torque behind the gear.
    pub torque: S,
    /// Slope in the torque before the gear.
    pub by_torque: S,
    /// Slope in the wheel speed, N m s/rad.
    pub by_speed: S,
}

/// Hooks of an effect into the simulation; the defaults change nothing.
pub trait Effect<S: Scalar>: Parameters<S> {
    /// Changes wheel and soil at a contact, before the stresses are integrated.
    #[cfg_attr(feature = "batch", inline(always))]
    fn contact(&self, place: &Place<S>, local: &mut Local<S>) {
        let _ = (place, local);
    }

    /// Changes how the rim meets the soil, after all effects have changed wheel and soil.
    #[cfg_attr(feature = "batch", inline(always))]
    fn surface(&self, place: &Place<S>, local: &mut Local<S>) {
        let _ = (place, local);
    }

    /// Whether the effect needs to know which ground has been passed.
    #[cfg_attr(feature = "batch", inline(always))]
    fn remembers(&self) -> bool {
        false
    }

    /// Changes the forces of a contact, after the stresses are integrated.
    #[cfg_attr(feature = "batch", inline(always))]
    fn forces(&self, place: &Place<S>, local: &Local<S>, forces: &mut Forces<S>) {
        let _ = (place, local, forces);
    }

    /// Changes the wheel of the data sheet into the true one.
    #[cfg_attr(feature = "batch", inline(always))]
    fn wheel(&self, wheel: &mut Wheel<S>) {
        let _ = wheel;
    }

    /// Changes a true radius back into the one that the records are reckoned with.
    #[cfg_attr(feature = "batch", inline(always))]
    fn recorded_radius(&self, radius: &mut S) {
        let _ = radius;
    }

    /// Changes the chassis of the data sheet into the true one.
    #[cfg_attr(feature = "batch", inline(always))]
    fn chassis(&self, body: &mut Body<S>) {
        let _ = body;
    }

    /// Changes the motor of the data sheet into the true one, whose winding is warmer by `winding_rise` (K).
    #[cfg_attr(feature = "batch", inline(always))]
    fn motor(&self, winding_rise: S, motor: &mut Motor<S>) {
        let _ = (winding_rise, motor);
    }

    /// True torque over the torque that the drive reckons with.
    #[cfg_attr(feature = "batch", inline(always))]
    fn torque_gain(&self) -> Option<S> {
        None
    }

    /// Dry friction of a passive joint turning at `rate` (rad/s): moment over rate, N m s/rad, finite at rest.
    #[cfg_attr(feature = "batch", inline(always))]
    fn joint_friction(&self, rate: S) -> Option<S> {
        let _ = rate;
        None
    }

    /// Changes true signals into what is recorded at the same instant; the rover started at `start_x`.
    fn record(&self, start_x: S, body: &mut BodySignals<S>, wheels: &mut [WheelSignals<S>]) {
        let _ = (start_x, body, wheels);
    }

    /// Friction torque of a drive at this wheel speed, wheel side, and its slope in the speed.
    #[cfg_attr(feature = "batch", inline(always))]
    fn drive_friction(&self, speed: S) -> Option<(S, S)> {
        let _ = speed;
        None
    }

    /// Limits the torque of a motor, wheel side, at this wheel speed; where it limits, the slope in the speed.
    #[cfg_attr(feature = "batch", inline(always))]
    fn motor_torque(&self, motor: &Motor<S>, speed: S, torque: &mut S) -> Option<S> {
        let _ = (motor, speed, torque);
        None
    }

    /// Horizontal force on the chassis at its reference point, N.
    #[cfg_attr(feature = "batch", inline(always))]
    fn body_force(&self, motion: &BodyMotion<S>) -> Option<S> {
        let _ = motion;
        None
    }
}
