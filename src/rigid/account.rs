//! Energies, drives and signals of the plant of rigid bodies.

use super::plant::RigidBodies;
use crate::motor;
use crate::rover::dynamics::{DynamicsError, Powers};
use crate::signals::Drive;

impl RigidBodies {
    /// Adds the energies of the step. Work is that of the forces that the bodies felt, over their mean velocities: what
    /// changes the kinetic energy. Losses of the motors follow the trapezoidal rule.
    pub(super) fn add_energies(&mut self, before: &Powers<f64>, h: f64) {
        let after = self.integrator.now.powers();
        self.energies.dissipated += 0.5 * h * (before.dissipated + after.dissipated);
        self.energies.electrical += 0.5 * h * (before.electrical + after.electrical);
        for (k, load) in self.loads.wheels.iter().enumerate() {
            let (from, to) = (&self.wheels_before[k], self.world.motion_of(self.world.wheels[k]));
            let carrier = self.rover.wheels[k].body;
            let carrier_rate =
                self.bodies_before[carrier].rate + self.world.motion_of(self.world.carriers[carrier]).rate;
            // Forward turning is clockwise.
            let spin = -0.5 * (from.rate + to.rate);
            let velocity = (from.velocity + to.velocity) * 0.5;
            self.energies.drive += load.rim_torque * (spin + 0.5 * carrier_rate) * h;
            let carried = load.force[0] * velocity.x + load.force[1] * velocity.y;
            self.energies.soil_loss += (load.soil_torque * spin - carried) * h;
        }
        let mean = |i: usize| 0.5 * (self.previous.rate[i] + self.state.rate[i]);
        let joints: f64 = self.loads.links.iter().enumerate().map(|(j, moment)| moment * mean(3 + j)).sum();
        let rigid: f64 = self.wheel_contacts.iter().chain(&self.body_contacts).map(|contact| contact.work).sum();
        self.energies.other_loss -= (joints + self.loads.resistance * mean(0)) * h + rigid;
    }

    /// Where speeds are imposed, the drives gave what the wheels' momenta needed beside soil and rigid contacts.
    pub(super) fn find_drives(&mut self, h: f64) -> Result<(), DynamicsError> {
        if self.command.drive != Drive::Speed {
            return Ok(());
        }
        for (k, load) in self.loads.wheels.iter_mut().enumerate() {
            let contact = &self.wheel_contacts[k];
            if contact.normal == [0.0, 0.0] {
                continue;
            }
            let turned = self.wheels_before[k].rate - self.world.motion_of(self.world.wheels[k]).rate;
            load.rim_torque = self.rover.wheel.inertia * turned / h + load.soil_torque + contact.moment;
            let wheel = &mut self.integrator.now.wheels[k];
            wheel.rim_torque = load.rim_torque;
            wheel.motor_torque = motor::torque_behind(&self.rover.effects, wheel.speed, load.rim_torque)?;
            wheel.current = motor::current(&wheel.motor, wheel.motor_torque);
        }
        Ok(())
    }

    /// Writes the signals from the present state, as sensors without memory see it.
    pub(super) fn sense(&mut self) {
        let Self { rover, state, energies, integrator, wheel_contacts, signals, .. } = self;
        integrator.now.sense_beside(rover, state, energies, signals, |signals| {
            let wheels = signals.wheels.iter_mut().zip(&integrator.now.wheels).zip(&*wheel_contacts);
            for ((signals, wheel), rigid) in wheels {
                // Without a rigid contact the soil's own numbers stay, to the last bit.
                if rigid.normal != [0.0, 0.0] {
                    let soil = wheel.touch.forces;
                    let total =
                        |i: usize| soil.normal * wheel.normal[i] + soil.drawbar * wheel.tangent[i] + rigid.force[i];
                    let along = |i: usize| soil.normal * wheel.normal[i] + rigid.normal[i];
                    let length = along(0).hypot(along(1));
                    let (x, z) = (along(0) / length, along(1) / length);
                    signals.contact_angle = (-x).atan2(z);
                    signals.normal_force = total(0) * x + total(1) * z;
                    signals.drawbar_pull = total(0) * z - total(1) * x;
                }
            }
        });
    }
}
