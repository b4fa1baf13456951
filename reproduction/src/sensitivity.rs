//! How much the comparison on benign ground hangs on what the thesis does not state.

use super::benign::{COURSE, SPEED, model};
use super::contender::{Contender, FIELD};
use super::drive::{drive, drive_at};
use super::{Finding, ReproductionError, Row, Spread};
use bekker::model::Model;
use bekker::parallel::map_in_order;

/// An assumption at another value.
struct Assumption {
    what: &'static str,
    set: fn(&mut Model),
}

/// One at a time, the others as in the study of benign ground with K = 10 mm.
const ASSUMPTIONS: &[Assumption] = &[
    Assumption { what: "as assumed, K = 10 mm", set: |_| {} },
    Assumption { what: "K = 5 mm", set: |model| model.rover.soil.shear_modulus = 0.005 },
    Assumption { what: "K = 20 mm", set: |model| model.rover.soil.shear_modulus = 0.02 },
    Assumption { what: "K = 30 mm", set: |model| model.rover.soil.shear_modulus = 0.03 },
    Assumption { what: "centre of mass 5 cm lower", set: |model| model.rover.body.centre_of_mass_z -= 0.05 },
    Assumption { what: "centre of mass 10 cm higher", set: |model| model.rover.body.centre_of_mass_z += 0.1 },
    Assumption { what: "gravity of Mars", set: |model| model.rover.environment.gravity = 3.71 },
    Assumption { what: "gains of velocity control a third", set: |model| scale_gains(model, 1.0 / 3.0) },
    Assumption { what: "gains of velocity control three times", set: |model| scale_gains(model, 3.0) },
    Assumption { what: "gain of RTC a fifth", set: |model| model.control.rtc.gain *= 0.2 },
    Assumption { what: "gain of RTC one and a half", set: |model| model.control.rtc.gain *= 1.5 },
];

fn scale_gains(model: &mut Model, factor: f64) {
    model.control.velocity.kp *= factor;
    model.control.velocity.ki *= factor;
}

/// What one trial under one assumption gave.
struct Outcome {
    slip: f64,
    power: f64,
    energy: f64,
}

/// Slip of velocity control, and RTC's power and energy a metre against velocity control at RTC's speed.
fn outcome(assumption: &Assumption, rtc: &Contender, seed: u32) -> Result<Outcome, ReproductionError> {
    let changed = |contender| -> Result<Model, ReproductionError> {
        let mut model = model(contender, 0.01, seed)?;
        (assumption.set)(&mut model);
        Ok(model)
    };
    let velocity = changed(&FIELD[0])?;
    let free = drive(&velocity, SPEED, &COURSE)?;
    let rtc = drive(&changed(rtc)?, SPEED, &COURSE)?.summary;
    let equal = drive_at(&velocity, rtc.speed, &COURSE)?.summary;
    let change = |ours: f64, theirs: f64| 100.0 * (ours / theirs - 1.0);
    Ok(Outcome {
        slip: 100.0 * free.summary.slip,
        power: change(rtc.power, equal.power),
        energy: change(rtc.energy_per_metre, equal.energy_per_metre),
    })
}

/// One assumption after the other, over trials.
///
/// # Errors
/// Whatever a drive says.
pub fn sensitivity(trials: usize) -> Result<Vec<Finding>, ReproductionError> {
    let Some(rtc) = FIELD.get(1) else { return Ok(Vec::new()) };
    let seeds: Vec<u32> = (0..trials.max(1) as u32).collect();
    let mut rows = Vec::new();
    for assumption in ASSUMPTIONS {
        let done = map_in_order(&seeds, |&seed| outcome(assumption, rtc, seed));
        let done: Vec<Outcome> = done.into_iter().collect::<Result<_, _>>()?;
        let row = |what: &str, value: fn(&Outcome) -> f64| {
            let ours = Spread::of(done.iter().map(value))?;
            let quantity = format!("{}: {what}", assumption.what);
            Some(Row { quantity, thesis: None, ours, reason: String::new() })
        };
        rows.extend(row("slip of velocity control, %", |outcome| outcome.slip));
        rows.extend(row("RTC's power in the windings against velocity control at RTC's speed, %", |o| o.power));
        rows.extend(row("RTC's electrical energy a metre against the same, %", |outcome| outcome.energy));
    }
    Ok(vec![Finding {
        id: "sensitivity".to_owned(),
        section: "4.4.1".to_owned(),
        title: "How much the comparison hangs on the assumptions".to_owned(),
        rows,
        plots: Vec::new(),
        assumptions: vec![
            "One assumption changed at a time, the others as on benign ground with K = 10 mm.".to_owned(),
        ],
    }])
}
