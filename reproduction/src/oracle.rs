//! What the best slips could do on a course, beside what controllers do: pose by pose, quasi-static, by the simulation's own wheel
//! and soil.

use super::ReproductionError;
use bekker::model::Model;
use std::iter;

/// Distance between poses on smooth ground, m: less than half a small wheel's contact.
pub(super) const SMOOTH_GROUND: f64 = 0.025;
/// The same in a ditch, m: the hardest pose, where a wheel passes from one wall to the other, extends over less than 1 cm.
pub(super) const DITCH_POSES: f64 = 0.002;
/// Where a pose is tried again that gives an error, over the distance of poses.
const BESIDE: [f64; 4] = [0.25, -0.25, 0.5, -0.5];

/// What was attainable on a course.
#[derive(Clone, Copy, Debug)]
pub(super) struct Bound {
    /// Least electrical energy a metre at a constant speed, J/m; infinite where some pose cannot be left forward.
    pub energy: f64,
    /// Whether some slips balance the rover in every pose.
    pub passes: bool,
}

/// The bound of `model` over `length` m of its ground from its start, at `speed` m/s, in poses `spacing` m apart. Where a pose gives
/// an error (the rover finds no rest, or the optimiser fails), the first of four places beside it that gives none stands for it;
/// without any the rover does not pass.
///
/// # Errors
/// Where the oracle refuses the rover.
pub(super) fn bound(model: &Model, length: f64, speed: f64, spacing: f64) -> Result<Bound, ReproductionError> {
    let mut oracle = model.oracle()?;
    let poses = (length / spacing).ceil() as usize;
    let mut energy = 0.0;
    for k in 0..poses {
        let x = model.start.x0 + length * (k as f64 + 0.5) / poses as f64;
        let mut places = iter::once(0.0).chain(BESIDE).map(|shift| x + shift * spacing);
        match places.find_map(|x| model.attainable(&mut oracle, x, speed).ok()) {
            Some(here) if here.balanced => energy += here.electrical_power / speed / poses as f64,
            _ => return Ok(Bound { energy: f64::INFINITY, passes: false }),
        }
    }
    Ok(Bound { energy, passes: true })
}
