//! What sensors report. Names, meanings and units are written here alone; every reading has the name of the signal it measures.

use super::{ANY, Signals};
use crate::snapshot::{Moving, Reader, SnapshotError, Writer, load_grown};
use bekker_modeldescription::{Parameters, Unit, Variable, join, parameters};

parameters! {
    /// What sensors report of the chassis.
    struct BodyMeasurement {
        /// Measured pitch of the chassis, nose up positive.
        pitch: [Unit::RADIAN] = 0.0, ANY, Signal, "physics";
        /// Measured rate of the pitch.
        pitch_rate: [Unit::RADIAN_PER_SECOND] = 0.0, ANY, Signal, "physics";
        /// Measured speed of the chassis reference point along its path.
        velocity: [Unit::METRE_PER_SECOND] = 0.0, ANY, Signal, "physics";
    }
}

parameters! {
    /// What sensors report of one wheel.
    #[derive(Moving)]
    pub struct WheelMeasurement {
        /// Encoder speed relative to the carrying body.
        speed: [Unit::RADIAN_PER_SECOND] = 0.0, ANY, Signal, "physics";
        /// Torque from the motor current, wheel side of the gear.
        torque: [Unit::NEWTON_METRE] = 0.0, ANY, Signal, "physics";
        /// Contact angle as a sensor reports it.
        contact_angle: [Unit::RADIAN] = 0.0, ANY, Signal, "physics";
    }
}

parameters! {
    /// What sensors report of one link.
    #[derive(Moving)]
    pub struct LinkMeasurement {
        /// Measured angle of the joint that carries the link.
        angle: [Unit::RADIAN] = 0.0, ANY, Signal, "physics";
        /// Measured rate of that angle.
        rate: [Unit::RADIAN_PER_SECOND] = 0.0, ANY, Signal, "physics";
    }
}

/// What a controller or estimator may see: sensor readings, never the true state.
///
/// As [`Parameters`] it has the readings without their time: chassis, wheels, links.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct Measurement {
    /// Time of the reading, s.
    pub time: f64,
    /// Pitch of the chassis, rad.
    pub pitch: f64,
    /// Pitch rate, rad/s.
    pub pitch_rate: f64,
    /// Speed of the chassis reference point along its path, m/s.
    pub velocity: f64,
    /// One entry a wheel, rear to front.
    pub wheels: Vec<WheelMeasurement>,
    /// One entry a link; none for a rigid vehicle.
    pub links: Vec<LinkMeasurement>,
}

impl Parameters<f64> for Measurement {
    fn visit(&mut self, prefix: &str, f: &mut dyn FnMut(Variable, &mut f64)) {
        let mut body = self.body();
        body.visit(prefix, f);
        self.set_body(body);
        for (k, wheel) in self.wheels.iter_mut().enumerate() {
            wheel.visit(&join(prefix, &format!("wheel[{}]", k + 1)), f);
        }
        for (k, link) in self.links.iter_mut().enumerate() {
            link.visit(&join(prefix, &format!("link[{}]", k + 1)), f);
        }
    }

    fn values(&self, f: &mut dyn FnMut(f64)) {
        self.body().values(f);
        self.wheels.iter().for_each(|wheel| wheel.values(f));
        self.links.iter().for_each(|link| link.values(f));
    }

    fn places(&mut self, f: &mut dyn FnMut(&mut f64)) {
        let mut body = self.body();
        body.places(f);
        self.set_body(body);
        self.wheels.iter_mut().for_each(|wheel| wheel.places(f));
        self.links.iter_mut().for_each(|link| link.places(f));
    }
}

impl Measurement {
    /// Readings, all zero, of a rover with so many wheels and links.
    #[must_use]
    pub fn of(wheels: usize, links: usize) -> Self {
        Self {
            wheels: vec![WheelMeasurement::default(); wheels],
            links: vec![LinkMeasurement::default(); links],
            ..Self::default()
        }
    }

    /// Which of the signals each reading measures, both in the order of their visits.
    #[must_use]
    pub fn measured_signals(signals: &Signals) -> Vec<usize> {
        let mut names = Vec::new();
        signals.clone().visit("", &mut |variable, _| names.push(variable.name));
        let mut measured = Vec::new();
        Self::of(signals.wheels.len(), signals.links.len()).visit("", &mut |variable, _| {
            measured.extend(names.iter().position(|name| *name == variable.name));
        });
        measured
    }

    fn body(&self) -> BodyMeasurement {
        BodyMeasurement { pitch: self.pitch, pitch_rate: self.pitch_rate, velocity: self.velocity }
    }

    fn set_body(&mut self, body: BodyMeasurement) {
        BodyMeasurement { pitch: self.pitch, pitch_rate: self.pitch_rate, velocity: self.velocity } = body;
    }
}

impl Moving for Measurement {
    fn save(&self, to: &mut Writer) {
        let Self { time, pitch, pitch_rate, velocity, wheels, links } = self;
        [*time, *pitch, *pitch_rate, *velocity].save(to);
        wheels.save(to);
        links.save(to);
    }

    fn load(&mut self, from: &mut Reader) -> Result<(), SnapshotError> {
        let mut body = [0.0; 4];
        body.load(from)?;
        [self.time, self.pitch, self.pitch_rate, self.velocity] = body;
        // Empty before the first reading.
        load_grown(&mut self.wheels, from)?;
        load_grown(&mut self.links, from)
    }
}

impl Measurement {
    /// Takes another's readings over, without allocating where the rover is the same.
    pub(crate) fn take_over(&mut self, other: &Self) {
        let Self { time, pitch, pitch_rate, velocity, wheels, links } = other;
        (self.time, self.pitch, self.pitch_rate, self.velocity) = (*time, *pitch, *pitch_rate, *velocity);
        self.wheels.clone_from(wheels);
        self.links.clone_from(links);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn property_every_reading_measures_a_signal_of_its_unit() {
        let (wheels, links) = (3, 2);
        let (mut signals, mut readings) = (Vec::new(), Vec::new());
        Signals::of(wheels, links).visit("", &mut |variable, _: &mut f64| signals.push((variable.name, variable.unit)));
        Measurement::of(wheels, links).visit("", &mut |variable, _| readings.push((variable.name, variable.unit)));
        let measured = Measurement::measured_signals(&Signals::of(wheels, links));
        assert_eq!(measured.len(), readings.len());
        assert!(measured.iter().zip(&readings).all(|(signal, reading)| signals[*signal] == *reading));
    }

    #[test]
    fn property_values_and_places_have_the_order_of_the_visit() {
        let mut measurement = Measurement::of(2, 1);
        let mut count = 0.0;
        measurement.visit("", &mut |_, place| {
            *place = count;
            count += 1.0;
        });
        let (mut values, mut places) = (Vec::new(), Vec::new());
        measurement.values(&mut |value| values.push(value));
        measurement.places(&mut |place| places.push(*place));
        let expected: Vec<f64> = (0..3 + 2 * 3 + 2).map(f64::from).collect();
        assert_eq!((values, places), (expected.clone(), expected));
    }
}
