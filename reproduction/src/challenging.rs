//! Section 4.4.1, figures 4.8 to 4.10: ground whose steepest places are near the soil's friction angle.

use super::contender::{Contender, FIELD};
use super::drive::{Course, Drive, drive};
use super::{Finding, LinePlot, ReproductionError, Row, Series, Spread};
use bekker::model::Model;
use bekker::parallel::map_in_order;
use bekker::terrain::Rough;

/// Commanded speed, m/s.
const SPEED: f64 = 0.25;
/// As long as the benign course.
const COURSE: Course = Course { length: 5.0, time_limit: 120.0, sample: 0.01 };
/// Steepest places that are tried, degrees; the last is the soil's friction angle.
const STEEPEST: [f64; 4] = [14.0, 19.0, 24.0, 29.0];
/// Shear modulus K, m. With the stated 30 mm no controller passes 14 degrees.
const SHEAR_MODULI: [f64; 2] = [0.03, 0.01];

/// Who arrives, by the steepest place of the ground.
///
/// # Errors
/// Whatever a drive says.
pub fn challenging(trials: usize) -> Result<Vec<Finding>, ReproductionError> {
    SHEAR_MODULI.iter().map(|&modulus| on_soil(modulus, trials.max(1))).collect()
}

fn model(contender: &Contender, modulus: f64, steepest: f64, seed: u32) -> Result<Model, ReproductionError> {
    let mut model = Model::preset("two_wheeled")?;
    model.rover.soil.shear_modulus = modulus;
    model.rover.terrain = Rough { steepest: steepest.to_radians(), seed, ..Rough::default() }.terrain()?;
    model.stepping.seed = seed;
    (contender.apply)(&mut model);
    Ok(model)
}

/// Drives of one steepness: for every seed, one a contender.
fn drives(modulus: f64, steepest: f64, trials: usize) -> Result<Vec<Vec<Drive>>, ReproductionError> {
    let seeds: Vec<u32> = (0..trials as u32).collect();
    let of_seed = |&seed: &u32| -> Result<Vec<Drive>, ReproductionError> {
        FIELD.iter().map(|contender| drive(&model(contender, modulus, steepest, seed)?, SPEED, &COURSE)).collect()
    };
    map_in_order(&seeds, of_seed).into_iter().collect()
}

fn on_soil(modulus: f64, trials: usize) -> Result<Finding, ReproductionError> {
    let all = STEEPEST.iter().map(|&steepest| drives(modulus, steepest, trials));
    let all: Vec<Vec<Vec<Drive>>> = all.collect::<Result<_, _>>()?;
    let millimetres = 1e3 * modulus;
    let arrived = |k: usize, drives: &[Vec<Drive>]| {
        100.0 * drives.iter().filter(|of_seed| of_seed[k].completed).count() as f64 / drives.len() as f64
    };
    let mut rows = Vec::new();
    for (k, contender) in FIELD.iter().enumerate() {
        for (steepest, drives) in STEEPEST.iter().zip(&all) {
            let ours = Spread { trials, ..Spread::exact(arrived(k, drives)) };
            rows.push(Row {
                quantity: format!("{}: courses completed, steepest place {steepest:.0} degrees, %", contender.name),
                thesis: None,
                ours,
                reason: "The thesis shows one course (figure 4.8): RTC completed it, velocity control did not"
                    .to_owned(),
            });
            let way = drives.iter().map(|of_seed| of_seed[k].summary.distance);
            rows.extend(Spread::of(way).map(|ours| Row {
                quantity: format!("{}: way made, steepest place {steepest:.0} degrees, m", contender.name),
                thesis: None,
                ours,
                reason: "Of 5 m".to_owned(),
            }));
        }
    }
    let completed = FIELD.iter().enumerate().map(|(k, contender)| Series {
        name: contender.name.to_owned(),
        x: STEEPEST.to_vec(),
        y: all.iter().map(|drives| arrived(k, drives)).collect(),
    });
    let mut plots = vec![LinePlot {
        id: format!("challenging_completed_K{millimetres:.0}mm"),
        title: format!("Courses completed (K = {millimetres:.0} mm)"),
        x_label: "steepest place, degrees".to_owned(),
        y_label: "completed, %".to_owned(),
        series: completed.collect(),
    }];
    plots.extend(figures(&all, millimetres));
    Ok(Finding {
        id: format!("challenging_K{millimetres:.0}mm"),
        section: "4.4.1, figures 4.8 to 4.10".to_owned(),
        title: format!("Challenging terrain, K = {millimetres:.0} mm"),
        rows,
        plots,
        assumptions: vec![
            "Figure 4.8 gives no numbers but \"maximum slopes near the internal friction angle\": random ground, another a \
             trial, scaled so that its steepest place has the stated slope; longest wavelength 2 m."
                .to_owned(),
            "Thrust is the sum of the wheels' torque over radius.".to_owned(),
        ],
    })
}

/// Figures 4.9 and 4.10 for the steepest ground on which the contenders of the thesis's figures do not all end alike, the
/// first such trial; the first trial of the steepest ground where there is none.
fn figures(all: &[Vec<Vec<Drive>>], millimetres: f64) -> Vec<LinePlot> {
    let apart = |of_seed: &Vec<Drive>| {
        let ends: Vec<bool> = pick(of_seed).map(|(_, drive)| drive.completed).collect();
        ends.iter().any(|end| *end != ends[0])
    };
    let steps = STEEPEST.iter().zip(all).enumerate().rev();
    let told =
        steps.filter_map(|(_, (steepest, drives))| Some((*steepest, drives.iter().position(apart)?, drives))).next();
    let last = STEEPEST.len() - 1;
    let (steepest, trial, drives) = told.unwrap_or((STEEPEST[last], 0, &all[last]));
    let radius = 0.1;
    let plot = |id: &str, title: &str, y_label: &str, y: &dyn Fn(&Drive) -> Vec<f64>| LinePlot {
        id: format!("figure_{id}_K{millimetres:.0}mm"),
        title: format!("{title} (steepest place {steepest:.0} degrees, trial {trial}, K = {millimetres:.0} mm)"),
        x_label: "way, m".to_owned(),
        y_label: y_label.to_owned(),
        series: pick(&drives[trial]).map(|(contender, drive)| drive.series(contender.name, "x", y(drive))).collect(),
    };
    vec![
        plot("4_9", "Figure 4.9: total wheel thrust", "thrust, N", &|drive| {
            drive.total("torque").iter().map(|torque| torque / radius).collect()
        }),
        plot("4_10", "Figure 4.10: average slip of both wheels", "slip, %", &|drive| {
            drive.mean("slip").iter().map(|slip| 100.0 * slip).collect()
        }),
    ]
}

/// The contenders of the thesis's figures and their drives.
fn pick(of_seed: &[Drive]) -> impl Iterator<Item = (&'static Contender, &Drive)> {
    FIELD.iter().zip(of_seed).filter(|(contender, _)| contender.in_figures)
}
