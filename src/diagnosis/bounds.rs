//! Bounds of a default calibration: what is believable for a soil under a small wheel, narrower than what
//! the model allows.
//!
//! They contain the published soils named beside each with a margin, since small wheels and loose simulants
//! reach beyond them. The margins were chosen while looking at the fit of one public data set (see
//! `tests/real_data/smooth_wheel.rs`), so agreement there is a reproduction, not a prediction. A fit that ends
//! on a bound wanted something that hardly any soil has: the sign that it hides a missing effect.

/// Name, lowest, highest; and published values.
const BELIEVABLE: [(&str, f64, f64); 7] = [
    // 0.17 kPa (lunar regolith) to 4.14 kPa (clayey soil): Wong, Theory of Ground Vehicles; Ding et al. 2011.
    ("soil.cohesion", 0.0, 5e3),
    // 13 deg (clayey soil) to 37.2 deg (Ishigami's simulant); a cohesive soil may have none.
    ("soil.friction_angle", 0.0, 0.8),
    // 0.69 MN/m^(n+2) (clayey soil) to 5.3 (LETE sand) for tracks and plates; small wheels and high exponents reach further.
    ("soil.k_phi", 1e4, 1e8),
    // 0.5 (clayey soil) to 1.1 (dry sand) on plates.
    ("soil.exponent", 0.3, 1.5),
    // 6 mm (clayey soil) to 36 mm (Ishigami's simulant).
    ("soil.shear_modulus", 0.001, 0.1),
    // 0.18 (loose sand) to 0.43 (compact sand): Wong and Reece 1967.
    ("soil.c1", 0.0, 0.6),
    // 0.15 (Ishigami's simulant) to 0.32 (measured: Wong and Reece 1967).
    ("soil.c2", 0.0, 0.5),
];

/// Believable range of a parameter, where the table has one.
pub(super) fn believable(name: &str) -> Option<(f64, f64)> {
    BELIEVABLE.iter().find(|(known, ..)| *known == name).map(|(_, low, high)| (*low, *high))
}
