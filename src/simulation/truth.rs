//! The true signals of a rover at one instant.

use super::Energies;
use crate::rover::dynamics::Evaluation;
use crate::rover::{Rover, State};
use crate::scalar::{Plain, Scalar};
use crate::signals::Signals;

impl<S: Scalar> Evaluation<S> {
    /// Writes the signals at this instant as sensors without memory record them.
    #[inline]
    pub(crate) fn sense(&self, rover: &Rover<S>, state: &State<S>, energies: &Energies<S>, signals: &mut Signals<S>) {
        self.sense_beside(rover, state, energies, signals, |_| {});
    }

    /// The same, with `beside` to overwrite signals that the soil does not decide alone: where an obstacle touches a wheel.
    #[inline]
    pub(crate) fn sense_beside(
        &self,
        rover: &Rover<S>,
        state: &State<S>,
        energies: &Energies<S>,
        signals: &mut Signals<S>,
        beside: impl FnOnce(&mut Signals<S>),
    ) {
        self.write_signals(rover, state, energies, signals);
        beside(signals);
        rover.effects.record(state.start_x, &mut signals.body, &mut signals.wheels);
    }

    /// Writes the true signals at this instant.
    fn write_signals(&self, rover: &Rover<S>, state: &State<S>, energies: &Energies<S>, signals: &mut Signals<S>) {
        let powers = self.powers();
        let [vx, vz] = [state.rate[0], state.rate[1]];
        let body = &mut signals.body;
        body.x = state.position[0];
        body.z = state.position[1];
        body.velocity = path_speed(vx, vz);
        body.pitch = state.position[2];
        body.pitch_rate = state.rate[2];
        body.power = powers.dissipated;
        body.electrical_power = powers.electrical;
        body.dissipated_energy = energies.dissipated;
        body.electrical_energy = energies.electrical;
        body.drive_work = energies.drive;
        body.soil_loss = energies.soil_loss;
        body.other_loss = energies.other_loss;
        body.mechanical_energy = self.mechanical_energy(rover, state);
        for (signals, wheel) in signals.wheels.iter_mut().zip(&self.wheels) {
            signals.speed = wheel.speed;
            signals.slip = wheel.slip;
            signals.sinkage = wheel.sinkage;
            signals.normal_force = wheel.touch.forces.normal;
            signals.drawbar_pull = wheel.touch.forces.drawbar;
            signals.torque = wheel.motor_torque;
            signals.current = wheel.current;
            signals.contact_angle = wheel.contact_angle;
        }
        for (j, link) in signals.links.iter_mut().enumerate() {
            link.angle = state.position[3 + j];
            link.rate = state.rate[3 + j];
        }
    }
}

/// Speed along the path, signed by its direction along x; its real part is `hypot`'s to the last bit.
pub(crate) fn path_speed<S: Scalar>(vx: S, vz: S) -> S {
    if S::Plain::LANES > 1 {
        let (vx, vz) = (vx.plain(), vz.plain());
        return S::from_plain(Plain::from_lanes(|k| path_speed(vx.lane(k), vz.lane(k))));
    }
    let speed = vx.value().hypot(vz.value()).copysign(vx.value());
    if speed == 0.0 {
        return S::from(speed);
    }
    // d|v| = (vx dvx + vz dvz)/|v|.
    let change = |v: S| (v - v.value()) * (v.value() / speed);
    change(vx) + change(vz) + speed
}
