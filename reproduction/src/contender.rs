//! The controllers that chapter 4's studies compare.

use bekker::model::{ContactAngleSource, ControlKind, Model, SoilSource};

/// A controller in the field.
pub(super) struct Contender {
    /// Its name in tables and legends.
    pub name: &'static str,
    /// Makes a model's wheels driven by it.
    pub apply: fn(&mut Model),
    /// Whether it is drawn in the thesis's figures, which have two lines.
    pub in_figures: bool,
}

/// Standard deviation of the sensors of 4.4.1: 5 % of the range in which the rover moves, at these ranges.
const PITCH_NOISE: f64 = 0.05 * 0.17;
const WHEEL_SPEED_NOISE: f64 = 0.05 * 2.5;

/// Velocity control first: the others are compared with it; then the thesis's RTC.
pub(super) const FIELD: &[Contender] = &[
    Contender { name: VELOCITY, apply: |model| with(model, ControlKind::Velocity), in_figures: true },
    Contender { name: RTC, apply: as_in_the_thesis, in_figures: true },
    Contender { name: "RTC, true contact angles", apply: |model| with(model, ControlKind::Rtc), in_figures: false },
    Contender { name: "RTC, soil identified on the way", apply: identifying, in_figures: false },
    Contender { name: "RTC holding its speed", apply: holding_speed, in_figures: false },
    Contender { name: RTC_SPEED, apply: by_wheel_speeds, in_figures: false },
    Contender {
        name: "velocity control, tuned to the plant",
        apply: |model| with(model, ControlKind::VelocityTuned),
        in_figures: false,
    },
    Contender { name: "equal torque", apply: |model| with(model, ControlKind::EqualTorque), in_figures: false },
    Contender { name: SLIP, apply: |model| with(model, ControlKind::Slip), in_figures: false },
];

pub(super) const VELOCITY: &str = "velocity control";
pub(super) const RTC: &str = "RTC";
pub(super) const RTC_SPEED: &str = "RTC with wheel-speed loops";
pub(super) const SLIP: &str = "slip control that receives the true slip";

/// RTC with wheel-speed loops, which have the gains of velocity control: the sensors of 4.4.1, contact angles estimated.
pub(super) fn by_wheel_speeds(model: &mut Model) {
    with(model, ControlKind::RtcSpeed);
    model.control.contact_angles = ContactAngleSource::Estimator;
}

/// RTC as section 4.4.1 has it: pitch and wheel speeds are measured, contact angles estimated from them, the soil known.
pub(super) fn as_in_the_thesis(model: &mut Model) {
    with(model, ControlKind::Rtc);
    model.control.contact_angles = ContactAngleSource::Estimator;
}

/// The same without knowing the soil: the data sheet's strength is a quarter too small until identified.
fn identifying(model: &mut Model) {
    as_in_the_thesis(model);
    let mut believed = model.rover.soil;
    believed.cohesion *= 0.75;
    believed.friction_angle = (0.75 * believed.friction_angle.tan()).atan();
    model.control.nominal_soil = Some(believed);
    model.control.soil = SoilSource::Estimator;
}

/// RTC with all that the thesis leaves out and the project offers: it makes up for the soil's resistance, integrates the
/// speed error, and each wheel's own loop (the gains of velocity control) keeps it within 20 % of the wanted speed.
pub(super) fn holding_speed(model: &mut Model) {
    as_in_the_thesis(model);
    let velocity = model.control.velocity;
    let rtc = &mut model.control.rtc;
    (rtc.resistance, rtc.integral_gain) = (1.0, 10.0);
    (rtc.speed_kp, rtc.speed_ki) = (velocity.kp, velocity.ki);
}

pub(super) fn with(model: &mut Model, kind: ControlKind) {
    model.control.kind = kind;
    model.sensors.body.pitch_noise = PITCH_NOISE;
    model.sensors.encoder.wheel_speed_noise = WHEEL_SPEED_NOISE;
}

/// What the thesis reports of the drive over benign terrain.
#[derive(Clone, Copy)]
pub(super) struct Published {
    /// Mean power, W.
    pub power: f64,
    /// Mean slip, %.
    pub slip: f64,
}

/// The figures of section 4.4.1 for the contender of this name.
pub(super) fn published(name: &str) -> Option<Published> {
    match name {
        VELOCITY => Some(Published { power: 4.7, slip: 9.4 }),
        RTC => Some(Published { power: 2.9, slip: 5.3 }),
        _ => None,
    }
}
