//! The models of NIST's 27 problems, as stated in their files: b1 is `b[0]`.

use num_dual::{Dual64, DualNum};
use std::f64::consts::{PI, TAU};

/// Prediction at the predictors `x` with the parameters `b`.
pub(super) type ModelFunction = fn(&[Dual64], &[f64]) -> Dual64;

/// By the name of the problem's file.
pub(super) const MODELS: [(&str, ModelFunction); 27] = [
    ("bennett5", |b, x| b[0] * (b[1] + x[0]).powd(-b[2].recip())),
    ("boxbod", saturating),
    ("chwirut1", ultrasonic),
    ("chwirut2", ultrasonic),
    ("danwood", |b, x| b[0] * Dual64::from(x[0]).powd(b[1])),
    ("eckerle4", |b, x| b[0] / b[1] * (((-b[2] + x[0]) / b[1]).powi(2) * -0.5).exp()),
    ("enso", |b, x| {
        let year = Dual64::from(12.0);
        b[0] + wave(b[1], b[2], year, x[0]) + wave(b[4], b[5], b[3], x[0]) + wave(b[7], b[8], b[6], x[0])
    }),
    ("gauss1", two_peaks),
    ("gauss2", two_peaks),
    ("gauss3", two_peaks),
    ("hahn1", |b, x| polynomial(&b[..4], x[0]) / (polynomial(&b[4..], x[0]) * x[0] + 1.0)),
    ("kirby2", |b, x| polynomial(&b[..3], x[0]) / (polynomial(&b[3..], x[0]) * x[0] + 1.0)),
    ("lanczos1", three_decays),
    ("lanczos2", three_decays),
    ("lanczos3", three_decays),
    ("mgh09", |b, x| b[0] * (b[1] * x[0] + x[0] * x[0]) / (b[2] * x[0] + b[3] + x[0] * x[0])),
    ("mgh10", |b, x| b[0] * (b[1] / (b[2] + x[0])).exp()),
    ("mgh17", |b, x| b[0] + decay(b[1], b[3], x[0]) + decay(b[2], b[4], x[0])),
    ("misra1a", saturating),
    ("misra1b", |b, x| b[0] * (-(b[1] * x[0] / 2.0 + 1.0).powi(-2) + 1.0)),
    ("misra1c", |b, x| b[0] * (-(b[1] * x[0] * 2.0 + 1.0).powf(-0.5) + 1.0)),
    ("misra1d", |b, x| b[0] * b[1] * x[0] / (b[1] * x[0] + 1.0)),
    ("nelson", |b, x| b[0] - decay(b[1], b[2], x[1]) * x[0]),
    ("rat42", |b, x| b[0] / ((b[1] - b[2] * x[0]).exp() + 1.0)),
    ("rat43", |b, x| b[0] / ((b[1] - b[2] * x[0]).exp() + 1.0).powd(b[3].recip())),
    ("roszman1", |b, x| b[0] - b[1] * x[0] - (b[2] / (-b[3] + x[0])).atan() / PI),
    ("thurber", |b, x| polynomial(&b[..4], x[0]) / (polynomial(&b[4..], x[0]) * x[0] + 1.0)),
];

fn saturating(b: &[Dual64], x: &[f64]) -> Dual64 {
    b[0] * (-(-b[1] * x[0]).exp() + 1.0)
}

fn ultrasonic(b: &[Dual64], x: &[f64]) -> Dual64 {
    (-b[0] * x[0]).exp() / (b[1] + b[2] * x[0])
}

fn two_peaks(b: &[Dual64], x: &[f64]) -> Dual64 {
    let peak = |height: Dual64, place: Dual64, width: Dual64| height * (-((-place + x[0]) / width).powi(2)).exp();
    decay(b[0], b[1], x[0]) + peak(b[2], b[3], b[4]) + peak(b[5], b[6], b[7])
}

fn three_decays(b: &[Dual64], x: &[f64]) -> Dual64 {
    decay(b[0], b[1], x[0]) + decay(b[2], b[3], x[0]) + decay(b[4], b[5], x[0])
}

fn decay(height: Dual64, rate: Dual64, x: f64) -> Dual64 {
    height * (-rate * x).exp()
}

fn wave(cosine: Dual64, sine: Dual64, period: Dual64, x: f64) -> Dual64 {
    let angle = period.recip() * (TAU * x);
    cosine * angle.cos() + sine * angle.sin()
}

/// c1 + c2 x + c3 x^2 + ...
fn polynomial(coefficients: &[Dual64], x: f64) -> Dual64 {
    coefficients.iter().rev().fold(Dual64::from(0.0), |sum, c| sum * x + c)
}
