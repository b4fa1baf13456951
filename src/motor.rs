//! A DC motor with gear at each wheel (4.6-4.10).

use crate::scalar::{LaneAccess, Scalar, lanes};
use crate::snapshot::Moving;
use bekker_modeldescription::{Unit, parameters};

parameters! {
    /// Drive of one wheel; all wheels have the same.
    #[derive(Moving, LaneAccess)]
    pub struct Motor {
        /// Gear ratio, motor turns a wheel turn; the N_i of (4.9).
        gear_ratio: [Unit::ONE] = 100.0, 1.0..=5000.0, Fixed, "assumption, not in the thesis: usual for small rovers";
        /// Torque constant K_t, motor side (4.7).
        torque_constant: [Unit::NEWTON_METRE_PER_AMPERE] = 0.0234, 1e-4..=1.0, Fixed, "assumption: a 20 W, 24 V brushed motor of 25 mm";
        /// Winding resistance R (4.6).
        resistance: [Unit::OHM] = 2.32, 1e-3..=1e3, Fixed, "assumption: a 20 W, 24 V brushed motor of 25 mm";
        /// One over the largest torque, wheel side; 0 is no limit (4.14).
        inverse_torque_limit: [Unit::PER_NEWTON_METRE] = 0.0, 0.0..=100.0, Fixed, "Iagnemma 2001 (4.14)";
        /// One over the largest current; 0 is no limit.
        inverse_current_limit: [Unit::PER_AMPERE] = 0.0, 0.0..=100.0, Fixed, "amplifier data";
        /// One over the supply voltage U, within which |R I + K_t N omega| stays; 0 is no limit.
        inverse_voltage: [Unit::PER_VOLT] = 0.0, 0.0..=10.0, Fixed, "supply data; the motors of the presets have 24 V";
    }
}

/// Share of the reachable torque above which a limit is near.
const NEAR: f64 = 0.5;

/// Torques that a motor can give at one wheel speed, wheel side, N m, and the slopes of both ends in the speed, N m s/rad.
#[derive(Clone, Copy, Debug)]
pub struct TorqueRange<S = f64> {
    /// The smallest.
    pub least: S,
    /// The largest.
    pub most: S,
    /// Slope of the smallest.
    pub least_slope: S,
    /// Slope of the largest.
    pub most_slope: S,
}

#[lanes]
impl<S: Scalar> TorqueRange<S> {
    /// What both allow.
    pub(crate) fn and(self, other: Self) -> Self {
        let (above, below) = (self.least.below(other.least), other.most.below(self.most));
        Self {
            least: S::select(above, other.least, self.least),
            least_slope: S::select(above, other.least_slope, self.least_slope),
            most: S::select(below, other.most, self.most),
            most_slope: S::select(below, other.most_slope, self.most_slope),
        }
    }

    /// The torque within the range that is nearest to `torque`, and its slope in the wheel speed.
    ///
    /// The integrator is told of the slope before an end binds: a step may run into it, and the slope that it is told
    /// changes nothing in the order of its error.
    fn nearest(&self, torque: S) -> (S, S) {
        let (most, least) = (self.most, self.least);
        let torque = torque.smaller(most).larger(least);
        let at_most = (most * NEAR).below(torque) | most.under(0.0);
        let at_least = torque.below(least * NEAR) | least.over(0.0);
        let slope = S::select(at_least, self.least_slope, S::from(0.0));
        (torque, S::select(at_most, self.most_slope, slope))
    }
}

/// Torque behind a gear, N m on the wheel's side, with its slopes in the torque before it and in the wheel speed.
#[derive(Clone, Copy, Debug)]
pub struct Geared<S = f64> {
    /// Torque behind the gear.
    pub torque: S,
    /// Slope in the torque before the gear.
    pub by_torque: S,
    /// Slope in the wheel speed, N m s/rad.
    pub by_speed: S,
}

/// What stands between the torque that a drive is asked for and the rim, torques on the wheel's side, N m. The ideal drive
/// has nothing of it; the effects say what a real one has.
pub trait Drivetrain<S: Scalar> {
    /// Why a value has no meaning.
    type Failure;

    /// True torque over the torque that the drive computes from its current; `None` where they are the same.
    fn torque_gain(&self) -> Option<S>;

    /// Torques that the motor can give at this wheel speed, rad/s; `None` without a limit.
    fn torque_range(&self, motor: &Motor<S>, speed: S) -> Option<TorqueRange<S>>;

    /// Share of that limit which `torque` takes; `None` without a limit.
    fn share_of_limit(&self, motor: &Motor<S>, speed: S, torque: S) -> Option<S>;

    /// Torque behind the gear for a `torque` before it, and its slope in the wheel speed where `slope` is that before it.
    fn gear(&self, speed: S, torque: S, slope: S) -> (S, S);

    /// Torque before the gear that gives `torque` behind it.
    fn gear_input(&self, speed: S, torque: S) -> S;

    /// Friction torque, positive against forward turning, and its slope in the wheel speed, N m s/rad.
    ///
    /// # Errors
    /// Where it is not finite.
    fn drive_friction(&self, speed: S) -> Result<(S, S), Self::Failure>;
}

/// What one drive gives at one instant; torques on the wheel's side of the gear, N m.
#[derive(Clone, Copy, Debug)]
pub struct Driven<S = f64> {
    /// Torque of the motor.
    pub motor_torque: S,
    /// Torque on the rim: what gear and friction leave.
    pub rim_torque: S,
    /// Slope of the rim's torque in the wheel speed, N m s/rad.
    pub slope: S,
}

/// What a drive of the data sheet `motor` gives at the wheel speed `speed` (rad/s) where the `actual` motor is another and
/// the torque `command` (N m) is asked of it.
///
/// # Errors
/// Where the friction is not finite.
#[lanes]
pub fn drive<S: Scalar, T: Drivetrain<S>>(
    motor: &Motor<S>,
    actual: &Motor<S>,
    train: &T,
    speed: S,
    command: S,
) -> Result<Driven<S>, T::Failure> {
    let (motor_torque, limit_slope) = limited_torque(motor, actual, train, speed, command);
    let (behind_gear, slope) = train.gear(speed, motor_torque, limit_slope);
    let (friction, friction_slope) = train.drive_friction(speed)?;
    Ok(Driven { motor_torque, rim_torque: behind_gear - friction, slope: slope - friction_slope })
}

/// Torque of the motor, wheel side, that gives `rim_torque` at this wheel speed: the inverse of [`drive`], without
/// its limits.
///
/// # Errors
/// Where the friction is not finite.
#[lanes]
pub fn torque_behind<S: Scalar, T: Drivetrain<S>>(train: &T, speed: S, rim_torque: S) -> Result<S, T::Failure> {
    let behind_gear = rim_torque + train.drive_friction(speed)?.0;
    Ok(train.gear_input(speed, behind_gear))
}

/// Torque that the motor gives when `torque` is asked of it at this wheel speed, wheel side, N m: within
/// the torque limit (4.14), the current limit, the supply voltage and what the drivetrain allows. Also its slope in
/// the speed, N m s/rad, which is steep where the back-EMF limits it.
#[lanes]
fn limited_torque<S: Scalar>(
    motor: &Motor<S>,
    actual: &Motor<S>,
    train: &impl Drivetrain<S>,
    speed: S,
    torque: S,
) -> (S, S) {
    let mut given = torque;
    let mut clamp = |inverse: S, unit: S| {
        if !inverse.is_exactly(0.0) {
            let limit = unit / inverse;
            given = given.smaller(limit).larger(-limit);
        }
    };
    // The drive's own limits, in the torque that it computes from its current.
    clamp(motor.inverse_torque_limit, S::from(1.0));
    clamp(motor.inverse_current_limit, motor.gear_ratio * motor.torque_constant);
    if let Some(gain) = train.torque_gain() {
        given *= gain;
    }
    let supplied = supply_range(actual, actual.inverse_voltage, speed);
    let range = match (train.torque_range(actual, speed), supplied) {
        (Some(train), Some(supplied)) => Some(train.and(supplied)),
        (range, None) | (None, range) => range,
    };
    match range {
        None => (given, S::from(0.0)),
        Some(range) => range.nearest(given),
    }
}

/// Torques that a motor gives within a supply voltage, of which `inverse_voltage` is the inverse, at this wheel speed; `None`
/// where that is 0, without a limit.
#[lanes]
pub(crate) fn supply_range<S: Scalar>(motor: &Motor<S>, inverse_voltage: S, speed: S) -> Option<TorqueRange<S>> {
    if inverse_voltage.is_exactly(0.0) {
        return None;
    }
    let voltage = inverse_voltage.recip();
    let constant = motor.gear_ratio * motor.torque_constant; // wheel side, N m/A = V s/rad
    let reachable = |sign: f64| constant * (voltage * sign - constant * speed) / motor.resistance;
    let slope = -(constant * constant / motor.resistance);
    Some(TorqueRange { least: reachable(-1.0), most: reachable(1.0), least_slope: slope, most_slope: slope })
}

/// Share of a supply voltage that `torque` takes at this wheel speed; `None` without a limit.
#[lanes]
pub(crate) fn share_of_supply<S: Scalar>(motor: &Motor<S>, inverse_voltage: S, speed: S, torque: S) -> Option<S> {
    if inverse_voltage.is_exactly(0.0) {
        return None;
    }
    let constant = motor.gear_ratio * motor.torque_constant;
    Some((torque / constant * motor.resistance + constant * speed).abs() * inverse_voltage)
}

/// Share of its limits that a drive of the data sheet `motor` has left where `torque` is asked of it: 1 without limits,
/// negative where one binds.
pub(crate) fn reserve<S: Scalar>(
    motor: &Motor<S>,
    actual: &Motor<S>,
    train: &impl Drivetrain<S>,
    speed: S,
    torque: S,
) -> S {
    let asked = torque.abs();
    let by_torque = asked * motor.inverse_torque_limit;
    let by_current = asked * motor.inverse_current_limit / (motor.gear_ratio * motor.torque_constant);
    let given = train.torque_gain().map_or(torque, |gain| torque * gain);
    let taken = by_torque.larger(by_current);
    let taken = train.share_of_limit(actual, speed, given).map_or(taken, |share| taken.larger(share));
    let supply = share_of_supply(actual, actual.inverse_voltage, speed, given);
    let taken = supply.map_or(taken, |share| taken.larger(share));
    S::from(1.0) - taken
}

/// Motor current for a torque on the wheel's side of the gear: I = T / (N K_t) (4.7, 4.9), A.
#[lanes]
pub fn current<S: Scalar>(motor: &Motor<S>, torque: S) -> S {
    torque / (motor.gear_ratio * motor.torque_constant)
}
