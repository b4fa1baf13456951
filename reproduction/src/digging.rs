//! Where control can matter: the FSRL rover and a ditch of sand in which slip digs, at once or along the wheels' way, so that a
//! spinning wheel pulls less than one at the best slip. Fixed before any result was seen:
//!
//! - Sand: the thesis's loose bevameter sand of the ditch study, the sinkage exponent growing by 0.4 times the slip (Ding et al.
//!   2011: 0.35 to 0.5); lugs of 10 mm. Scatter of the trials as in the ditch study; 40 paired trials are meant.
//! - Measure: the steepest wall, in whole degrees, that is crossed, by bisection between 8 and 29 degrees.
//! - Controllers: velocity control with its assumed gains and with those tuned to the plant, of which the one with the larger mean
//!   counts as the best with fixed gains; RTC with wheel-speed loops; beside them the oracle, the steepest wall all of whose poses
//!   some slips balance.
//! - Criterion: RTC closes half of the gap between that velocity control and the oracle, (RTC - velocity)/(oracle - velocity) of
//!   the means at least 0.5, with a bootstrap interval over the trials; and at the wall one degree over the median of that velocity
//!   control McNemar's exact test on the pairs.
//! - Also by the width of the ditch over the distance of the wheels, under and over 1.9.
//!
//! Fixed later, before its trials were seen: the seeds are new, since the controller was changed on others; and RTC drives a second
//! time, at the speed that velocity control reaches on level ground. Lugs make velocity control a quarter faster than it is commanded,
//! and near the steepest wall a faster rover climbs more (velocity control at 1.5 times its command by 1.2 degrees on average, trials 0 to 19).
//!
//! Sand in which slip digs along the way (a relaxation length of 4 cm, about the length of a contact) was chosen after that study. Its
//! criterion is the same, its seeds are others; trials 0 to 7 had been looked at.

use super::contender::{RTC_SPEED, VELOCITY, with};
use super::ditch_rover::{DIAMETER, DIGGING, DIGGING_ALONG, ENTRANTS, Entrant, Traction, Trial};
use super::drive::{Course, drive};
use super::oracle::{DITCH_POSES, bound};
use super::{Finding, LinePlot, ReproductionError, Row, Series, Spread};
use bekker::model::ControlKind;
use bekker::parallel::map_in_order;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// Through the ditch.
const COURSE: Course = Course { length: 1.5, time_limit: 45.0, sample: 0.05 };
/// A sand of the study.
struct Sand {
    id: &'static str,
    traction: Traction,
    first_seed: u32,
    /// What was known when sand and seeds were chosen.
    chosen: &'static str,
    /// What else a reader of the rows must know.
    remark: Option<&'static str>,
}

/// The controller was changed while trials 0 to 27 were looked at.
const AT_ONCE: Sand = Sand {
    id: "digging",
    traction: DIGGING,
    first_seed: 1000,
    chosen: "Sand, walls, controllers and criterion were chosen before results were seen, see the study's source. The seeds, and RTC at velocity \
             control's speed, were chosen after trials 0 to 27 had been seen; RTC as commanded decides.",
    remark: None,
};
const ALONG: Sand = Sand {
    id: "digging_along",
    traction: DIGGING_ALONG,
    first_seed: 2000,
    chosen: "Walls, controllers and criterion are those of the sand in which slip digs at once. This sand and its seeds were chosen after that \
             study, and after trials 0 to 7 on this sand; RTC as commanded decides.",
    remark: Some(
        "The oracle, and RTC's model of the soil, have the sinkage of a steady slip. A wheel that has just begun to slip stands less deep, so that \
         a drive may cross steeper walls than the oracle.",
    ),
};
/// Level ground, to see which speed velocity control reaches.
const LEVEL: Course = Course { length: 10.0, time_limit: 5.0, sample: 0.05 };
/// Time at its end over which that speed is averaged, s.
const AVERAGED: f64 = 3.0;
/// Walls between which the steepest that is crossed is sought, degrees.
const WALLS: [u32; 2] = [8, 29];
/// Distance of neighbouring wheels of the rover, m.
const SPACING: f64 = 0.2;
/// Width over that distance which parts narrow ditches from wide ones: three wheel diameters, the middle of what is drawn.
const WIDE: f64 = 3.0 * DIAMETER / SPACING;
/// Resamples of the bootstrap.
const RESAMPLES: usize = 4000;

/// Velocity control with gains from the plant.
const TUNED: Entrant = Entrant {
    name: "velocity control, tuned to the plant",
    apply: |model| with(model, ControlKind::VelocityTuned),
    command: |trial| trial.speed,
};

/// The steepest walls of one trial, degrees, as in [`NAMES`]; and width over distance.
#[derive(Clone, Copy, Debug)]
struct Steepest {
    walls: [f64; 5],
    width: f64,
}

const NAMES: [&str; 5] =
    [VELOCITY, TUNED.name, RTC_SPEED, "RTC with wheel-speed loops, at velocity control's speed", "the oracle"];
/// The two entries of RTC, as indices of [`NAMES`], and a remark for the reader of their rows.
const BY_RTC: [(usize, &str); 2] = [
    (2, "At least 50 % was asked for"),
    (3, "Chosen after other trials were seen; the oracle is at the commanded speed"),
];
/// Index of the oracle in [`NAMES`].
const ORACLE: usize = 4;

/// Steepest walls that are crossed on sand in which slip digs at once.
///
/// # Errors
/// Whatever a drive says.
pub fn digging(trials: usize) -> Result<Vec<Finding>, ReproductionError> {
    Ok(vec![walls(&AT_ONCE, trials)?])
}

/// The same on sand in which slip digs along the way.
///
/// # Errors
/// Whatever a drive says.
pub fn digging_along(trials: usize) -> Result<Vec<Finding>, ReproductionError> {
    Ok(vec![walls(&ALONG, trials)?])
}

fn walls(sand: &Sand, trials: usize) -> Result<Finding, ReproductionError> {
    let seeds: Vec<u32> = (sand.first_seed..).take(trials.max(1)).collect();
    let steepest = |&seed: &u32| steepest(seed, &sand.traction);
    let done: Vec<Steepest> = map_in_order(&seeds, steepest).into_iter().collect::<Result<_, _>>()?;
    let mut rows = Vec::new();
    for (k, name) in NAMES.iter().enumerate() {
        for (which, keep) in [("all ditches", 0), ("narrow", 1), ("wide", 2)] {
            let of = done.iter().filter(|of| keep == 0 || (of.width > WIDE) == (keep == 2)).map(|of| of.walls[k]);
            rows.extend(Spread::of(of).map(|ours| Row {
                quantity: format!("{name}: steepest wall crossed, {which}, degrees"),
                thesis: None,
                ours,
                reason: format!("Widths under and over {WIDE:.1} distances of the wheels"),
            }));
        }
    }
    let best = if mean(&done, 0) >= mean(&done, 1) { 0 } else { 1 };
    for (rtc, reason) in BY_RTC {
        rows.push(Row {
            quantity: format!("share of the gap between {} and the oracle that {} closes, %", NAMES[best], NAMES[rtc]),
            thesis: None,
            ours: closed(&done, best, rtc),
            reason: format!("Of the means over the trials; bootstrap, 80 %. {reason}"),
        });
        rows.push(mcnemar(&done, best, rtc));
    }
    Ok(Finding {
        id: sand.id.to_owned(),
        section: "beyond the thesis".to_owned(),
        title: format!("Ditch, FSRL rover: {}", sand.traction.name),
        rows,
        plots: vec![crossed(&done, sand.id)],
        assumptions: [Some(sand.chosen), sand.remark].into_iter().flatten().map(str::to_owned).collect(),
    })
}

/// Share of the trials that cross, over the wall.
fn crossed(done: &[Steepest], id: &str) -> LinePlot {
    let walls: Vec<f64> = (WALLS[0]..=WALLS[1]).map(f64::from).collect();
    let share =
        |k: usize, wall: f64| 100.0 * done.iter().filter(|of| of.walls[k] >= wall).count() as f64 / done.len() as f64;
    let line = |(k, name): (usize, &&str)| Series {
        name: (*name).to_owned(),
        x: walls.clone(),
        y: walls.iter().map(|&wall| share(k, wall)).collect(),
    };
    LinePlot {
        id: format!("{id}_crossed"),
        title: "Ditches crossed over the slope of their walls".to_owned(),
        x_label: "wall, degrees".to_owned(),
        y_label: "crossed, %".to_owned(),
        series: NAMES.iter().enumerate().map(line).collect(),
    }
}

fn mean(done: &[Steepest], k: usize) -> f64 {
    done.iter().map(|of| of.walls[k]).sum::<f64>() / done.len() as f64
}

/// The share of the gap that `rtc` closes, %, with the 10 and 90 % quantiles of a bootstrap.
fn closed(done: &[Steepest], best: usize, rtc: usize) -> Spread {
    let share = |of: &[Steepest]| 100.0 * (mean(of, rtc) - mean(of, best)) / (mean(of, ORACLE) - mean(of, best));
    let mut random = ChaCha8Rng::seed_from_u64(0);
    let mut draw = || done[((random.random::<f64>() * done.len() as f64) as usize).min(done.len() - 1)];
    let resamples = (0..RESAMPLES).map(|_| share(&(0..done.len()).map(|_| draw()).collect::<Vec<_>>()));
    let spread = Spread::of(resamples).unwrap_or(Spread::exact(f64::NAN));
    Spread { median: share(done), trials: done.len(), ..spread }
}

/// McNemar's exact test at the wall one degree over the median of velocity control.
fn mcnemar(done: &[Steepest], best: usize, rtc: usize) -> Row {
    let wall = Spread::of(done.iter().map(|of| of.walls[best])).map_or(0.0, |spread| spread.median.floor()) + 1.0;
    let only =
        |one: usize, other: usize| done.iter().filter(|of| of.walls[one] >= wall && of.walls[other] < wall).count();
    let (ours, theirs) = (only(rtc, best), only(best, rtc));
    Row {
        quantity: format!(
            "two-sided p of McNemar's exact test, walls of {wall} degrees, {} against {}",
            NAMES[rtc], NAMES[best]
        ),
        thesis: None,
        ours: Spread { trials: done.len(), ..Spread::exact(binomial(ours, theirs)) },
        reason: format!("RTC alone crosses {ours} times, velocity control alone {theirs} times"),
    }
}

/// Two-sided probability of a split at least as uneven as `a` to `b` where both sides are as probable.
fn binomial(a: usize, b: usize) -> f64 {
    let n = a + b;
    let (mut term, mut tail) = (0.5_f64.powi(n as i32), 0.0);
    for k in 0..=a.min(b) {
        tail += term;
        term *= (n - k) as f64 / (k + 1) as f64;
    }
    (2.0 * tail).min(1.0)
}

/// The steepest walls of one trial.
fn steepest(seed: u32, traction: &Traction) -> Result<Steepest, ReproductionError> {
    let trial = Trial::new(seed)?;
    let by = |trial: &Trial, entrant: &Entrant| {
        steepest_wall(|wall| {
            let (model, speed) = trial.model(entrant, traction, f64::from(wall).to_radians())?;
            Ok(drive(&model, speed, &COURSE)?.completed)
        })
    };
    let of_field = |name: &str| ENTRANTS.iter().find(|entrant| entrant.name == name).ok_or("no such entrant");
    let oracle = steepest_wall(|wall| {
        let (model, speed) = trial.model(&ENTRANTS[0], traction, f64::from(wall).to_radians())?;
        Ok(bound(&model, COURSE.length, speed, DITCH_POSES)?.passes)
    })?;
    let (velocity, rtc) = (of_field(VELOCITY)?, of_field(RTC_SPEED)?);
    let at_its_speed = Trial { speed: level_speed(&trial, velocity, traction)?, ..trial.clone() };
    let walls = [by(&trial, velocity)?, by(&trial, &TUNED)?, by(&trial, rtc)?, by(&at_its_speed, rtc)?, oracle];
    Ok(Steepest { walls, width: trial.width / SPACING })
}

/// The speed that an entrant reaches on level ground of the soil outside the ditch, m/s.
fn level_speed(trial: &Trial, entrant: &Entrant, traction: &Traction) -> Result<f64, ReproductionError> {
    let (model, speed) = trial.level_outside(entrant, traction)?;
    Ok(drive(&model, speed, &LEVEL)?.final_speed(AVERAGED))
}

/// The steepest wall for which `crosses` says yes, by bisection; one degree under the first where none is.
fn steepest_wall(crosses: impl Fn(u32) -> Result<bool, ReproductionError>) -> Result<f64, ReproductionError> {
    let (mut low, mut high) = (WALLS[0] - 1, WALLS[1] + 1);
    while high - low > 1 {
        let middle = u32::midpoint(low, high);
        if crosses(middle)? { low = middle } else { high = middle }
    }
    Ok(f64::from(low))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn analytic_mcnemar_and_bisection() {
        // By hand: 2 (1 + 6)/2^6 for 1 of 6; 1 for an even split.
        assert!((binomial(1, 5) - 2.0 * 7.0 / 64.0).abs() < 1e-12);
        assert_eq!(binomial(3, 3), 1.0);
        assert_eq!(binomial(0, 0), 1.0);
        for last in [7, 8, 15, 28, 29] {
            assert_eq!(steepest_wall(|wall| Ok(wall <= last)).ok(), Some(f64::from(last)));
        }
    }
}
