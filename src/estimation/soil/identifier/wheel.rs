//! One wheel as a source of readings: its motion, its averaged reading, and whether that carries information on the soil.

use super::super::super::EstimationError;
use super::super::filter::Update;
use super::super::kinematics::body_of;
use super::super::reading::{Deviations, Reading};
use super::super::sinkage::sinkage_under_load;
use super::{Scene, SoilIdentifier, Sums, WheelUse};

/// A slip, or a motion backward, counts where it is this many of its own standard deviations.
const SURE: f64 = 3.0;

/// Motion of one wheel over the ground.
struct Rolling {
    /// V, m/s.
    velocity: f64,
    /// r omega with the absolute rate, m/s.
    rim_speed: f64,
}

/// A wheel's mean readings that tell of the soil.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ready {
    mean: Sums,
    slip: f64,
    /// Standard deviation of the slip by the noise of the body's velocity, which all wheels share.
    by_velocity: f64,
    /// Standard deviation of the slip by the noise of the wheel's own encoder.
    by_encoder: f64,
}

impl Ready {
    /// Time of the first of the readings, s.
    pub fn since(&self) -> f64 {
        self.mean.since
    }
}

impl SoilIdentifier {
    /// Takes wheel `k`'s reading in; its mean where that is due and carries information, and otherwise the reason.
    pub(super) fn observe(&mut self, scene: &Scene, k: usize) -> Result<Ready, WheelUse> {
        if let Some(silent) = self.silent(scene, k) {
            self.sums[k] = Sums::default();
            return Err(silent);
        }
        let mean = self.averaged(scene, k).ok_or(WheelUse::Averaging)?;
        if self.accelerates(scene, &mean) {
            return Err(WheelUse::Accelerating);
        }
        let parameters = self.filter.parameters();
        let ratio = mean.velocity.max(0.0) / mean.rim_speed;
        let root = mean.count.sqrt();
        let by_velocity = parameters.velocity_noise / mean.rim_speed / root;
        let by_encoder = ratio * self.nominal.wheel.radius * parameters.wheel_speed_noise / mean.rim_speed / root;
        let slip = 1.0 - ratio;
        if slip < parameters.minimum_slip.max(SURE * by_velocity.hypot(by_encoder)) {
            return Err(WheelUse::NoSlip);
        }
        Ok(Ready { mean, slip, by_velocity, by_encoder })
    }

    /// What became of wheel `k`'s means, of which `sharing` wheels have the same noise of the body's velocity: each uses
    /// its share of that information, so that it does not count twice.
    pub(super) fn take(
        &mut self,
        scene: &Scene,
        k: usize,
        ready: &Ready,
        sharing: usize,
    ) -> Result<(WheelUse, Option<(Reading, Deviations)>), EstimationError> {
        let Ready { mean, slip, by_velocity, by_encoder } = *ready;
        let Some((sinkage, sinkage_deviation)) = self.sinkage(scene, k, mean.load, slip) else {
            return Ok((WheelUse::Sunk, None));
        };
        let parameters = *self.filter.parameters();
        let reading = Reading { load: mean.load, torque: mean.torque, sinkage, slip };
        // Errors that last count as one reading a correlation time.
        let step = self.read_at[k].map_or(f64::INFINITY, |before| scene.measured.time - before);
        let repeated = (parameters.correlation_time / step.max(f64::MIN_POSITIVE)).clamp(1.0, 1e12).sqrt();
        let errors = Deviations {
            load: parameters.load_error * mean.load * repeated,
            torque: parameters.torque_noise / mean.count.sqrt(),
            sinkage: sinkage_deviation * repeated,
            slip: by_encoder.hypot(by_velocity * (sharing as f64).sqrt()),
        };
        Ok((self.filtered(&reading, &errors)?, Some((reading, errors))))
    }

    /// Whether the body's acceleration over the averaging time is beyond its noise, and of the weight more than the loads'
    /// error: the balance that gives the loads has no inertia.
    fn accelerates(&self, scene: &Scene, mean: &Sums) -> bool {
        let time = scene.measured.time - mean.since;
        if time <= 0.0 {
            return false;
        }
        let parameters = self.filter.parameters();
        let noise = std::f64::consts::SQRT_2 * parameters.velocity_noise;
        let change = (scene.measured.velocity - mean.first_velocity).abs();
        change - SURE * noise > parameters.load_error * self.nominal.gravity * time
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
            first_velocity: if before.count > 0.0 { before.first_velocity } else { scene.measured.velocity },
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
}
