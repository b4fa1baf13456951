//! Section 4.4.2, figures 4.14 and 4.15: thrust on a sled that the FSRL rover pushes through the ditch.

use super::contender::FIELD;
use super::ditch::{COURSE, SPEED, assumptions, model};
use super::drive::{Drive, drive};
use super::{Finding, Plot, ReproductionError, Row, Spread};
use crate::model::Model;
use crate::parallel::map_in_order;
use bekker_modeldescription::Lookup;

/// Depth of the ditch, wheel diameters: the shallowest of the go/no-go trials, which some controllers cross.
const DEPTH: f64 = 0.25;
/// Mean gain of thrust on the sled, %.
const PUBLISHED_THRUST: f64 = 82.0;
/// Resistance of the sled, N s/m: at full speed a tenth of the weight of this side of the rover.
const SLED: f64 = 0.1 * 3.05 * 9.81 / SPEED;

/// Thrust on a sled pushed through the ditch: the sled resists in proportion to its speed.
///
/// # Errors
/// Whatever a drive says.
pub fn sled(trials: usize) -> Result<Vec<Finding>, ReproductionError> {
    let seeds: Vec<u32> = (0..trials.max(1) as u32).collect();
    let of_seed = |&seed: &u32| -> Result<Vec<Drive>, ReproductionError> {
        FIELD.iter().map(|contender| drive(&with_sled(model(contender, DEPTH, seed)?)?, SPEED, &COURSE)).collect()
    };
    let done: Vec<Vec<Drive>> = map_in_order(&seeds, of_seed).into_iter().collect::<Result<_, _>>()?;
    let thrust = |drive: &Drive| -> f64 {
        let velocity = drive.column("velocity");
        SLED * velocity.iter().sum::<f64>() / velocity.len().max(1) as f64
    };
    let mut rows = Vec::new();
    for (k, contender) in FIELD.iter().enumerate() {
        let name = contender.name;
        let mean = Spread::of(done.iter().map(|drives| thrust(&drives[k])));
        rows.extend(mean.map(|ours| Row {
            quantity: format!("{name}: mean thrust on the sled, N"),
            thesis: None,
            ours,
            reason: format!("The sled resists with {SLED:.0} N s/m times its speed, an assumption"),
        }));
        if k > 0 {
            let gain = Spread::of(done.iter().map(|drives| 100.0 * (thrust(&drives[k]) / thrust(&drives[0]) - 1.0)));
            rows.extend(gain.map(|ours| Row {
                quantity: format!("{name}: gain of mean thrust over velocity control, %"),
                thesis: (name == "RTC").then_some(PUBLISHED_THRUST),
                ours,
                reason: "A representative pair of trials in the thesis; how its sled resists is not given".to_owned(),
            }));
        }
    }
    let lines = FIELD.iter().zip(&done[0]).filter(|(contender, _)| contender.in_figures).map(|(contender, drive)| {
        drive.series(contender.name, "time", drive.column("velocity").iter().map(|velocity| SLED * velocity).collect())
    });
    Ok(vec![Finding {
        id: "sled".to_owned(),
        section: "4.4.2, figures 4.14 and 4.15".to_owned(),
        title: "Thrust on a sled pushed through the ditch".to_owned(),
        rows,
        plots: vec![Plot {
            id: "figure_4_15".to_owned(),
            title: "Figure 4.15: thrust during the crossing (first trial)".to_owned(),
            x_label: "time, s".to_owned(),
            y_label: "thrust, N".to_owned(),
            series: lines.collect(),
        }],
        assumptions: assumptions(),
    }])
}

/// The model pushing a sled at its reference point.
fn with_sled(mut model: Model) -> Result<Model, ReproductionError> {
    model.add_effects(
        "[[effect]]\nid = 'sled'\ntarget = 'body.force_x'\nexpression = '-resistance * velocity'\n\
         parameters = { resistance = { neutral = 0.0, min = 0.0, max = 1000.0, unit = 'N.s/m' } }",
    )?;
    model.set("sled.resistance", SLED)?;
    Ok(model)
}
