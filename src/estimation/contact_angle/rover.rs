//! Contact angles of all wheels of a rover.

use super::filter::{Innovation, PairFilter, PairModel, PairReading};
use super::pairs::{Pair, Point, pairs};
use super::parameters::{ContactAngleEstimation, NO_GYROSCOPE};
use crate::control::Nominal;
use crate::estimation::EstimationError;
use crate::estimation::error::{finite, within_bounds};
use crate::signals::Measurement;
use crate::snapshot::{Moving, Reader, SnapshotError, Writer, loaded};

/// Estimates the contact angles of all wheels from pitch, pitch rate, wheel speeds and the links' angles and rates.
///
/// Wheels on one body are paired with each other; a wheel that is alone on its body is paired with a joint, whose speed
/// follows from the pair on the other side of it (2.6.2: the rear wheel of a rocker-bogie and the bogie's pivot). Errors
/// that pairs share are not modelled across them: where several see one wheel, the estimate is their mean weighted by
/// inverse variance, and its deviation the one that fully correlated errors give.
#[derive(Clone, Debug)]
pub struct ContactAngles {
    parameters: ContactAngleEstimation,
    radius: f64,
    /// Body that carries each link's joint.
    parents: Vec<usize>,
    pairs: Vec<Pair>,
    filters: Vec<Option<PairFilter>>,
    time: Option<f64>,
    angles: Vec<f64>,
    deviations: Vec<f64>,
    innovation: Innovation,
}

impl Moving for ContactAngles {
    fn save(&self, to: &mut Writer) {
        for filter in &self.filters {
            filter.is_some().save(to);
            filter.iter().for_each(|filter| filter.save(to));
        }
        self.time.save(to);
        self.angles.save(to);
        self.deviations.save(to);
        self.innovation.save(to);
    }

    fn load(&mut self, from: &mut Reader) -> Result<(), SnapshotError> {
        for k in 0..self.pairs.len() {
            self.filters[k] = match loaded(from)? {
                false => None,
                true => {
                    // Any reading will do: all that it leaves is overwritten.
                    let reading = PairReading { inclination: [0.0; 2], rate: None, speeds: [[0.0; 2]; 2] };
                    let mut filter = PairFilter::new(self.model(&self.pairs[k]), &reading);
                    filter.load(from)?;
                    Some(filter)
                }
            };
        }
        self.time.load(from)?;
        self.angles.load(from)?;
        self.deviations.load(from)?;
        self.innovation.load(from)
    }
}

impl ContactAngles {
    /// An estimator before its first measurement; it uses wheel radius and geometry of the nominal rover.
    ///
    /// # Errors
    /// [`EstimationError`] where rover or parameters make no sense, or a wheel has no second point at a fixed distance
    /// whose motion is known.
    pub fn new(nominal: &Nominal, parameters: ContactAngleEstimation) -> Result<Self, EstimationError> {
        nominal.check()?;
        within_bounds("contact_angle", parameters)?;
        let pairs = pairs(nominal)?;
        Ok(Self {
            parameters,
            radius: nominal.wheel.radius,
            parents: nominal.links.iter().map(|link| link.parent).collect(),
            filters: vec![None; pairs.len()],
            pairs,
            time: None,
            angles: vec![0.0; nominal.wheels()],
            deviations: vec![parameters.angle_deviation; nominal.wheels()],
            innovation: Innovation::default(),
        })
    }

    /// Takes a measurement in; it allocates nothing. A second measurement of the same instant changes nothing. Readings
    /// that a slower sensor holds count as new ones, so this is to be called at the sensors' rate.
    ///
    /// # Errors
    /// [`EstimationError`] where the measurement is of another rover, from before the last, or a reading that is used
    /// is not finite; the estimate is then as it was.
    pub fn update(&mut self, measured: &Measurement) -> Result<(), EstimationError> {
        self.check(measured)?;
        let before = self.time.unwrap_or(measured.time);
        let dt = measured.time - before;
        if dt < 0.0 {
            return Err(EstimationError::Time { time: measured.time, before });
        }
        if self.time.is_some() && dt == 0.0 {
            return Ok(());
        }
        self.time = Some(measured.time);
        self.innovation = Innovation::default();
        for k in 0..self.pairs.len() {
            let reading = self.reading(k, measured);
            if let Some(filter) = &mut self.filters[k] {
                let Innovation { nis, count } = filter.step(dt, &reading);
                self.innovation.nis += nis;
                self.innovation.count += count;
            } else {
                self.filters[k] = Some(PairFilter::new(self.model(&self.pairs[k]), &reading));
            }
        }
        self.combine();
        Ok(())
    }

    /// Contact angles, one a wheel from rear to front, uphill positive, rad; 0 before the first measurement.
    #[must_use]
    pub fn angles(&self) -> &[f64] {
        &self.angles
    }

    /// Their standard deviations, rad.
    #[must_use]
    pub fn deviations(&self) -> &[f64] {
        &self.deviations
    }

    /// Innovation of the last update, summed over the pairs; nothing at the first.
    #[must_use]
    pub fn innovation(&self) -> Innovation {
        self.innovation
    }

    /// How often filters of pairs have lost their way and started anew.
    #[must_use]
    pub fn restarts(&self) -> u32 {
        self.filters.iter().flatten().map(PairFilter::restarts).sum()
    }

    /// Numbers of the wheels (from 1) that each pair consists of, rear and front; `None` is a joint.
    pub fn pairs(&self) -> impl Iterator<Item = [Option<usize>; 2]> {
        self.pairs.iter().map(|pair| {
            pair.points.map(|point| match point {
                Point::Wheel(wheel) => Some(wheel + 1),
                Point::Pivot { .. } => None,
            })
        })
    }

    /// Forgets all measurements.
    pub fn reset(&mut self) {
        self.filters.fill(None);
        self.time = None;
        self.angles.fill(0.0);
        self.deviations.fill(self.parameters.angle_deviation);
        self.innovation = Innovation::default();
    }

    fn check(&self, measured: &Measurement) -> Result<(), EstimationError> {
        let counts =
            [("wheels", self.angles.len(), measured.wheels.len()), ("links", self.parents.len(), measured.links.len())];
        for (what, expected, found) in counts {
            if expected != found {
                return Err(EstimationError::Count { what, expected, found });
            }
        }
        finite("time", None, measured.time)?;
        finite("pitch", None, measured.pitch)?;
        if self.has_gyroscope() {
            finite("pitch rate", None, measured.pitch_rate)?;
        }
        for (k, link) in measured.links.iter().enumerate() {
            finite("angle of link", Some(k), link.angle)?;
            finite("rate of link", Some(k), link.rate)?;
        }
        measured.wheels.iter().enumerate().try_for_each(|(k, wheel)| finite("speed of wheel", Some(k), wheel.speed))
    }

    fn has_gyroscope(&self) -> bool {
        self.parameters.pitch_rate_noise < NO_GYROSCOPE
    }

    fn model(&self, pair: &Pair) -> PairModel {
        let ContactAngleEstimation { rate_drift, speed_drift, angle_deviation, correlation_length, .. } =
            self.parameters;
        let kinematic_error = self.parameters.kinematic_error.hypot(self.parameters.slip_deviation);
        // Ground under two wheels is parallel to their line on the average; a line to a joint is inclined to it.
        let wheels = pair.points.iter().all(|point| matches!(point, Point::Wheel(_)));
        let offset = if wheels { 0.0 } else { pair.inclination };
        let distance = pair.distance;
        PairModel { distance, rate_drift, speed_drift, offset, angle_deviation, correlation_length, kinematic_error }
    }

    /// What is measured of a pair.
    fn reading(&self, k: usize, measured: &Measurement) -> PairReading {
        let pair = &self.pairs[k];
        let ContactAngleEstimation { pitch_noise, pitch_rate_noise, link_angle_noise, link_rate_noise, .. } =
            self.parameters;
        let factor = self.parameters.covariance_factor;
        let mut angle = [measured.pitch + pair.inclination, factor * pitch_noise * pitch_noise];
        let mut rate = [measured.pitch_rate, factor * pitch_rate_noise * pitch_rate_noise];
        let mut body = pair.body;
        while let Some(joint) = body.checked_sub(1) {
            angle[0] += measured.links[joint].angle;
            angle[1] += factor * link_angle_noise * link_angle_noise;
            rate[0] += measured.links[joint].rate;
            rate[1] += factor * link_rate_noise * link_rate_noise;
            body = self.parents[joint];
        }
        let measured_rate = self.has_gyroscope().then_some(rate);
        // Without a gyroscope the filter's own rate has to do.
        let turning = measured_rate.or_else(|| self.filters[k].map(|filter| filter.rate())).unwrap_or_default();
        let speeds = pair.points.map(|point| match point {
            Point::Wheel(wheel) => self.wheel_speed(measured.wheels[wheel].speed, turning),
            Point::Pivot { pair, place } => self.pivot_speed(pair, place),
        });
        PairReading { inclination: angle, rate: measured_rate, speeds }
    }

    /// Speed of a wheel's centre and its variance from an encoder's reading and the rate [value, variance] of the body.
    fn wheel_speed(&self, encoder: f64, rate: [f64; 2]) -> [f64; 2] {
        let ContactAngleEstimation { wheel_speed_noise, slip, covariance_factor, .. } = self.parameters;
        // The soil sees the absolute rate of the wheel; nose up is against rolling forward.
        let rim = self.radius * (encoder - rate[0]);
        let keeps = (1.0 - slip) * self.radius;
        let noise = keeps * keeps * (covariance_factor * wheel_speed_noise * wheel_speed_noise + rate[1]);
        [(1.0 - slip) * rim, noise]
    }

    /// Speed of a joint and its variance from the filter of a pair on one of its bodies.
    fn pivot_speed(&self, pair: usize, place: [f64; 2]) -> [f64; 2] {
        let inclination = self.pairs[pair].inclination;
        self.filters[pair].map_or([0.0; 2], |filter| filter.speed_of(place, inclination))
    }

    /// Angles of the wheels from those of the pairs.
    fn combine(&mut self) {
        for wheel in 0..self.angles.len() {
            let (mut weights, mut sum, mut spread) = (0.0, 0.0, 0.0);
            for (pair, filter) in self.pairs.iter().zip(&self.filters) {
                let place = pair.points.iter().position(|point| *point == Point::Wheel(wheel));
                let (Some(place), Some(filter)) = (place, filter) else { continue };
                let [angle, deviation] = filter.angle(place);
                let weight = (deviation * deviation).max(f64::MIN_POSITIVE).recip();
                weights += weight;
                sum += weight * angle;
                spread += weight * deviation;
            }
            self.angles[wheel] = sum / weights;
            self.deviations[wheel] = spread / weights;
        }
    }
}
