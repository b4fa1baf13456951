//! The rover: constant data ([`Rover`]), moving data ([`State`]) and the equations of motion.

pub(crate) mod dynamics;
pub(crate) mod kinematics;
mod presets;
mod rate;

use crate::contact::Hold;
use crate::effects::Effects;
use crate::motor::Motor;
use crate::scalar::{LaneAccess, MapScalar, Scalar, lanes};
use crate::snapshot::Moving;
use crate::soil::Soil;
use crate::terrain::Terrain;
use crate::wheel::Wheel;
use bekker_modeldescription::{Parameters, Variable, join};

pub use crate::effects::Track;
pub use crate::vehicle::{Body, Environment, Link, LinkParameters, MAX_COORDINATES, MAX_WHEELS, Mount, WheelMount};
pub use dynamics::DynamicsError;
pub use rate::StateRate;

/// Everything about a rover and its ground that does not move.
#[derive(Clone, Debug, MapScalar)]
pub struct Rover<S = f64> {
    /// Gravity.
    pub environment: Environment<S>,
    /// Chassis.
    pub body: Body<S>,
    /// Passive links, parents before children.
    pub links: Vec<Link<S>>,
    /// Geometry of all wheels.
    pub wheel: Wheel<S>,
    /// Wheels 1..n from rear to front.
    pub wheels: Vec<WheelMount<S>>,
    /// Drive of every wheel.
    pub motor: Motor<S>,
    /// Soil.
    pub soil: Soil<S>,
    /// Ground.
    pub terrain: Terrain<S>,
    /// Missing physics, neutral by default.
    pub effects: Effects<S>,
}

#[lanes]
impl<S: Scalar> Rover<S> {
    /// Number of generalised coordinates.
    #[must_use]
    pub fn coordinates(&self) -> usize {
        3 + self.links.len()
    }

    /// Mass of chassis and links, kg.
    #[must_use]
    pub fn total_mass(&self) -> S {
        self.links.iter().fold(self.body.mass, |sum, link| sum + link.parameters.mass)
    }

    /// The wheel as it is: that of the data sheet, changed by the effects.
    pub(crate) fn true_wheel(&self) -> Wheel<S> {
        self.effects.wheel(&self.wheel).unwrap_or(self.wheel)
    }

    /// The chassis as it is.
    pub(crate) fn true_body(&self) -> Body<S> {
        let mut body = self.body;
        self.effects.chassis(&mut body);
        body
    }
}

impl<S: Scalar> Parameters<S> for Rover<S> {
    fn visit(&mut self, prefix: &str, f: &mut dyn FnMut(Variable, &mut S)) {
        self.environment.visit(prefix, f);
        self.body.visit(&join(prefix, "rover"), f);
        for (j, link) in self.links.iter_mut().enumerate() {
            link.parameters.visit(&join(prefix, &format!("link[{}]", j + 1)), f);
        }
        self.wheel.visit(&join(prefix, "wheel"), f);
        for (k, wheel) in self.wheels.iter_mut().enumerate() {
            wheel.mount.visit(&join(prefix, &format!("wheel[{}]", k + 1)), f);
        }
        self.motor.visit(&join(prefix, "motor"), f);
        self.soil.visit(&join(prefix, "soil"), f);
        self.terrain.visit(&join(prefix, "terrain"), f);
        self.effects.visit(prefix, f);
    }

    fn values(&self, f: &mut dyn FnMut(S)) {
        self.environment.values(f);
        self.body.values(f);
        self.links.iter().for_each(|link| link.parameters.values(f));
        self.wheel.values(f);
        self.wheels.iter().for_each(|wheel| wheel.mount.values(f));
        self.motor.values(f);
        self.soil.values(f);
        self.terrain.values(f);
        self.effects.values(f);
    }
}

/// Moving data of one wheel.
#[derive(Clone, Copy, Debug, PartialEq, Moving, LaneAccess, MapScalar)]
pub struct WheelState<S = f64> {
    /// Absolute rate of turning, forward positive, rad/s.
    pub spin: S,
    /// Memory of the standing contact.
    pub hold: Hold<S>,
    /// How much warmer than its surroundings the motor's winding is, K.
    pub winding_rise: S,
    /// Slip to which the ground under the wheel is dug, see [`Place`](crate::effects::Place); kept where an effect needs it.
    pub dug_slip: S,
    /// Ground that the wheel has covered.
    pub track: Track<S>,
}

/// Moving data of a rover: everything that a step changes.
#[derive(Clone, Debug, PartialEq, Moving, LaneAccess, MapScalar)]
pub struct State<S = f64> {
    /// x, z, pitch of the chassis, then joint angles; m, rad.
    pub position: Vec<S>,
    /// Their rates.
    pub rate: Vec<S>,
    /// Wheels 1..n.
    pub wheels: Vec<WheelState<S>>,
    /// x at the start, from which a travelled distance counts, m.
    pub start_x: S,
}

impl<S: Scalar> State<S> {
    /// Takes the values of a state of the same rover over, without allocating.
    #[lanes]
    pub(crate) fn copy_from(&mut self, other: &Self) {
        self.position.copy_from_slice(&other.position);
        self.rate.copy_from_slice(&other.rate);
        self.wheels.copy_from_slice(&other.wheels);
        self.start_x = other.start_x;
    }

    /// At rest, with the reference point at (x, z).
    #[must_use]
    pub fn at_rest(rover: &Rover<S>, x: S, z: S) -> Self {
        let zero = S::from(0.0);
        let mut position = vec![zero; rover.coordinates()];
        position[0] = x;
        position[1] = z;
        Self {
            rate: vec![zero; position.len()],
            position,
            wheels: vec![
                WheelState {
                    spin: zero,
                    hold: Hold::default(),
                    winding_rise: zero,
                    dug_slip: zero,
                    track: Track::default()
                };
                rover.wheels.len()
            ],
            start_x: x,
        }
    }
}
