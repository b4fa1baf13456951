//! The continuous states of a rover by name, unit and typical size.

use crate::rover::{State, WheelState};
use crate::scalar::Scalar;
use crate::simulation::Energies;
use bekker_modeldescription::{Parameters, Unit, Variable, parameters};

const ANY: std::ops::RangeInclusive<f64> = f64::NEG_INFINITY..=f64::INFINITY;

parameters! {
    /// States of the chassis.
    pub struct BodyStates {
        /// Position of the chassis reference point along the ground.
        x: [Unit::METRE] = 0.0, ANY, Signal, "state";
        /// Height of the chassis reference point.
        z: [Unit::METRE] = 0.0, ANY, Signal, "state";
        /// Pitch of the chassis, nose up positive.
        pitch: [Unit::RADIAN] = 0.0, ANY, Signal, "state";
        /// Velocity of the chassis reference point along x.
        velocity_x: [Unit::METRE_PER_SECOND] = 0.0, ANY, Signal, "state";
        /// Velocity of the chassis reference point along z.
        velocity_z: [Unit::METRE_PER_SECOND] = 0.0, ANY, Signal, "state";
        /// Rate of the pitch.
        pitch_rate: [Unit::RADIAN_PER_SECOND] = 0.0, ANY, Signal, "state";
    }
}

parameters! {
    /// States of a passive joint.
    pub struct JointStates {
        /// Angle of the joint that carries the link.
        angle: [Unit::RADIAN] = 0.0, ANY, Signal, "state";
        /// Rate of that angle.
        rate: [Unit::RADIAN_PER_SECOND] = 0.0, ANY, Signal, "state";
    }
}

parameters! {
    /// States of a wheel.
    pub struct WheelStates {
        /// Absolute rate of turning, forward positive.
        spin: [Unit::RADIAN_PER_SECOND] = 0.0, ANY, Signal, "state";
        /// Memory of the standing contact: direction of its last motion, part of the centre's motion along the ground.
        hold_travel: [Unit::ONE] = 0.0, ANY, Signal, "state";
        /// Memory of the standing contact: part of the rim's motion.
        hold_turn: [Unit::ONE] = 0.0, ANY, Signal, "state";
        /// How much warmer than its surroundings the motor's winding is; constant without the effect winding_heat.
        winding_rise: [Unit::KELVIN] = 0.0, ANY, Signal, "state";
        /// Slip to which the ground under the wheel is dug; constant where slip_sinkage.length is 0.
        dug_slip: [Unit::ONE] = 0.0, ANY, Signal, "state";
    }
}

parameters! {
    /// Energies since the start, integrals of powers.
    pub struct EnergyStates {
        /// Energy dissipated in the windings.
        dissipated_energy: [Unit::JOULE] = 0.0, ANY, Signal, "state";
        /// Electrical energy drawn.
        electrical_energy: [Unit::JOULE] = 0.0, ANY, Signal, "state";
        /// Mechanical work of the drives on the wheels.
        drive_work: [Unit::JOULE] = 0.0, ANY, Signal, "state";
        /// Energy lost to the soil.
        soil_loss: [Unit::JOULE] = 0.0, ANY, Signal, "state";
        /// Energy lost to joint friction and to resistances at the chassis.
        other_loss: [Unit::JOULE] = 0.0, ANY, Signal, "state";
    }
}

/// All continuous states of a rover whose wheel torques are commanded, or all their derivatives.
#[derive(Clone, Debug, PartialEq)]
pub struct States<S = f64> {
    /// Chassis.
    pub body: BodyStates<S>,
    /// Joints 1..m.
    pub joints: Vec<JointStates<S>>,
    /// Wheels 1..n.
    pub wheels: Vec<WheelStates<S>>,
    /// Energies.
    pub energies: EnergyStates<S>,
}

impl<S: Copy> Parameters<S> for States<S> {
    fn visit(&mut self, prefix: &str, f: &mut dyn FnMut(Variable, &mut S)) {
        let name = |part: &str, k: usize| bekker_modeldescription::join(prefix, &format!("{part}[{}]", k + 1));
        self.body.visit(prefix, f);
        self.joints.iter_mut().enumerate().for_each(|(j, joint)| joint.visit(&name("link", j), f));
        self.wheels.iter_mut().enumerate().for_each(|(k, wheel)| wheel.visit(&name("wheel", k), f));
        self.energies.visit(prefix, f);
    }

    fn values(&self, f: &mut dyn FnMut(S)) {
        self.body.values(f);
        self.joints.iter().for_each(|joint| joint.values(f));
        self.wheels.iter().for_each(|wheel| wheel.values(f));
        self.energies.values(f);
    }
}

impl<S: Scalar> States<S> {
    /// How many there are of a rover with so many wheels and links.
    pub(super) fn count(wheels: usize, links: usize) -> usize {
        11 + 2 * links + 5 * wheels
    }

    pub(super) fn of(state: &State<S>, energies: &Energies<S>) -> Self {
        let [x, z, pitch] = [0, 1, 2].map(|i| state.position[i]);
        let [velocity_x, velocity_z, pitch_rate] = [0, 1, 2].map(|i| state.rate[i]);
        let joint = |j: usize| JointStates { angle: state.position[j], rate: state.rate[j] };
        let wheel = |wheel: &WheelState<S>| WheelStates {
            spin: wheel.spin,
            hold_travel: wheel.hold.travel,
            hold_turn: wheel.hold.turn,
            winding_rise: wheel.winding_rise,
            dug_slip: wheel.dug_slip,
        };
        Self {
            body: BodyStates { x, z, pitch, velocity_x, velocity_z, pitch_rate },
            joints: (3..state.position.len()).map(joint).collect(),
            wheels: state.wheels.iter().map(wheel).collect(),
            energies: EnergyStates {
                dissipated_energy: energies.dissipated,
                electrical_energy: energies.electrical,
                drive_work: energies.drive,
                soil_loss: energies.soil_loss,
                other_loss: energies.other_loss,
            },
        }
    }
}

/// Calls `f` with the place of every state, in the order of [`States`]; allocates nothing.
pub(super) fn places<S: Scalar>(state: &mut State<S>, energies: &mut Energies<S>, mut f: impl FnMut(&mut S)) {
    state.position[..3].iter_mut().for_each(&mut f);
    state.rate[..3].iter_mut().for_each(&mut f);
    for (angle, rate) in state.position[3..].iter_mut().zip(&mut state.rate[3..]) {
        f(angle);
        f(rate);
    }
    for wheel in &mut state.wheels {
        let WheelState { spin, hold, winding_rise, dug_slip, .. } = wheel;
        [spin, &mut hold.travel, &mut hold.turn, winding_rise, dug_slip].into_iter().for_each(&mut f);
    }
    let Energies { dissipated, electrical, drive, soil_loss, other_loss } = energies;
    [dissipated, electrical, drive, soil_loss, other_loss].into_iter().for_each(&mut f);
}

/// Description of a state's derivative: `der(name)`, in its unit a second.
#[must_use]
pub fn derivative_of(state: &Variable) -> Variable {
    let unit = match state.unit {
        unit if unit == Unit::METRE => Unit::METRE_PER_SECOND,
        unit if unit == Unit::METRE_PER_SECOND => Unit::METRE_PER_SECOND2,
        unit if unit == Unit::RADIAN => Unit::RADIAN_PER_SECOND,
        unit if unit == Unit::RADIAN_PER_SECOND => Unit::RADIAN_PER_SECOND2,
        unit if unit == Unit::KELVIN => Unit::KELVIN_PER_SECOND,
        unit if unit == Unit::JOULE => Unit::WATT,
        _ => Unit::PER_SECOND,
    };
    let name = format!("der({})", state.name);
    Variable { doc: format!("Time derivative of {}.", state.name).into(), name, unit, ..state.clone() }
}
