//! Which criterion a terrain asks for (4.11, 4.12).

use crate::snapshot::moving_code;

/// What a force distribution optimises.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Criterion {
    /// Least power P dissipated in the windings (4.10), W: for benign ground.
    #[default]
    Power,
    /// Least electrical power, that in the windings and that at the rims T_i V_i / (r (1 - i)), which grows with slip, W: a
    /// criterion beside (4.10) where slips are chosen.
    ElectricalPower,
    /// Least value of the largest ratio R of tractive force to load (4.5), dimensionless: for rough ground.
    Traction,
}

moving_code!(Criterion, "a criterion" {
    Criterion::Power => 0 => Criterion::Power,
    Criterion::Traction => 1 => Criterion::Traction,
    Criterion::ElectricalPower => 2 => Criterion::ElectricalPower,
});

impl Criterion {
    /// The dual criterion Q = R S + P (1 - S), with S = 1 where max |gamma_i| > C and 0 otherwise
    /// (4.11; 4.12 as corrected, errata 10). Angles in rad; `threshold` is C, rad.
    pub fn for_terrain(contact_angles: impl IntoIterator<Item = f64>, threshold: f64) -> Self {
        let steepest = contact_angles.into_iter().map(f64::abs).fold(0.0, f64::max);
        if steepest > threshold { Self::Traction } else { Self::Power }
    }
}
