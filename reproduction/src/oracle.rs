//! What the best slips could do on a course, beside what controllers do: pose by pose, quasi-static, by the simulation's own wheel
//! and soil.

use super::ReproductionError;
use bekker::model::Model;

/// Distance between poses, m: less than half a small wheel's contact.
const SPACING: f64 = 0.025;

/// What was attainable on a course.
#[derive(Clone, Copy, Debug)]
pub(super) struct Bound {
    /// Least electrical energy a metre at a constant speed, J/m; infinite where some pose cannot be left forward.
    pub energy: f64,
    /// Whether some slips balance the rover in every pose.
    pub passes: bool,
}

/// The bound of `model` over `length` m of its ground from its start, at `speed` m/s. A pose in which the rover finds no rest
/// counts as one that cannot be passed.
///
/// # Errors
/// Where the oracle refuses the rover.
pub(super) fn bound(model: &Model, length: f64, speed: f64) -> Result<Bound, ReproductionError> {
    let mut oracle = model.oracle()?;
    let poses = (length / SPACING).ceil() as usize;
    let mut energy = 0.0;
    for k in 0..poses {
        let x = model.start.x0 + length * (k as f64 + 0.5) / poses as f64;
        match model.attainable(&mut oracle, x, speed) {
            Ok(here) if here.balanced => energy += here.electrical_power / speed / poses as f64,
            _ => return Ok(Bound { energy: f64::INFINITY, passes: false }),
        }
    }
    Ok(Bound { energy, passes: true })
}
