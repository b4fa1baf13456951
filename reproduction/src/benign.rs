//! Section 4.4.1, figures 4.6 and 4.7: rough-terrain control against velocity control on gentle ground.

use super::contender::{Contender, FIELD, published};
use super::drive::{Course, Drive, drive, drive_at};
use super::oracle::{SMOOTH_GROUND, bound};
use super::{Finding, LinePlot, ReproductionError, Row, Spread};
use bekker::model::Model;
use bekker::parallel::map_in_order;
use bekker::terrain::Rough;

/// The thesis's speed: 2.5 rad/s at a radius of 10 cm, m/s.
pub(super) const SPEED: f64 = 0.25;
/// Five metres behind the run-in; at 10 ms a sample.
pub(super) const COURSE: Course = Course { length: 5.0, time_limit: 120.0, sample: 0.01 };
/// Steepest place of the ground, rad: "gently rolling" (figure 4.6 has no scale).
const STEEPEST: f64 = 5.0 * std::f64::consts::PI / 180.0;
/// Shear moduli K, m: as stated in 4.4.1, and as firm sand has it.
const SHEAR_MODULI: [f64; 2] = [0.03, 0.01];

/// What the bound is.
const ORACLE: &str = "The oracle: at every pose the slips that need least, quasi-static, at a constant speed; kinetic energy is not counted";
/// What its share is.
const SHARE: &str =
    "Of next to nothing: (energy of velocity control - ours) over (energy of velocity control - the oracle's)";

/// Gentle ground, one a seed.
///
/// # Errors
/// Whatever a drive says.
pub fn benign(trials: usize) -> Result<Vec<Finding>, ReproductionError> {
    SHEAR_MODULI.iter().map(|&modulus| on_soil(modulus, trials)).collect()
}

/// One trial: every contender free, and velocity control at each one's mean speed.
struct Trial {
    free: Vec<Drive>,
    equal: Vec<Drive>,
    /// Least energy a metre at each contender's mean speed, J/m: the oracle's.
    least: Vec<f64>,
}

pub(super) fn model(contender: &Contender, shear_modulus: f64, seed: u32) -> Result<Model, ReproductionError> {
    let mut model = Model::preset("two_wheeled")?;
    model.rover.soil.shear_modulus = shear_modulus;
    model.rover.terrain = Rough { steepest: STEEPEST, seed, ..Rough::default() }.terrain()?;
    model.stepping.seed = seed;
    (contender.apply)(&mut model);
    Ok(model)
}

fn trial(shear_modulus: f64, seed: u32) -> Result<Trial, ReproductionError> {
    let field = FIELD.iter().map(|contender| drive(&model(contender, shear_modulus, seed)?, SPEED, &COURSE));
    let free: Vec<Drive> = field.collect::<Result<_, ReproductionError>>()?;
    let reference = model(&FIELD[0], shear_modulus, seed)?;
    let equal = free.iter().map(|drive| drive_at(&reference, drive.summary.speed, &COURSE));
    let equal = equal.collect::<Result<_, ReproductionError>>()?;
    let least =
        free.iter().map(|drive| Ok(bound(&reference, COURSE.length, drive.summary.speed, SMOOTH_GROUND)?.energy));
    let least = least.collect::<Result<_, ReproductionError>>()?;
    Ok(Trial { free, equal, least })
}

fn on_soil(shear_modulus: f64, trials: usize) -> Result<Finding, ReproductionError> {
    let seeds: Vec<u32> = (0..trials.max(1) as u32).collect();
    let done = map_in_order(&seeds, |&seed| trial(shear_modulus, seed));
    let trials: Vec<Trial> = done.into_iter().collect::<Result<_, _>>()?;
    let millimetres = 1e3 * shear_modulus;
    let stated = shear_modulus == SHEAR_MODULI[0];
    let mut rows = Vec::new();
    for (k, contender) in FIELD.iter().enumerate() {
        rows.extend(rows_of(k, contender, &trials, stated));
    }
    let first = &trials[0];
    let slips = FIELD.iter().zip(&first.free).filter(|(contender, _)| contender.in_figures);
    let slips = slips.map(|(contender, drive)| {
        drive.series(contender.name, "time", drive.mean("slip").iter().map(|slip| 100.0 * slip).collect())
    });
    let plot = LinePlot {
        id: format!("figure_4_7_K{millimetres:.0}mm"),
        title: format!("Figure 4.7: average slip of both wheels (K = {millimetres:.0} mm, first trial)"),
        x_label: "time, s".to_owned(),
        y_label: "slip, %".to_owned(),
        series: slips.collect(),
    };
    Ok(Finding {
        id: format!("benign_K{millimetres:.0}mm"),
        section: "4.4.1, figures 4.6 and 4.7".to_owned(),
        title: format!("Benign terrain, 10 kg rover, K = {millimetres:.0} mm"),
        rows,
        plots: vec![plot],
        assumptions: assumptions(stated),
    })
}

/// Power, slip, speed and energy of one contender, and its energy against velocity control at equal speed.
fn rows_of(k: usize, contender: &Contender, trials: &[Trial], stated: bool) -> Vec<Row> {
    let name = contender.name;
    let row = |what: &str, thesis: Option<f64>, reason: &str, value: &dyn Fn(&Trial) -> f64| {
        let ours = Spread::of(trials.iter().map(value))?;
        Some(Row { quantity: format!("{name}: {what}"), thesis, ours, reason: reason.to_owned() })
    };
    let published = published(contender.name);
    let power = "Motor constants, gear and gravity are assumptions, so watts compare with ours only";
    let slip = if stated {
        "The stated soil (K = 30 mm) asks for more slip by the full stress integrals than the thesis reports"
    } else {
        "K is not the thesis's"
    };
    let rows = [
        row("mean power in the windings, W", published.map(|p| p.power), power, &|t| t.free[k].summary.power),
        row("mean slip, %", published.map(|p| p.slip), slip, &|t| 100.0 * t.free[k].summary.slip),
        row("mean speed, cm/s", None, "25 cm/s are asked for", &|t| 100.0 * t.free[k].summary.speed),
        row("electrical energy, J/m", None, "", &|t| t.free[k].summary.energy_per_metre),
        row("energy a metre against velocity control at the same mean speed, %", None, "", &|t| {
            100.0 * (t.free[k].summary.energy_per_metre / t.equal[k].summary.energy_per_metre - 1.0)
        }),
        row("least electrical energy at that speed, J/m", None, ORACLE, &|t| t.least[k]),
        row("share of the attainable saving over velocity control at the same speed, %", None, SHARE, &|t| {
            let theirs = t.equal[k].summary.energy_per_metre;
            100.0 * (theirs - t.free[k].summary.energy_per_metre) / (theirs - t.least[k])
        }),
        row("courses completed, %", None, "", &|t| if t.free[k].completed { 100.0 } else { 0.0 }),
    ];
    rows.into_iter().flatten().collect()
}

fn assumptions(stated: bool) -> Vec<String> {
    let ground = format!(
        "Figure 4.6 gives no numbers: random ground, another a trial, longest wavelength 2 m, steepest place {:.0} degrees.",
        STEEPEST.to_degrees()
    );
    let soil = if stated {
        "The soil as stated in 4.4.1, K = 30 mm included."
    } else {
        "The soil as stated in 4.4.1 but for K = 10 mm, as measured on firm sands."
    };
    let rest = "Not in the thesis: height of the centre of mass 0.1 m, motors (20 W, gear 100), gains, 100 Hz, gravity 9.81 m/s2.";
    vec![ground, soil.to_owned(), rest.to_owned()]
}
