//! Where a rover's wheels are and how they move, from pitch and joint angles; and the sinkage that follows
//! ((2.27), (2.28)).

use super::super::EstimationError;
use super::super::error::{finite, same_count};
use crate::control::{ControlError, Nominal};
use crate::signals::Measurement;
use crate::snapshot::Moving;
use crate::vehicle::{MAX_COORDINATES, MAX_WHEELS};

/// Most passive joints of a rover: what is left of the coordinates without x, z and pitch.
pub(super) const MAX_LINKS: usize = MAX_COORDINATES - 3;

/// A body's attitude, and the point about which it was turned.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Placed {
    /// Joint that carries the body, from the chassis reference point along world axes, m.
    pub origin: [f64; 2],
    /// Velocity of that joint relative to the reference point, m/s.
    pub velocity: [f64; 2],
    /// The joint with all angles at zero, m.
    reference: [f64; 2],
    angle: f64,
    /// Rate, nose up, rad/s.
    pub rate: f64,
}

impl Placed {
    /// Place and velocity, relative to the reference point, of the point at `reference` with all angles at zero.
    pub fn carry(&self, reference: [f64; 2]) -> ([f64; 2], [f64; 2]) {
        let (sin, cos) = self.angle.sin_cos();
        let (dx, dz) = (reference[0] - self.reference[0], reference[1] - self.reference[1]);
        let (x, z) = (cos * dx - sin * dz, sin * dx + cos * dz);
        let place = [self.origin[0] + x, self.origin[1] + z];
        (place, [self.velocity[0] - self.rate * z, self.velocity[1] + self.rate * x])
    }
}

/// All bodies and wheel centres at one instant, relative to the chassis reference point along world axes.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Posture {
    /// 0 the chassis, k link k.
    pub bodies: [Placed; MAX_LINKS + 1],
    /// Wheel centres, m.
    pub centres: [[f64; 2]; MAX_WHEELS],
    /// Their velocities, m/s.
    pub velocities: [[f64; 2]; MAX_WHEELS],
}

/// The body that carries wheel `k`.
pub(super) fn body_of(nominal: &Nominal, k: usize) -> usize {
    nominal.wheel_bodies.get(k).copied().unwrap_or(0)
}

impl Posture {
    /// The posture that a measurement shows; its counts must be the nominal rover's.
    pub fn of(nominal: &Nominal, measured: &Measurement) -> Self {
        let mut posture = Self::default();
        posture.bodies[0] = Placed { angle: measured.pitch, rate: measured.pitch_rate, ..Placed::default() };
        for (j, (link, joint)) in nominal.links.iter().zip(&measured.links).enumerate() {
            let parent = posture.bodies[link.parent];
            let reference = [link.x, link.z];
            let (origin, velocity) = parent.carry(reference);
            let (angle, rate) = (parent.angle + joint.angle, parent.rate + joint.rate);
            posture.bodies[j + 1] = Placed { origin, velocity, reference, angle, rate };
        }
        for (k, &centre) in nominal.wheel_centres.iter().enumerate() {
            let (place, velocity) = posture.bodies[body_of(nominal, k)].carry(centre);
            posture.centres[k] = place;
            posture.velocities[k] = velocity;
        }
        posture
    }
}

/// Refuses a rover that makes no sense, or has more wheels than an estimator on board has room for.
pub(super) fn check_rover(nominal: &Nominal) -> Result<(), EstimationError> {
    nominal.check()?;
    if nominal.wheels() > MAX_WHEELS {
        let value = nominal.wheels() as f64;
        return Err(ControlError::Nominal { quantity: "number of wheels", value, expected: "2 to 8" }.into());
    }
    Ok(())
}

/// Refuses a measurement with readings that are missing or not finite.
pub(super) fn check_measurement(nominal: &Nominal, measured: &Measurement) -> Result<(), EstimationError> {
    same_count("wheels", nominal.wheels(), measured.wheels.len())?;
    same_count("joints", nominal.links.len(), measured.links.len())?;
    for (quantity, value) in [
        ("measured time", measured.time),
        ("measured pitch", measured.pitch),
        ("measured pitch rate", measured.pitch_rate),
        ("measured velocity", measured.velocity),
    ] {
        finite(quantity, None, value)?;
    }
    for (k, wheel) in measured.wheels.iter().enumerate() {
        finite("measured speed of wheel", Some(k), wheel.speed)?;
        finite("measured torque of wheel", Some(k), wheel.torque)?;
        finite("contact angle of wheel", Some(k), wheel.contact_angle)?;
    }
    for (j, joint) in measured.links.iter().enumerate() {
        finite("measured angle of joint", Some(j), joint.angle)?;
        finite("measured rate of joint", Some(j), joint.rate)?;
    }
    Ok(())
}

/// Change of one wheel's sinkage as the suspension shows it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SinkageChange {
    /// Mean over the loops, m.
    pub mean: f64,
    /// Standard deviation of the loops among themselves, m; 0 with one loop.
    pub spread: f64,
    /// Loops: other wheels that were compared with.
    pub loops: usize,
    /// Mean distance along x to those wheels, m: lever of an error of pitch.
    pub lever: f64,
}

/// Sinkage from changes of the suspension's configuration (2.27), (2.28): a wheel that digs itself in on flat ground
/// lowers its centre against the others'. Each other wheel closes one loop ((A.1)-(A.3) in the plane); the static
/// sinkage at the start is not observable this way.
#[derive(Clone, Debug, PartialEq, Moving)]
pub struct KinematicSinkage {
    #[not_moving]
    nominal: Nominal,
    heights: [f64; MAX_WHEELS],
}

impl KinematicSinkage {
    /// The configuration Q_1 at the start.
    ///
    /// # Errors
    /// [`EstimationError`] where the rover or the measurement makes no sense.
    pub fn from(nominal: &Nominal, start: &Measurement) -> Result<Self, EstimationError> {
        check_rover(nominal)?;
        check_measurement(nominal, start)?;
        let mut sinkage = Self::unstarted(nominal);
        sinkage.restart(start);
        Ok(sinkage)
    }

    /// Without a start yet.
    pub(super) fn unstarted(nominal: &Nominal) -> Self {
        Self { nominal: nominal.clone(), heights: [0.0; MAX_WHEELS] }
    }

    pub(super) fn restart(&mut self, start: &Measurement) {
        self.heights = Posture::of(&self.nominal, start).centres.map(|centre| centre[1]);
    }

    /// How much deeper wheel `wheel` (0 at the rear) has sunk since Q_1 than the wheels for which `still` holds, which
    /// are taken not to have sunk. `None` without any such wheel.
    ///
    /// # Errors
    /// [`EstimationError`] where the measurement makes no sense.
    pub fn change(
        &self,
        measured: &Measurement,
        wheel: usize,
        still: impl Fn(usize) -> bool,
    ) -> Result<Option<SinkageChange>, EstimationError> {
        check_measurement(&self.nominal, measured)?;
        same_count("wheels", self.nominal.wheels(), measured.wheels.len())?;
        if wheel >= self.nominal.wheels() {
            let expected = self.nominal.wheels();
            return Err(EstimationError::Count { what: "wheels", expected, found: wheel + 1 });
        }
        Ok(self.change_in(&Posture::of(&self.nominal, measured), wheel, still))
    }

    pub(super) fn change_in(
        &self,
        posture: &Posture,
        wheel: usize,
        still: impl Fn(usize) -> bool,
    ) -> Option<SinkageChange> {
        let rise = |k: usize| posture.centres[k][1] - self.heights[k];
        let others = || (0..self.nominal.wheels()).filter(|&k| k != wheel && still(k));
        let loops = others().count();
        if loops == 0 {
            return None;
        }
        let count = loops as f64;
        let mean = others().map(|k| rise(k) - rise(wheel)).sum::<f64>() / count;
        let variance = others().map(|k| (rise(k) - rise(wheel) - mean).powi(2)).sum::<f64>() / count;
        let lever = others().map(|k| (posture.centres[k][0] - posture.centres[wheel][0]).abs()).sum::<f64>() / count;
        Some(SinkageChange { mean, spread: variance.sqrt(), loops, lever })
    }
}
