//! Section 4.4.2, figures 4.14 and 4.15: thrust of the FSRL rover on a sled in the ditch.

use super::contender::RTC;
use super::ditch_rover::{DIAMETER, ENTRANTS, LUGS, Trial, WEIGHT, assumptions};
use super::drive::{Course, drive};
use super::{Finding, LinePlot, ReproductionError, Row, Series, Spread};
use bekker::model::Model;
use bekker::modeldescription::Lookup;
use bekker::parallel::map_in_order;

/// Long enough to come to a stand against the sled.
const COURSE: Course = Course { length: 1.8, time_limit: 45.0, sample: 0.05 };
/// Slope of the walls, degrees: a ditch that velocity control crosses.
const WALL: f64 = 20.0;
/// Commanded speed, m/s, and body force, of the weight: all that the ground gives.
const SPEED: f64 = 0.06;
const BODY_FORCE: f64 = 1.0;
/// Ways after which the sled holds, m: on level ground, then with front, middle and rear wheel in the ditch.
const PLACES: [f64; 4] = [0.3, 0.6, 0.8, 1.0];
/// Stiffness of the sled, N/m: it gives way by a few centimetres.
const STIFFNESS: f64 = 300.0;
/// Time at the end of a drive over which the thrust is averaged, s: the largest travel would hand a controller its peak.
const AVERAGED: f64 = 10.0;
/// Mean gain of thrust on the sled, %.
const PUBLISHED_THRUST: f64 = 82.0;

/// Thrust that the rover can exert at places along the ditch: it drives there and then pushes against a sled that does not
/// move, until it stands. Half of the trials do: the thrust scatters less than the crossing.
///
/// # Errors
/// Whatever a drive says.
pub fn sled(trials: usize) -> Result<Vec<Finding>, ReproductionError> {
    let seeds: Vec<u32> = (0..trials.div_ceil(2).max(1) as u32).collect();
    let done: Vec<Vec<Vec<f64>>> = map_in_order(&seeds, thrusts).into_iter().collect::<Result<_, _>>()?;
    let mean = |thrusts: &[f64]| thrusts.iter().sum::<f64>() / thrusts.len() as f64;
    let mut rows = Vec::new();
    for (k, entrant) in ENTRANTS.iter().enumerate() {
        let name = entrant.name;
        for (p, place) in PLACES.iter().enumerate() {
            rows.extend(Spread::of(done.iter().map(|of_seed| of_seed[k][p])).map(|ours| Row {
                quantity: format!("{name}: thrust on the sled after {place} m, of the weight, %"),
                thesis: None,
                ours,
                reason: "What the ground gives beyond slope and resistance, the mean of the last 10 s; 0 where it does not \
                         get there"
                    .to_owned(),
            }));
        }
        if k > 0 {
            let gain = done.iter().map(|of_seed| 100.0 * (mean(&of_seed[k]) / mean(&of_seed[0]) - 1.0));
            rows.extend(Spread::of(gain).map(|ours| Row {
                quantity: format!("{name}: gain of mean thrust over velocity control, %"),
                thesis: (name == RTC).then_some(PUBLISHED_THRUST),
                ours,
                reason: "A wheel that spins at the commanded speed shears its whole patch: with (2.1) no torque gives more. \
                         The thesis shows one pair of trials and does not say how its sled resists"
                    .to_owned(),
            }));
        }
    }
    let line = |(k, entrant): (usize, &super::ditch_rover::Entrant)| Series {
        name: entrant.name.to_owned(),
        x: PLACES.to_vec(),
        y: (0..PLACES.len())
            .map(|p| Spread::of(done.iter().map(|of_seed| of_seed[k][p])).map_or(f64::NAN, |spread| spread.median))
            .collect(),
    };
    let mut assumptions = assumptions();
    assumptions.push(format!(
        "The sled is a spring of {STIFFNESS} N/m that takes hold after a way: the thrust is the force at which the rover \
         stands, so that neither the sled's friction nor the rover's speed enters. Lugs of 10 mm, walls of {WALL} degrees, three \
         diameters wide; a body force of one weight, so that RTC asks for all that it holds possible."
    ));
    Ok(vec![Finding {
        id: "sled".to_owned(),
        section: "4.4.2, figures 4.14 and 4.15".to_owned(),
        title: "Thrust on a sled in the ditch".to_owned(),
        rows,
        plots: vec![LinePlot {
            id: "figure_4_15".to_owned(),
            title: "Figure 4.15: thrust along the ditch (median of the trials)".to_owned(),
            x_label: "way, m".to_owned(),
            y_label: "thrust, % of the weight".to_owned(),
            series: ENTRANTS.iter().enumerate().map(line).collect(),
        }],
        assumptions,
    }])
}

/// Thrusts of one trial, of the weight, %: for every entrant one a place.
fn thrusts(seed: &u32) -> Result<Vec<Vec<f64>>, ReproductionError> {
    let trial = Trial { width: 3.0 * DIAMETER, speed: SPEED, body_force: BODY_FORCE, ..Trial::new(*seed)? };
    let thrust = |entrant, place: f64| -> Result<f64, ReproductionError> {
        let (model, speed) = trial.model(entrant, &LUGS, WALL.to_radians())?;
        let drive = drive(&with_sled(model, place)?, speed, &COURSE)?;
        let x = drive.column("x");
        let start = x.first().copied().unwrap_or_default();
        let samples = ((AVERAGED / COURSE.sample) as usize).clamp(1, x.len());
        let travel = |x: &f64| (x - start - place).max(0.0);
        let travel = x[x.len() - samples..].iter().map(travel).sum::<f64>() / samples as f64;
        Ok(100.0 * STIFFNESS * travel / WEIGHT)
    };
    ENTRANTS.iter().map(|entrant| PLACES.iter().map(|&place| thrust(entrant, place)).collect()).collect()
}

/// The model pushing a sled that holds after `place` (m) of way.
fn with_sled(mut model: Model, place: f64) -> Result<Model, ReproductionError> {
    model.add_effects(
        "[[effect]]\nid = 'sled'\ntarget = 'body.force_x'\nexpression = '-stiffness * max(travelled - place, 0)'\n\
         parameters = { stiffness = { neutral = 0.0, min = 0.0, max = 10000.0, unit = 'N/m' }, \
         place = { neutral = 0.0, min = 0.0, max = 10.0, unit = 'm' } }",
    )?;
    model.set("sled.stiffness", STIFFNESS)?;
    model.set("sled.place", place)?;
    Ok(model)
}
