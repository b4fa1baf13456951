//! Contact angles of all wheels of a rover.

use super::filter::Innovation;
use super::pairs::{Pair, Point, all_stand, pairs};
use super::parameters::{ContactAngleEstimation, NO_GYROSCOPE};
use super::profile::{ProfileFilter, ProfileModel, ProfileReading};
use super::singly::PairFilters;
use crate::control::Nominal;
use crate::estimation::EstimationError;
use crate::estimation::error::{finite, within_bounds};
use crate::signals::Measurement;
use crate::snapshot::{Moving, Reader, SnapshotError, Writer};

/// Estimates the contact angles of all wheels from pitch, pitch rate, wheel speeds and the links' angles and rates.
///
/// Where all wheels stand on the ground wherever the rover is (two on a body, or each of them on a joint's far side),
/// they are taken to cross one ground ([`ProfileFilter`]). A body on three or more wheels stands on only some of them, and which
/// ones is not measured: its pairs are filtered each by itself ([`PairFilter`](super::PairFilter)).
///
/// Wheels on one body are paired with each other; a wheel that is alone on its body is paired with a joint, whose place
/// follows from the pair on the other side of it (2.6.2: the rear wheel of a rocker-bogie and the bogie's pivot).
#[derive(Clone, Debug)]
pub struct ContactAngles {
    parameters: ContactAngleEstimation,
    radius: f64,
    /// Body that carries each link's joint, and body that carries each wheel.
    parents: Vec<usize>,
    bodies: Vec<usize>,
    pairs: Vec<Pair>,
    filter: Filter,
    time: Option<f64>,
    angles: Vec<f64>,
    deviations: Vec<f64>,
    innovation: Innovation,
    /// What is read of the pairs and wheels, each with its variance.
    inclinations: Vec<[f64; 2]>,
    rates: Vec<[f64; 2]>,
    speeds: Vec<[f64; 2]>,
}

/// How the wheels' grounds belong together.
#[derive(Clone, Debug)]
enum Filter {
    /// They are one.
    Ground(Box<ProfileFilter>),
    /// Nothing is known of it.
    Pairs(PairFilters),
}

impl Moving for ContactAngles {
    fn save(&self, to: &mut Writer) {
        match &self.filter {
            Filter::Ground(filter) => filter.save(to),
            Filter::Pairs(filters) => filters.save(to),
        }
        self.time.save(to);
        self.angles.save(to);
        self.deviations.save(to);
        self.innovation.save(to);
    }

    fn load(&mut self, from: &mut Reader) -> Result<(), SnapshotError> {
        match &mut self.filter {
            Filter::Ground(filter) => filter.load(from)?,
            Filter::Pairs(filters) => filters.load(from)?,
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
        let filter = if all_stand(&pairs, nominal.wheels()) {
            Filter::Ground(Box::new(ProfileFilter::new(ground(nominal, &pairs, &parameters))))
        } else {
            Filter::Pairs(PairFilters::new(pairs.clone(), &parameters))
        };
        let wheels = nominal.wheels();
        Ok(Self {
            parameters,
            radius: nominal.wheel.radius,
            parents: nominal.links.iter().map(|link| link.parent).collect(),
            bodies: nominal.wheel_bodies.clone(),
            filter,
            time: None,
            angles: vec![0.0; wheels],
            deviations: vec![parameters.angle_deviation; wheels],
            innovation: Innovation::default(),
            inclinations: vec![[0.0; 2]; pairs.len()],
            rates: vec![[0.0; 2]; pairs.len()],
            speeds: vec![[0.0; 2]; wheels],
            pairs,
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
        let started = self.time.replace(measured.time).is_some();
        (0..self.pairs.len()).for_each(|k| self.read_pair(k, measured));
        for wheel in 0..self.speeds.len() {
            self.speeds[wheel] = self.wheel_speed(wheel, measured.wheels[wheel].speed);
        }
        let rates = self.has_gyroscope().then_some(self.rates.as_slice());
        let (inclinations, speeds) = (self.inclinations.as_slice(), self.speeds.as_slice());
        let reading = ProfileReading { inclinations, rates, speeds };
        self.innovation = match &mut self.filter {
            Filter::Ground(filter) if started => filter.step(dt, &reading),
            Filter::Ground(filter) => {
                filter.start(&reading);
                Innovation::default()
            }
            Filter::Pairs(filters) => filters.step(dt, inclinations, rates, speeds),
        };
        for wheel in 0..self.angles.len() {
            [self.angles[wheel], self.deviations[wheel]] = match &self.filter {
                Filter::Ground(filter) => filter.angle(wheel),
                Filter::Pairs(filters) => filters.angle(wheel),
            };
        }
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

    /// Innovation of the last update; nothing at the first.
    #[must_use]
    pub fn innovation(&self) -> Innovation {
        self.innovation
    }

    /// How often the filter has lost its way and started anew.
    #[must_use]
    pub fn restarts(&self) -> u32 {
        match &self.filter {
            Filter::Ground(filter) => filter.restarts(),
            Filter::Pairs(filters) => filters.restarts(),
        }
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
        if let Filter::Pairs(filters) = &mut self.filter {
            filters.reset();
        }
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

    /// What is measured of a pair.
    fn read_pair(&mut self, k: usize, measured: &Measurement) {
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
        // Without a gyroscope the filter's own rate has to do.
        if !self.has_gyroscope() {
            rate = match &self.filter {
                Filter::Ground(filter) => [filter.turning(k), 0.0],
                Filter::Pairs(filters) => filters.rate(k),
            };
        }
        self.inclinations[k] = angle;
        self.rates[k] = rate;
    }

    /// Speed of a wheel's rim past its centre and its variance, from an encoder's reading and the rate of the body.
    fn wheel_speed(&self, wheel: usize, encoder: f64) -> [f64; 2] {
        let ContactAngleEstimation { wheel_speed_noise, covariance_factor, .. } = self.parameters;
        let pair = self.pairs.iter().position(|pair| pair.body == self.bodies[wheel]);
        let rate = pair.map_or([0.0; 2], |pair| self.rates[pair]);
        // The soil sees the absolute rate of the wheel; nose up is against rolling forward.
        let rim = self.radius * (encoder - rate[0]);
        [rim, self.radius * self.radius * (covariance_factor * wheel_speed_noise * wheel_speed_noise + rate[1])]
    }
}

/// What is believed of the one ground.
fn ground(nominal: &Nominal, pairs: &[Pair], parameters: &ContactAngleEstimation) -> ProfileModel {
    let rearmost = nominal.wheel_centres.iter().map(|centre| centre[0]).fold(f64::MAX, f64::min);
    ProfileModel {
        pairs: pairs.to_vec(),
        places: nominal.wheel_centres.iter().map(|centre| centre[0] - rearmost).collect(),
        angle_deviation: parameters.angle_deviation,
        correlation_length: parameters.correlation_length,
        speed_drift: parameters.speed_drift,
        slip: parameters.slip,
        slip_deviation: parameters.slip_deviation,
        slip_length: parameters.slip_length,
        kinematic_error: parameters.kinematic_error,
        path_deviation: parameters.path_deviation,
        rate_error: parameters.rate_error,
    }
}
