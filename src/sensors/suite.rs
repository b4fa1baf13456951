//! Sensors at work.

use super::Sensors;
use super::channel::Clock;
use crate::signals::{LinkMeasurement, Measurement, Signals, WheelMeasurement};
use crate::snapshot::{Moving, Reader, SnapshotError, Writer, load_grown};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use rand_distr::{Distribution, StandardNormal};

/// Sensors at work: seeded streams of noise and the samples that are held, so that a clone reads the same.
#[derive(Clone, Debug)]
pub struct SensorSuite {
    sensors: Sensors,
    /// Noise of pitch, velocity, wheel speeds and contact angles.
    noise: ChaCha8Rng,
    /// Noise of all other channels: sensors that were added later leave the draws of the first as they were.
    further_noise: ChaCha8Rng,
    clocks: Clocks,
    /// Last samples.
    held: Measurement,
    /// What the counts of each encoder leave over, rad/s.
    rests: Vec<f64>,
}

impl Moving for SensorSuite {
    fn save(&self, to: &mut Writer) {
        let Self { noise, further_noise, clocks, held, rests, sensors: _ } = self;
        noise.save(to);
        further_noise.save(to);
        clocks.save(to);
        held.save(to);
        rests.save(to);
    }

    fn load(&mut self, from: &mut Reader) -> Result<(), SnapshotError> {
        self.noise.load(from)?;
        self.further_noise.load(from)?;
        self.clocks.load(from)?;
        self.held.load(from)?;
        load_grown(&mut self.rests, from)
    }
}

#[derive(Clone, Debug, Default, Moving)]
struct Clocks {
    pitch: Clock,
    velocity: Clock,
    wheel_speed: Clock,
    contact_angle: Clock,
    pitch_rate: Clock,
    torque: Clock,
    link_angle: Clock,
    link_rate: Clock,
}

impl SensorSuite {
    /// Sensors before their first reading; `seed` decides all noise.
    #[must_use]
    pub fn new(sensors: Sensors, seed: u64) -> Self {
        let noise = ChaCha8Rng::seed_from_u64(seed);
        let mut further_noise = noise.clone();
        further_noise.set_stream(1);
        Self {
            sensors,
            noise,
            further_noise,
            clocks: Clocks::default(),
            held: Measurement::default(),
            rests: Vec::new(),
        }
    }

    /// Goes on with sensors of other numbers; noise and held samples stay.
    pub(crate) fn retune(&mut self, sensors: Sensors) {
        self.sensors = sensors;
    }

    /// Reads the signals at `time`, s, into `measurement`. Allocates only where a rover has more wheels or links than at
    /// the reading before.
    pub fn read(&mut self, time: f64, signals: &Signals, measurement: &mut Measurement) {
        self.held.time = time;
        self.held.wheels.resize(signals.wheels.len(), WheelMeasurement::default());
        self.held.links.resize(signals.links.len(), LinkMeasurement::default());
        self.rests.resize(signals.wheels.len(), 0.0);
        self.sample(time, signals);
        self.sample_further(time, signals);
        measurement.take_over(&self.held);
    }

    /// The streams advance by the same amount at every reading, whatever the deviations and sample periods.
    fn sample(&mut self, time: f64, signals: &Signals) {
        let (body, held, noise) = (&signals.body, &mut self.held, &mut self.noise);
        let (pitch, velocity) = (self.sensors.body.pitch(), self.sensors.body.velocity());
        let (speed, angle) = (self.sensors.encoder.wheel_speed(), self.sensors.body.contact_angle());
        let reading = pitch.reading(body.pitch, draw(noise));
        if self.clocks.pitch.due(time, pitch.period) {
            held.pitch = reading;
        }
        let reading = velocity.reading(body.velocity, draw(noise));
        if self.clocks.velocity.due(time, velocity.period) {
            held.velocity = reading;
        }
        let speed_due = self.clocks.wheel_speed.due(time, speed.period);
        let angle_due = self.clocks.contact_angle.due(time, angle.period);
        for ((held, wheel), rest) in held.wheels.iter_mut().zip(&signals.wheels).zip(&mut self.rests) {
            let unit = draw(noise);
            if speed_due {
                held.speed = speed.counted(wheel.speed, unit, rest);
            }
            let reading = angle.reading(wheel.contact_angle, draw(noise));
            if angle_due {
                held.contact_angle = reading;
            }
        }
    }

    fn sample_further(&mut self, time: f64, signals: &Signals) {
        let (held, noise) = (&mut self.held, &mut self.further_noise);
        let (rate, torque) = (self.sensors.gyroscope.pitch_rate(), self.sensors.current.torque());
        let (link_angle, link_rate) = (self.sensors.joint.link_angle(), self.sensors.joint.link_rate());
        let reading = rate.reading_if_noisy(signals.body.pitch_rate, draw(noise));
        if self.clocks.pitch_rate.due(time, rate.period) {
            held.pitch_rate = reading;
        }
        let due = self.clocks.torque.due(time, torque.period);
        for (held, wheel) in held.wheels.iter_mut().zip(&signals.wheels) {
            let reading = torque.reading_if_noisy(wheel.torque, draw(noise));
            if due {
                held.torque = reading;
            }
        }
        let angle_due = self.clocks.link_angle.due(time, link_angle.period);
        let rate_due = self.clocks.link_rate.due(time, link_rate.period);
        for (held, link) in held.links.iter_mut().zip(&signals.links) {
            let reading = link_angle.reading_if_noisy(link.angle, draw(noise));
            if angle_due {
                held.angle = reading;
            }
            let reading = link_rate.reading_if_noisy(link.rate, draw(noise));
            if rate_due {
                held.rate = reading;
            }
        }
    }
}

fn draw(noise: &mut ChaCha8Rng) -> f64 {
    StandardNormal.sample(noise)
}
