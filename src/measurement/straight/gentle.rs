//! How gentle a curve has to be to count as straight.
//!
//! A vehicle that is steered by its sides drags its wheels sideways. On firm ground that takes force in the slightest curve, on loose soil
//! hardly any. So the log itself tells: as long as the drive needs more in the outer half of what counts as straight than straight ahead, only
//! the inner half does.

use super::curves::SLIP_ANGLE;
use std::collections::BTreeMap;
use std::ops::Range;

/// What a drive needs in a row.
pub(super) struct Need {
    /// Time, s.
    pub time: f64,
    /// Slip angle of the end wheels, rad.
    pub angle: f64,
    /// Size of its currents or torques, in their unit.
    pub size: f64,
}

/// How often the slip angle from which on a vehicle turns may be halved: to 0.2 degrees, which a gyroscope of 0.003 rad/s tells at 1 m/s.
const HALVINGS: i32 = 5;
/// Share by which the drive needs more in a curve that matters: friction of a drive scatters by as much.
const MORE: f64 = 0.15;
/// Standard errors by which it has to be more.
const SURE: f64 = 3.0;
/// Time within which rows are compared, s: slopes and soils last longer.
const BLOCK: f64 = 20.0;
/// Fewest rows of each kind in a block, and fewest blocks.
const ROWS: usize = 3;
const BLOCKS: usize = 4;

/// Slip angle from which on the vehicle turns, rad, by what its drive needs in each run.
pub(super) fn limit(runs: &[Vec<Need>]) -> f64 {
    let mut limit = SLIP_ANGLE;
    for halving in 0..HALVINGS {
        let angle = SLIP_ANGLE * 0.5_f64.powi(halving);
        let shares = more_in(runs, 0.5 * angle..angle);
        // Few blocks with a curve neither show that it matters nor that gentler ones do not.
        if shares.len() < BLOCKS {
            continue;
        }
        let count = shares.len() as f64;
        let mean = shares.iter().sum::<f64>() / count;
        let variance = shares.iter().map(|share| (share - mean).powi(2)).sum::<f64>() / (count - 1.0);
        if mean < MORE || mean < SURE * (variance / count).sqrt() {
            break;
        }
        limit = 0.5 * angle;
    }
    limit
}

/// By which share the drive needs more with slip angles within `curve` than straight ahead: in each block of [`BLOCK`] seconds that has both.
fn more_in(runs: &[Vec<Need>], curve: Range<f64>) -> Vec<f64> {
    let ahead = SLIP_ANGLE * 0.5_f64.powi(HALVINGS);
    let mut shares = Vec::new();
    for needs in runs {
        let mut blocks: BTreeMap<i64, [(f64, usize); 2]> = BTreeMap::new();
        for need in needs {
            let kind = usize::from(need.angle > ahead);
            if kind == 1 && !curve.contains(&need.angle) {
                continue;
            }
            let (sum, count) = &mut blocks.entry((need.time / BLOCK).floor() as i64).or_default()[kind];
            *sum += need.size;
            *count += 1;
        }
        let told = blocks.into_values().filter(|kinds| kinds.iter().all(|(_, count)| *count >= ROWS));
        shares.extend(told.map(|[(ahead, few), (curve, many)]| curve / many as f64 / (ahead / few as f64) - 1.0));
    }
    shares
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Ten minutes at 10 Hz with slip angles up to 10 degrees, which are small most of the time, over hills of two minutes; `size` says what
    /// the drive needs at one.
    fn drive(size: impl Fn(f64) -> f64) -> [Vec<Need>; 1] {
        let need = |row: i32| {
            let (time, scatter) = (0.1 * f64::from(row), (f64::from(row) * 12.9898).sin());
            let angle = 0.17 * (0.5 * time).sin().abs().powi(3);
            let hill = 1.0 + 0.4 * (0.05 * time).sin();
            Need { time, angle, size: hill * size(angle) + 0.3 * scatter }
        };
        [(0..6000).map(need).collect()]
    }

    #[test]
    fn property_curves_that_need_no_more_count_as_straight() {
        assert_eq!(limit(&drive(|_| 3.0)), SLIP_ANGLE);
        // Little more does not matter.
        assert_eq!(limit(&drive(|angle| 3.0 + angle)), SLIP_ANGLE);
        assert_eq!(limit(&[]), SLIP_ANGLE);
        // A hill that is climbed in a curve is no curve that matters.
        let hill = |row: i32| {
            let (time, climbs) = (0.1 * f64::from(row), row > 3000);
            Need { time, angle: if climbs { 0.08 } else { 0.01 }, size: if climbs { 6.0 } else { 3.0 } }
        };
        assert_eq!(limit(&[(0..6000).map(hill).collect()]), SLIP_ANGLE);
    }

    #[test]
    fn property_curves_that_need_more_do_not() {
        // From 1.4 degrees on twice as much.
        assert_eq!(limit(&drive(|angle| if angle > 0.025 { 4.0 } else { 2.0 })), 0.25 * SLIP_ANGLE);
        // At once, as on asphalt.
        let at_once = limit(&drive(|angle| if angle > 0.006 { 4.0 } else { 2.0 }));
        assert!(at_once <= 0.0625 * SLIP_ANGLE, "{at_once}");
    }
}
