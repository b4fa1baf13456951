//! Sensors: what a controller or estimator gets to see of the true signals.
//!
//! Every channel is sampled, then has white noise and a constant bias added, then is rounded to its resolution; between
//! samples the last one is held:
//!
//! ```text
//! reading = round((truth + noise + bias) / resolution) resolution        at a sample, held until the next
//! ```
//!
//! A sample is taken at the first reading of each sample period, so a period that is no whole number of control periods
//! is met on average only. With every parameter at 0 a reading is the signal itself.

mod channel;
mod parameters;
mod suite;

pub use parameters::{BodySensors, CurrentSensor, Encoder, Gyroscope, JointSensors};
pub use suite::SensorSuite;

use bekker_modeldescription::{Parameters, Variable};

/// All sensors.
///
/// As [`Parameters`] it visits all of them. A model lists those that its controller reads.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Sensors {
    /// Encoders.
    pub encoder: Encoder,
    /// Pitch, velocity, contact angles.
    pub body: BodySensors,
    /// Pitch rate.
    pub gyroscope: Gyroscope,
    /// Torques, from the motors' currents.
    pub current: CurrentSensor,
    /// Angles and rates of the links' joints.
    pub joint: JointSensors,
}

impl Parameters<f64> for Sensors {
    fn visit(&mut self, prefix: &str, f: &mut dyn FnMut(Variable, &mut f64)) {
        self.encoder.visit(prefix, f);
        self.body.visit(prefix, f);
        self.gyroscope.visit(prefix, f);
        self.current.visit(prefix, f);
        self.joint.visit(prefix, f);
    }

    fn values(&self, f: &mut dyn FnMut(f64)) {
        self.encoder.values(f);
        self.body.values(f);
        self.gyroscope.values(f);
        self.current.values(f);
        self.joint.values(f);
    }
}
