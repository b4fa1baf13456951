//! A DC motor with gear at each wheel (4.6-4.10).

use crate::effects::{Effects, ExpressionFailure};
use crate::scalar::Scalar;
use crate::snapshot::moving_beside;
use bekker_modeldescription::{Unit, parameters};

parameters! {
    /// Drive of one wheel; all wheels have the same.
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
    }
}

moving_beside!(Motor { gear_ratio, torque_constant, resistance, inverse_torque_limit, inverse_current_limit });

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

/// What a drive of the data sheet `motor` gives where the `actual` motor is another and `command` is asked of it.
///
/// # Errors
/// [`ExpressionFailure`] where a friction of the user's own is not finite.
#[cfg_attr(feature = "batch", inline(always))]
pub fn drive<S: Scalar>(
    motor: &Motor<S>,
    actual: &Motor<S>,
    effects: &Effects<S>,
    speed: S,
    command: S,
) -> Result<Driven<S>, ExpressionFailure> {
    let (motor_torque, limit_slope) = limited_torque(motor, actual, effects, speed, command);
    let (behind_gear, slope) = match effects.gear_efficiency.output(speed, motor_torque) {
        None => (motor_torque, limit_slope),
        Some(geared) => (geared.torque, geared.by_torque * limit_slope + geared.by_speed),
    };
    let (friction, friction_slope) = effects.drive_friction(speed)?;
    Ok(Driven { motor_torque, rim_torque: behind_gear - friction, slope: slope - friction_slope })
}

/// Torque of the motor, wheel side, that gives `rim_torque` at this wheel speed: the inverse of [`drive`], without
/// its limits.
///
/// # Errors
/// [`ExpressionFailure`] where a friction of the user's own is not finite.
#[cfg_attr(feature = "batch", inline(always))]
pub fn torque_behind<S: Scalar>(effects: &Effects<S>, speed: S, rim_torque: S) -> Result<S, ExpressionFailure> {
    let behind_gear = rim_torque + effects.drive_friction(speed)?.0;
    Ok(effects.gear_efficiency.input(speed, behind_gear).unwrap_or(behind_gear))
}

/// Torque that the motor gives when `torque` is asked of it at this wheel speed, wheel side, N m: within
/// the torque limit (4.14), the current limit and what the effects allow (supply voltage). Also its slope in
/// the speed, N m s/rad, which is steep where the back-EMF limits it.
#[cfg_attr(feature = "batch", inline(always))]
fn limited_torque<S: Scalar>(motor: &Motor<S>, actual: &Motor<S>, effects: &Effects<S>, speed: S, torque: S) -> (S, S) {
    let mut given = torque;
    let mut clamp = |inverse: S, unit: S| {
        if !inverse.is_exactly(0.0) {
            let limit = unit / inverse;
            given = given.smaller(limit).larger(-limit);
        }
    };
    // The drive's own limits, in the torque that it reckons with.
    clamp(motor.inverse_torque_limit, S::from(1.0));
    clamp(motor.inverse_current_limit, motor.gear_ratio * motor.torque_constant);
    if let Some(gain) = effects.torque_gain() {
        given *= gain;
    }
    let slope = effects.motor_torque(actual, speed, &mut given);
    (given, slope)
}

/// Share of its limits that a drive of the data sheet `motor` has left where `torque` is asked of it: 1 without limits,
/// negative where one binds.
pub(crate) fn reserve<S: Scalar>(motor: &Motor<S>, actual: &Motor<S>, effects: &Effects<S>, speed: S, torque: S) -> S {
    let asked = torque.abs();
    let by_torque = asked * motor.inverse_torque_limit;
    let by_current = asked * motor.inverse_current_limit / (motor.gear_ratio * motor.torque_constant);
    let given = effects.torque_gain().map_or(torque, |gain| torque * gain);
    let by_voltage = effects.voltage_limit.share(actual, speed, given);
    S::from(1.0) - by_torque.larger(by_current).larger(by_voltage)
}

/// Motor current for a torque on the wheel's side of the gear: I = T / (N K_t) (4.7, 4.9), A.
#[cfg_attr(feature = "batch", inline(always))]
pub fn current<S: Scalar>(motor: &Motor<S>, torque: S) -> S {
    torque / (motor.gear_ratio * motor.torque_constant)
}
