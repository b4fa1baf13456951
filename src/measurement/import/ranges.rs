//! What the sizes of values say of their unit.

use super::super::experiment::Kind;

/// Sizes of which a column is made.
struct Sizes {
    largest: f64,
    /// Middle of the sizes.
    typical: f64,
}

impl Sizes {
    fn of(values: &[f64]) -> Self {
        let mut sizes: Vec<f64> = values.iter().map(|value| value.abs()).collect();
        sizes.sort_by(f64::total_cmp);
        let at = |k: usize| sizes.get(k).copied().unwrap_or(0.0);
        Self { largest: at(sizes.len().saturating_sub(1)), typical: at(sizes.len() / 2) }
    }
}

/// The unit that a signal's values are likely to have; `None` where they fit SI.
pub(super) fn unit(kind: Kind, signal: &str, values: &[f64]) -> Option<&'static str> {
    let field = signal.rsplit('.').next().unwrap_or(signal);
    let Sizes { largest, typical } = Sizes::of(values);
    match field {
        // A slip is within -1 .. 1; noise may carry it a little beyond.
        "slip" => (largest > 1.5).then_some("%"),
        // Wheels sink by millimetres to centimetres.
        "sinkage" => (typical > 0.5).then_some("mm"),
        // Beyond 86 degrees a rover has fallen over.
        "pitch" | "contact_angle" | "angle" => (largest > 1.5).then_some("deg"),
        // Motors of rovers take amperes.
        "current" => (typical > 100.0).then_some("mA"),
        "time" => rows_apart(values),
        _ => kind.format().likely_unit(field, largest),
    }
}

/// Rows of a drive are milliseconds to seconds apart.
fn rows_apart(times: &[f64]) -> Option<&'static str> {
    let steps: Vec<f64> = times.windows(2).map(|pair| pair[1] - pair[0]).collect();
    match Sizes::of(&steps).typical {
        step if step > 5e6 => Some("ns"),
        step if step > 5e3 => Some("us"),
        step if step > 5.0 => Some("ms"),
        _ => None,
    }
}

/// Whether a sinkage is counted upward: all of it is negative.
pub(super) fn upward(values: &[f64]) -> bool {
    !values.is_empty() && values.iter().all(|value| *value <= 0.0) && values.iter().any(|value| *value < 0.0)
}

/// Whether a pull falls with slip: the correlation is clearly negative.
pub(in crate::measurement) fn falls(slip: &[f64], pull: &[f64]) -> bool {
    /// Scatter of a pull that does not depend on slip stays above this with a few rows already.
    const CLEAR: f64 = -0.6;
    if slip.len() != pull.len() || slip.len() < 4 {
        return false;
    }
    let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
    let (a, b) = (mean(slip), mean(pull));
    let sum = |of: &dyn Fn(f64, f64) -> f64| slip.iter().zip(pull).map(|(s, p)| of(s - a, p - b)).sum::<f64>();
    let size = (sum(&|s, _| s * s) * sum(&|_, p| p * p)).sqrt();
    size > 0.0 && sum(&|s, p| s * p) / size < CLEAR
}
