//! Sustained pull on level sand: what a rover pulls at given shares of the commanded speed, averaged over time.
//!
//! A sled that resists in proportion to its speed lets the rover settle; several such sleds give pull over speed. At 80 % of the
//! commanded speed a wheel that turns at that speed slips by 20 %.

use super::ditch_rover::{DIGGING_ALONG, ENTRANTS, LUGS, Traction, Trial, WEIGHT};
use super::drive::{Course, drive};
use super::{Finding, LinePlot, ReproductionError, Row, Series, Spread};
use bekker::model::Model;
use bekker::modeldescription::Lookup;
use bekker::parallel::map_in_order;

/// Long enough to settle and to average.
const COURSE: Course = Course { length: 100.0, time_limit: 12.0, sample: 0.05 };
/// Time at the end over which speed and pull are averaged, s.
const AVERAGED: f64 = 4.0;
/// Commanded speed, m/s, and body force, of the weight.
const SPEED: f64 = 0.06;
const BODY_FORCE: f64 = 1.0;
/// Resistances of the sleds, N s/m: from hardly any pull to a stand.
const SLEDS: [f64; 8] = [25.0, 50.0, 100.0, 150.0, 225.0, 350.0, 600.0, 1500.0];
/// Shares of the commanded speed at which pull is compared.
const SHARES: [f64; 2] = [0.8, 0.5];

/// Pull of every entrant over the speed, on sand whose pull only grows with slip and on sand in which slip digs.
///
/// # Errors
/// Whatever a drive says.
pub fn pull(trials: usize) -> Result<Vec<Finding>, ReproductionError> {
    let seeds: Vec<u32> = (0..trials.div_ceil(2).max(1) as u32).collect();
    [LUGS, DIGGING_ALONG].iter().map(|traction| on_sand(traction, &seeds)).collect()
}

/// Speed, of the commanded, and pull, of the weight in %, of every entrant behind every sled.
type Curves = Vec<Vec<[f64; 2]>>;

fn on_sand(traction: &Traction, seeds: &[u32]) -> Result<Finding, ReproductionError> {
    let done = map_in_order(seeds, |seed| curves(*seed, traction));
    let done: Vec<(Curves, f64)> = done.into_iter().collect::<Result<_, _>>()?;
    let mut rows = Vec::new();
    for (k, entrant) in ENTRANTS.iter().enumerate() {
        for share in SHARES {
            let pulls = done.iter().filter_map(|(curves, _)| at(&curves[k], share));
            rows.extend(Spread::of(pulls).map(|ours| Row {
                quantity: format!("{}: pull at {:.0} % of the commanded speed, of the weight, %", entrant.name, 100.0 * share),
                thesis: None,
                ours,
                reason: "Mean over 4 s of steady motion; trials in which the rover does not reach that speed do not count".to_owned(),
            }));
        }
    }
    rows.extend(Spread::of(done.iter().map(|(_, most)| *most)).map(|ours| Row {
        quantity: "the oracle: largest pull at any slips, of the weight, %".to_owned(),
        thesis: None,
        ours,
        reason: "Quasi-static, by the simulation's own wheel and soil. It is a force at the centre of mass, the sled pulls at the chassis \
                 reference point, which loads the wheels otherwise: a drive may pull more"
            .to_owned(),
    }));
    let series = ENTRANTS.iter().enumerate().map(|(k, entrant)| {
        let column = |axis: usize| done[0].0[k].iter().map(|point| point[axis]).collect();
        Series { name: entrant.name.to_owned(), x: column(0), y: column(1) }
    });
    let id = if traction.slip_sinkage > 0.0 { "pull_digging_along" } else { "pull_monotone" };
    Ok(Finding {
        id: id.to_owned(),
        section: "4.4.2".to_owned(),
        title: format!("Sustained pull on level sand: {}", traction.name),
        rows,
        plots: vec![LinePlot {
            id: format!("{id}_curves"),
            title: "Pull over speed, first trial".to_owned(),
            x_label: "speed, of the commanded".to_owned(),
            y_label: "pull, % of the weight".to_owned(),
            series: series.collect(),
        }],
        assumptions: vec![
            "FSRL rover on level loose sand of the thesis's bevameter (0.18 kPa), 6 cm/s commanded; RTC as in the thesis is \
             commanded a body force of one weight. The sled resists in proportion to its speed."
                .to_owned(),
            "Where slip digs, the sinkage exponent follows the slip (Ding et al. 2011 give it for steady slip) with a relaxation \
             length of 4 cm, about that of a contact. Where it follows at once, the rover hops behind heavy sleds."
                .to_owned(),
        ],
    })
}

/// The pull at a share of the commanded speed, between the two nearest points of a curve.
fn at(curve: &[[f64; 2]], share: f64) -> Option<f64> {
    let pair = curve.windows(2).find(|pair| pair[0][0] >= share && pair[1][0] < share)?;
    let part = (pair[0][0] - share) / (pair[0][0] - pair[1][0]);
    Some(pair[0][1] + part * (pair[1][1] - pair[0][1]))
}

/// Curves of one trial, and the most that any slips pull.
fn curves(seed: u32, traction: &Traction) -> Result<(Curves, f64), ReproductionError> {
    let trial = Trial { speed: SPEED, body_force: BODY_FORCE, ..Trial::new(seed)? };
    let mut curves = Vec::new();
    for entrant in ENTRANTS {
        let (level, speed) = trial.level(entrant, traction)?;
        let point = |resistance: f64| -> Result<[f64; 2], ReproductionError> {
            let done = drive(&with_sled(level.clone(), resistance)?, speed, &COURSE)?;
            let mean = done.final_speed(AVERAGED);
            Ok([mean / SPEED, 100.0 * resistance * mean / WEIGHT])
        };
        curves.push(SLEDS.iter().map(|&resistance| point(resistance)).collect::<Result<_, _>>()?);
    }
    let (level, _) = trial.level(&ENTRANTS[0], traction)?;
    let most = level.largest_pull(&mut level.oracle()?, 0.0, SPEED)?;
    Ok((curves, 100.0 * most / WEIGHT))
}

/// The model pulling a sled that resists with `resistance` (N s/m) times its speed.
fn with_sled(mut model: Model, resistance: f64) -> Result<Model, ReproductionError> {
    model.add_effects(
        "[[effect]]\nid = 'sled'\ntarget = 'body.force_x'\nexpression = '-resistance * velocity'\n\
         parameters = { resistance = { neutral = 0.0, min = 0.0, max = 10000.0, unit = 'N s/m' } }",
    )?;
    model.set("sled.resistance", resistance)?;
    Ok(model)
}
