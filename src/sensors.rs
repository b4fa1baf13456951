//! Sensors: what a controller gets to see of the true signals.

use crate::signals::{Measurement, Signals, WheelMeasurement};
use bekker_modeldescription::{Unit, parameters};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use rand_distr::{Distribution, StandardNormal};

parameters! {
    /// Encoders of the wheels.
    pub struct Encoder {
        /// White noise of a wheel speed, standard deviation.
        wheel_speed_noise: [Unit::RADIAN_PER_SECOND] = 0.0, 0.0..=10.0, Fixed, "0 is none; Iagnemma 2001, 4.4.1 has 5 % of the range";
    }
}

parameters! {
    /// Sensors of the body's motion, and the contact angles.
    pub struct BodySensors {
        /// White noise of the pitch, standard deviation.
        pitch_noise: [Unit::RADIAN] = 0.0, 0.0..=1.0, Fixed, "0 is none; Iagnemma 2001, 4.4.1 has 5 % of the range";
        /// White noise of the velocity, standard deviation.
        velocity_noise: [Unit::METRE_PER_SECOND] = 0.0, 0.0..=1.0, Fixed, "0 is none";
        /// White noise of a contact angle, standard deviation.
        contact_angle_noise: [Unit::RADIAN] = 0.0, 0.0..=1.0, Fixed, "0 is none; an estimator's error is 1-2 degrees in Iagnemma 2001, 2.6";
    }
}

/// All sensors.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Sensors {
    /// Encoders.
    pub encoder: Encoder,
    /// Pitch, velocity, contact angles.
    pub body: BodySensors,
}

/// Sensors at work: a seeded stream of noise, so that a clone reads the same.
#[derive(Clone, Debug)]
pub(crate) struct SensorSuite {
    sensors: Sensors,
    noise: ChaCha8Rng,
}

impl SensorSuite {
    pub fn new(sensors: Sensors, seed: u64) -> Self {
        Self { sensors, noise: ChaCha8Rng::seed_from_u64(seed) }
    }

    /// Reads the true signals into `measurement`.
    pub fn read(&mut self, time: f64, signals: &Signals, measurement: &mut Measurement) {
        let body = &signals.body;
        measurement.time = time;
        measurement.pitch = body.pitch + self.draw(self.sensors.body.pitch_noise);
        measurement.pitch_rate = body.pitch_rate;
        measurement.velocity = body.velocity + self.draw(self.sensors.body.velocity_noise);
        measurement.wheels.resize(signals.wheels.len(), WheelMeasurement::default());
        for (reading, wheel) in measurement.wheels.iter_mut().zip(&signals.wheels) {
            reading.speed = wheel.speed + self.draw(self.sensors.encoder.wheel_speed_noise);
            reading.torque = wheel.torque;
            reading.contact_angle = wheel.contact_angle + self.draw(self.sensors.body.contact_angle_noise);
        }
    }

    /// White noise; the stream advances by the same amount whatever the deviation.
    fn draw(&mut self, deviation: f64) -> f64 {
        let unit: f64 = StandardNormal.sample(&mut self.noise);
        deviation * unit
    }
}
