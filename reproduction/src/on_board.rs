//! A simulated rover read by noisy sensors, its wheels at given speeds: what an identification experiment of 2.3.2
//! drives.

use super::instruments::NormalNoise;
use bekker::rover::Rover;
use bekker::signals::{Command, LinkMeasurement, Measurement, WheelMeasurement};
use bekker::simulation::{Simulation, Status, StepError};

/// White noise of the sensors, standard deviations.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SensorNoise {
    /// Pitch and joint angles, rad.
    pub angle: f64,
    /// Velocity of the body, m/s.
    pub velocity: f64,
    /// Wheel speeds, rad/s.
    pub wheel_speed: f64,
    /// Torques, N m.
    pub torque: f64,
    /// Contact angles, rad.
    pub contact_angle: f64,
}

/// The rover, its sensors and the time between readings.
#[derive(Clone, Debug)]
pub struct OnBoard {
    simulation: Simulation,
    sensors: SensorNoise,
    noise: NormalNoise,
    steps: u64,
    measured: Measurement,
}

impl OnBoard {
    /// `rover` settled at x = 0, in steps of `step_size` (s), read every `steps` of them.
    ///
    /// # Errors
    /// [`StepError`] where it does not settle.
    pub fn new(
        rover: Rover,
        sensors: SensorNoise,
        seed: u64,
        (step_size, steps): (f64, u64),
    ) -> Result<Self, StepError> {
        let simulation = Simulation::new(rover, 0.0, step_size)?;
        Ok(Self { simulation, sensors, noise: NormalNoise::new(seed), steps, measured: Measurement::default() })
    }

    /// Drives on for one sampling time with these wheel speeds (rad/s), and reads.
    ///
    /// # Errors
    /// [`StepError`] where the simulation ends.
    pub fn advance(&mut self, speeds: &[f64]) -> Result<Status, StepError> {
        let status = self.simulation.advance(&Command::speed(speeds.to_vec()), self.steps)?;
        self.read();
        Ok(status)
    }

    fn read(&mut self) {
        let SensorNoise { angle, velocity, wheel_speed, torque, contact_angle } = self.sensors;
        let (noise, measured) = (&mut self.noise, &mut self.measured);
        let (signals, state) = (self.simulation.signals(), self.simulation.state());
        measured.time = self.simulation.time();
        measured.pitch = signals.body.pitch + noise.draw(angle);
        measured.pitch_rate = signals.body.pitch_rate;
        measured.velocity = signals.body.velocity + noise.draw(velocity);
        measured.wheels.resize(signals.wheels.len(), WheelMeasurement::default());
        for (reading, wheel) in measured.wheels.iter_mut().zip(&signals.wheels) {
            reading.speed = wheel.speed + noise.draw(wheel_speed);
            reading.torque = wheel.torque + noise.draw(torque);
            reading.contact_angle = wheel.contact_angle + noise.draw(contact_angle);
        }
        let joints = state.position.iter().zip(&state.rate).skip(3);
        measured.links.clear();
        measured.links.extend(joints.map(|(q, rate)| LinkMeasurement { angle: q + noise.draw(angle), rate: *rate }));
    }

    /// What the sensors read last.
    #[must_use]
    pub fn measured(&self) -> &Measurement {
        &self.measured
    }

    /// The rover as it is.
    #[must_use]
    pub fn simulation(&self) -> &Simulation {
        &self.simulation
    }
}
