//! Identification in the loop: from a rover's sensors to readings of driven wheels to the soil (2.3.2).
//!
//! Of each wheel: the load from the quasi-static balance; the slip from its encoder and the body's measured velocity,
//! carried to the wheel by pitch and joint rates; the sinkage from the change of the suspension's configuration since
//! [`SoilIdentifier::start_experiment`] while the ground is flat and another wheel does not slip, and otherwise from
//! the load on the nominal moduli ([`sinkage_under_load`]). Readings are averaged over a short time before they are
//! used, so that their noise stays small beside the curvature of the soil's equations. A wheel that stands, rolls backward, hardly slips or
//! hardly carries says nothing, and the estimate stays as it is.

use super::super::EstimationError;
use super::directions::Direction;
use super::filter::{StrengthFilter, Update};
use super::kinematics::{KinematicSinkage, Posture, body_of, check_measurement, check_structure};
use super::loads::QuasiStatic;
use super::parameters::SoilIdentification;
use super::reading::{Deviations, Reading, Strength};
use super::sinkage::sinkage_under_load;
use crate::control::Nominal;
use crate::rover::MAX_WHEELS;
use crate::signals::Measurement;
use crate::soil::Soil;

/// A slip, or a motion backward, counts where it is this many of its own standard deviations.
const SURE: f64 = 3.0;

/// What one wheel contributed to the last update.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum WheelUse {
    /// There has been no update.
    #[default]
    Unread,
    /// Its readings are being averaged.
    Averaging,
    /// It stands.
    Standing,
    /// It turns or moves backward.
    Reversing,
    /// It carries less than the least load.
    OffGround,
    /// It slips less than the least slip, or less than the sensors can tell.
    NoSlip,
    /// No sinkage above the axle carries its load.
    Sunk,
    /// Its torque missed the prediction by more than the gate; the normalised innovation squared.
    Refused(f64),
    /// It was used; the normalised innovation squared.
    Used(f64),
}

/// The configuration at the start of an identification experiment.
#[derive(Clone, Debug, PartialEq)]
struct Start {
    kinematics: KinematicSinkage,
    /// Sinkages then, from the loads, m.
    sinkage: [f64; MAX_WHEELS],
    /// Distance travelled since, m.
    travelled: f64,
}

/// What the update of one wheel needs of the rest.
struct Scene<'a> {
    measured: &'a Measurement,
    posture: Posture,
    loads: [f64; MAX_WHEELS],
    /// Velocity of the reference point, m/s.
    velocity: [f64; 2],
}

/// Motion of one wheel over the ground.
struct Rolling {
    /// V, m/s.
    velocity: f64,
    /// r omega with the absolute rate, m/s.
    rim_speed: f64,
}

/// Readings of one wheel on the way to their mean.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Sums {
    count: f64,
    /// Time of the first one, s.
    since: f64,
    load: f64,
    torque: f64,
    velocity: f64,
    rim_speed: f64,
}

/// The soil's strength from a rover's sensors.
#[derive(Clone, Debug, PartialEq)]
pub struct SoilIdentifier {
    nominal: Nominal,
    balance: QuasiStatic,
    filter: StrengthFilter,
    start: Option<Start>,
    time: Option<f64>,
    /// Distance travelled since a reading was last used, m.
    travelled: f64,
    read_at: [Option<f64>; MAX_WHEELS],
    sums: [Sums; MAX_WHEELS],
    uses: [WheelUse; MAX_WHEELS],
    readings: [Option<(Reading, Deviations)>; MAX_WHEELS],
}

impl SoilIdentifier {
    /// An identifier whose prior is the nominal rover's soil.
    ///
    /// # Errors
    /// [`EstimationError`] where the rover or a parameter makes no sense.
    pub fn new(nominal: &Nominal, parameters: SoilIdentification) -> Result<Self, EstimationError> {
        check_structure(nominal)?;
        Ok(Self {
            balance: QuasiStatic::new(nominal)?,
            filter: StrengthFilter::new(&nominal.wheel, &nominal.soil, parameters)?,
            nominal: nominal.clone(),
            start: None,
            time: None,
            travelled: 0.0,
            read_at: [None; MAX_WHEELS],
            sums: [Sums::default(); MAX_WHEELS],
            uses: [WheelUse::Unread; MAX_WHEELS],
            readings: [None; MAX_WHEELS],
        })
    }

    /// Takes the present configuration as that of an experiment's start, from which sinkages are measured.
    ///
    /// # Errors
    /// [`EstimationError`] where a reading makes no sense; an earlier start is then kept.
    pub fn start_experiment(&mut self, measured: &Measurement) -> Result<(), EstimationError> {
        let kinematics = KinematicSinkage::from(&self.nominal, measured)?;
        let loads = self.balance.loads(&self.nominal, &Posture::of(&self.nominal, measured), measured)?;
        let soil = self.soil();
        let sinkage = loads.map(|load| sinkage_under_load(&self.nominal.wheel, &soil, load, 0.0).unwrap_or(0.0));
        self.start = Some(Start { kinematics, sinkage, travelled: 0.0 });
        Ok(())
    }

    /// Takes sinkages from the loads again.
    pub fn end_experiment(&mut self) {
        self.start = None;
    }

    /// Takes one measurement; [`SoilIdentifier::uses`] tells what became of each wheel.
    ///
    /// # Errors
    /// [`EstimationError`] where a reading is missing or not finite; the estimate has not changed then.
    pub fn update(&mut self, measured: &Measurement) -> Result<(), EstimationError> {
        check_measurement(&self.nominal, measured)?;
        let posture = Posture::of(&self.nominal, measured);
        let loads = self.balance.loads(&self.nominal, &posture, measured)?;
        let velocity = velocity_of_reference(&self.nominal, &posture, measured);
        let scene = Scene { measured, posture, loads, velocity };
        self.travel(measured);
        let before = (self.filter.clone(), self.travelled);
        for k in 0..self.nominal.wheels() {
            match self.read(&scene, k) {
                Ok((used, reading)) => {
                    self.uses[k] = used;
                    self.readings[k] = reading;
                    if reading.is_some() {
                        self.read_at[k] = Some(measured.time);
                    }
                }
                Err(error) => {
                    (self.filter, self.travelled) = before;
                    return Err(error);
                }
            }
        }
        Ok(())
    }

    fn travel(&mut self, measured: &Measurement) {
        let step = self.time.map_or(0.0, |before| (measured.time - before).max(0.0));
        let distance = measured.velocity.abs() * step;
        self.time = Some(measured.time);
        self.travelled += distance;
        if let Some(start) = &mut self.start {
            start.travelled += distance;
        }
    }

    /// What wheel `k` says, and its use by the filter.
    fn read(&mut self, scene: &Scene, k: usize) -> Result<(WheelUse, Option<(Reading, Deviations)>), EstimationError> {
        if let Some(silent) = self.silent(scene, k) {
            self.sums[k] = Sums::default();
            return Ok((silent, None));
        }
        let Some(mean) = self.averaged(scene, k) else {
            return Ok((WheelUse::Averaging, None));
        };
        let parameters = *self.filter.parameters();
        let (slip, slip_deviation) = self.slip(mean.velocity.max(0.0), mean.rim_speed);
        let slip_deviation = slip_deviation / mean.count.sqrt();
        if slip < parameters.minimum_slip.max(SURE * slip_deviation) {
            return Ok((WheelUse::NoSlip, None));
        }
        let Some((sinkage, sinkage_deviation)) = self.sinkage(scene, k, mean.load, slip) else {
            return Ok((WheelUse::Sunk, None));
        };
        let reading = Reading { load: mean.load, torque: mean.torque, sinkage, slip };
        // Errors that last count as one reading a correlation time.
        let step = self.read_at[k].map_or(f64::INFINITY, |before| scene.measured.time - before);
        let repeated = (parameters.correlation_time / step.max(f64::MIN_POSITIVE)).clamp(1.0, 1e12).sqrt();
        let errors = Deviations {
            load: parameters.load_error * mean.load * repeated,
            torque: parameters.torque_noise / mean.count.sqrt(),
            sinkage: sinkage_deviation * repeated,
            slip: slip_deviation,
        };
        Ok((self.filtered(&reading, &errors)?, Some((reading, errors))))
    }

    /// Why wheel `k` says nothing at this instant, if so.
    fn silent(&self, scene: &Scene, k: usize) -> Option<WheelUse> {
        let parameters = self.filter.parameters();
        let Rolling { velocity, rim_speed } = self.rolling(scene, k);
        let least_load = parameters.minimum_load * self.nominal.weight() / self.nominal.wheels() as f64;
        if rim_speed.abs().max(velocity.abs()) < parameters.minimum_speed {
            Some(WheelUse::Standing)
        } else if rim_speed <= 0.0 || velocity < -SURE * parameters.velocity_noise {
            Some(WheelUse::Reversing)
        } else {
            (scene.loads[k] <= least_load).then_some(WheelUse::OffGround)
        }
    }

    /// The means of wheel `k` where its averaging time is over; nothing is left out by its noise, which would bias them.
    fn averaged(&mut self, scene: &Scene, k: usize) -> Option<Sums> {
        let Rolling { velocity, rim_speed } = self.rolling(scene, k);
        let time = scene.measured.time;
        let before = self.sums[k];
        let sums = Sums {
            count: before.count + 1.0,
            since: if before.count > 0.0 { before.since } else { time },
            load: before.load + scene.loads[k],
            torque: before.torque + scene.measured.wheels[k].torque,
            velocity: before.velocity + velocity,
            rim_speed: before.rim_speed + rim_speed,
        };
        // n readings span n - 1 of the times between them.
        let spanned = (time - sums.since) * sums.count / (sums.count - 1.0).max(1.0);
        if spanned < self.filter.parameters().averaging * (1.0 - 1e-9) {
            self.sums[k] = sums;
            return None;
        }
        self.sums[k] = Sums::default();
        let mean = |sum: f64| sum / sums.count;
        Some(Sums {
            load: mean(sums.load),
            torque: mean(sums.torque),
            velocity: mean(sums.velocity),
            rim_speed: mean(sums.rim_speed),
            ..sums
        })
    }

    fn filtered(&mut self, reading: &Reading, errors: &Deviations) -> Result<WheelUse, EstimationError> {
        let mut filter = self.filter.clone();
        filter.forget(self.travelled);
        Ok(match filter.update(reading, errors)? {
            Update::Refused { nis } => WheelUse::Refused(nis),
            Update::Used { nis } => {
                self.filter = filter;
                self.travelled = 0.0;
                WheelUse::Used(nis)
            }
        })
    }

    fn rolling(&self, scene: &Scene, k: usize) -> Rolling {
        let (sin, cos) = scene.measured.wheels[k].contact_angle.sin_cos();
        let own = scene.posture.velocities[k];
        let velocity = (scene.velocity[0] + own[0]) * cos + (scene.velocity[1] + own[1]) * sin;
        let spin = scene.measured.wheels[k].speed - scene.posture.bodies[body_of(&self.nominal, k)].rate;
        Rolling { velocity, rim_speed: self.nominal.wheel.radius * spin }
    }

    /// Slip and its standard deviation.
    fn slip(&self, velocity: f64, rim_speed: f64) -> (f64, f64) {
        let parameters = self.filter.parameters();
        let ratio = velocity / rim_speed;
        let rim_noise = ratio * self.nominal.wheel.radius * parameters.wheel_speed_noise;
        (1.0 - ratio, parameters.velocity_noise.hypot(rim_noise) / rim_speed)
    }

    /// Sinkage and its standard deviation, m: the better known of that from the suspension and that from the load.
    fn sinkage(&self, scene: &Scene, k: usize, load: f64, slip: f64) -> Option<(f64, f64)> {
        let parameters = self.filter.parameters();
        let by_load = sinkage_under_load(&self.nominal.wheel, &self.soil(), load, slip)
            .map(|z| (z, parameters.sinkage_error * z));
        let by_suspension = self.sinkage_by_suspension(scene, k);
        let best = match (by_load, by_suspension) {
            (Some(load), Some(suspension)) => Some(if suspension.1 < load.1 { suspension } else { load }),
            (one, other) => other.or(one),
        };
        best.filter(|(z, _)| *z > 0.0 && *z < self.nominal.wheel.radius)
    }

    fn sinkage_by_suspension(&self, scene: &Scene, k: usize) -> Option<(f64, f64)> {
        let start = self.start.as_ref()?;
        let parameters = self.filter.parameters();
        let angles = || scene.measured.wheels.iter().map(|wheel| wheel.contact_angle);
        let spread = angles().fold(f64::NEG_INFINITY, f64::max) - angles().fold(f64::INFINITY, f64::min);
        if spread > parameters.flatness {
            return None;
        }
        let still = |other: usize| {
            let Rolling { velocity, rim_speed } = self.rolling(scene, other);
            rim_speed > 0.0 && self.slip(velocity, rim_speed).0 < parameters.minimum_slip
        };
        let change = start.kinematics.change_in(&scene.posture, k, still)?;
        let at_start = start.sinkage[k];
        // Pitch and joints err at the start and now.
        let angle = std::f64::consts::SQRT_2 * parameters.angle_noise * change.lever;
        let ground = parameters.ground_error * start.travelled;
        let deviation = angle.hypot(ground).hypot(parameters.sinkage_error * at_start).hypot(change.spread);
        Some((at_start + change.mean, deviation))
    }

    /// The nominal soil with the estimated strength.
    #[must_use]
    pub fn soil(&self) -> Soil {
        self.strength().on(&self.nominal.soil)
    }

    /// The estimated strength within the soil's bounds.
    #[must_use]
    pub fn strength(&self) -> Strength {
        self.filter.strength()
    }

    /// Covariance of c (Pa), phi (rad) and ln K.
    #[must_use]
    pub fn covariance(&self) -> [[f64; 3]; 3] {
        self.filter.covariance()
    }

    /// Combinations of c, phi and ln K, the best settled first.
    #[must_use]
    pub fn directions(&self) -> [Direction; 3] {
        self.filter.directions()
    }

    /// What became of each wheel in the last update.
    #[must_use]
    pub fn uses(&self) -> &[WheelUse] {
        self.uses.get(..self.nominal.wheels()).unwrap_or(&self.uses)
    }

    /// Whether any wheel told anything in the last update.
    #[must_use]
    pub fn informed(&self) -> bool {
        self.uses().iter().any(|used| matches!(used, WheelUse::Used(_)))
    }

    /// The last update's reading of wheel `wheel` (0 at the rear) and its errors, `None` where it told nothing.
    #[must_use]
    pub fn reading(&self, wheel: usize) -> Option<(Reading, Deviations)> {
        self.readings.get(wheel).copied().flatten()
    }
}

/// Velocity of the reference point (m/s) along world axes: its measured speed in the direction in which every wheel
/// centre moves along its ground, as the mean over the wheels.
fn velocity_of_reference(nominal: &Nominal, posture: &Posture, measured: &Measurement) -> [f64; 2] {
    let speed = measured.velocity;
    let direction = |k: usize, contact_angle: f64| {
        let (sin, cos) = contact_angle.sin_cos();
        let own = posture.velocities[k];
        // n (v + own) = 0 with v = speed (cos, sin) of the direction: speed sin(direction - gamma) = -n own.
        let along_normal = cos * own[1] - sin * own[0];
        let turned = if speed == 0.0 { 0.0 } else { (-along_normal / speed).clamp(-1.0, 1.0).asin() };
        contact_angle + turned
    };
    let sum: f64 = measured.wheels.iter().enumerate().map(|(k, wheel)| direction(k, wheel.contact_angle)).sum();
    let (sin, cos) = (sum / nominal.wheels() as f64).sin_cos();
    [speed * cos, speed * sin]
}
