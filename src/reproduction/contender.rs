//! The controllers that chapter 4's studies compare.

use crate::model::{ControlKind, Model};

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

/// Velocity control first: the others are compared with it.
pub(super) const FIELD: &[Contender] = &[
    Contender { name: VELOCITY, apply: |model| with(model, ControlKind::Velocity), in_figures: true },
    Contender { name: RTC, apply: |model| with(model, ControlKind::Rtc), in_figures: true },
];

const VELOCITY: &str = "velocity control";
const RTC: &str = "RTC";

fn with(model: &mut Model, kind: ControlKind) {
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
