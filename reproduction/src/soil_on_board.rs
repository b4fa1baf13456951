//! Section 2.4 on the rover: one rear wheel is driven faster for 4 s, sinks, and its readings give the soil (figures 2.8, 2.14-2.17).

use super::on_board::{OnBoard, SensorNoise};
use super::soil::{SoilFindingError, row, sand_assumption, series, testbed_sand};
use super::{Finding, LinePlot, Row};
use bekker::control::Nominal;
use bekker::estimation::soil::{
    ClosedForm, KinematicSinkage, Reading, SoilIdentification, SoilIdentifier, WheelUse, sinkage_under_load,
};
use bekker::model::nominal;
use bekker::parallel::map_in_order;
use bekker::rover::Rover;
use bekker::soil::Soil;

/// Inner step (s), steps between readings: 50 Hz.
const STEPPING: (f64, u64) = (0.002, 10);

/// Readings a second.
const RATE: usize = 50;

/// Seconds at the common speed before the experiment, of which the last one gives the start's configuration.
const LEAD_IN: usize = 3;

/// Seconds of the experiment.
const EXPERIMENT: usize = 4;

/// Speed of the other wheels and of the driven one, rad/s: the thesis has 0.1 to 1.0, and its motors reach 12 rpm (1.26).
/// From 0.4 to 1.2 the rover digs itself in on this sand.
const SPEEDS: [f64; 2] = [0.8, 1.2];

/// Growth of the exponent with slip of the true soil: without it a slipping wheel of the baseline does not dig in.
const SLIP_SINKAGE: f64 = 0.4;

/// The same for the sensitivity to it.
const MILDER: f64 = 0.2;

const SENSORS: SensorNoise =
    SensorNoise { angle: 0.001, velocity: 0.0005, wheel_speed: 0.005, torque: 0.005, contact_angle: 0.01 };

/// One experiment.
struct Experiment {
    /// Time since the start, s.
    time: Vec<f64>,
    /// True change of the sinkage, and by the suspension, mm.
    sinkage: [Vec<f64>; 2],
    /// True slip and by the thesis's assumption that the others do not slip, %.
    slip: [Vec<f64>; 2],
    /// c (kPa) and phi (deg) by least squares on (2.24) for what was read so far.
    closed: [Vec<f64>; 2],
    /// The same by pairs (2.25) at the end, and the share of pairs with a reasonable root, %.
    pairs: [f64; 3],
    /// The same by the filter.
    filtered: [Vec<f64>; 2],
    /// Standard deviations that the filter states at the end.
    deviations: [f64; 2],
    /// Share of readings of the driven wheel that were used.
    used: f64,
    /// Slip of the other wheels at the end, %.
    others: f64,
    /// phi (deg) by (2.26) with the true cohesion.
    cohesion_known: f64,
}

/// The rover that is: the half rocker-bogie on the bevameter's sand, which grows softer with slip.
fn rover(slip_sinkage: f64) -> Rover {
    let mut rover = Rover { soil: testbed_sand(), ..Rover::rocker_bogie() };
    rover.effects.slip_sinkage.n1 = slip_sinkage;
    rover
}

/// The rover's data sheet: dry sand, not this one, and no slip-sinkage.
fn data_sheet() -> Nominal {
    let soil = Soil { cohesion: 500.0, friction_angle: 32.0_f64.to_radians(), shear_modulus: 0.014, ..testbed_sand() };
    nominal(&Rover { soil, ..Rover::rocker_bogie() })
}

fn parameters() -> SoilIdentification {
    SoilIdentification {
        cohesion_deviation: 500.0,
        torque_noise: SENSORS.torque,
        velocity_noise: SENSORS.velocity,
        wheel_speed_noise: SENSORS.wheel_speed,
        angle_noise: SENSORS.angle,
        ..SoilIdentification::default()
    }
}

fn experiment(seed: u64, slip_sinkage: f64) -> Result<Experiment, SoilFindingError> {
    let mut rover = OnBoard::new(rover(slip_sinkage), SENSORS, seed, STEPPING)?;
    for _ in 0..LEAD_IN * RATE {
        rover.advance(&[SPEEDS[0]; 3])?;
    }
    let sheet = data_sheet();
    let mut identifier = SoilIdentifier::new(&sheet, parameters())?;
    identifier.start_experiment(rover.measured())?;
    let kinematics = KinematicSinkage::from(&sheet, rover.measured())?;
    let at_start = rover.simulation().signals().wheels.first().map_or(0.0, |wheel| wheel.sinkage);
    let mut run = Experiment {
        time: Vec::new(),
        sinkage: Default::default(),
        slip: Default::default(),
        closed: Default::default(),
        pairs: [f64::NAN, f64::NAN, 0.0],
        filtered: Default::default(),
        deviations: [f64::NAN; 2],
        used: 0.0,
        others: f64::NAN,
        cohesion_known: f64::NAN,
    };
    let mut averages: Vec<Reading> = Vec::new();
    for sample in 0..EXPERIMENT * RATE {
        rover.advance(&[SPEEDS[1], SPEEDS[0], SPEEDS[0]])?;
        let measured = rover.measured();
        identifier.update(measured)?;
        if let Some((reading, _)) = identifier.reading(0) {
            run.used += f64::from(u8::from(matches!(identifier.uses()[0], WheelUse::Used(_))));
            averages.push(reading);
        }
        let change = kinematics.change(measured, 0, |_| true)?.map_or(f64::NAN, |change| change.mean);
        let truth = rover.simulation().signals().wheels.first().copied().unwrap_or_default();
        let rims: Vec<f64> = measured.wheels.iter().map(|wheel| wheel.speed).collect();
        let others = rims.iter().skip(1).sum::<f64>() / (rims.len() - 1) as f64;
        run.time.push((sample + 1) as f64 / RATE as f64);
        run.sinkage[0].push(1e3 * (truth.sinkage - at_start));
        run.sinkage[1].push(1e3 * change);
        run.slip[0].push(100.0 * truth.slip);
        run.slip[1].push(100.0 * (1.0 - others / rims[0]));
        let closed = ClosedForm::new(&sheet.wheel, testbed_sand().shear_modulus, &averages)
            .and_then(|closed| closed.least_squares())
            .map_or([f64::NAN; 2], |found| [found.cohesion, found.friction_angle]);
        let filtered = identifier.strength();
        for (line, value) in run.closed.iter_mut().zip([closed[0] / 1e3, closed[1].to_degrees()]) {
            line.push(value);
        }
        let estimate = [filtered.cohesion / 1e3, filtered.friction_angle.to_degrees()];
        run.filtered.iter_mut().zip(estimate).for_each(|(line, value)| line.push(value));
    }
    let truth = &rover.simulation().signals().wheels;
    run.others = 100.0 * truth.iter().skip(1).map(|wheel| wheel.slip).sum::<f64>() / (truth.len() - 1) as f64;
    let closed = ClosedForm::new(&sheet.wheel, testbed_sand().shear_modulus, &averages)?;
    run.cohesion_known = closed.friction_angle(testbed_sand().cohesion).to_degrees();
    if let Ok(found) = closed.by_pairs() {
        let strength = found.strength;
        let used = 100.0 * found.used as f64 / found.pairs as f64;
        run.pairs = [strength.cohesion / 1e3, strength.friction_angle.to_degrees(), used];
    }
    let covariance = identifier.covariance();
    run.deviations = [covariance[0][0].sqrt() / 1e3, covariance[1][1].sqrt().to_degrees()];
    run.used /= averages.len().max(1) as f64;
    Ok(run)
}

/// Mean over the last half second.
fn last(values: &[f64]) -> f64 {
    let tail = &values[values.len().saturating_sub(RATE / 2)..];
    tail.iter().sum::<f64>() / tail.len() as f64
}

/// RMS error of the sinkage's change over the last 3 s: mm, and % of the true change.
fn sinkage_error(run: &Experiment) -> [f64; 2] {
    let pairs = || run.sinkage[0].iter().zip(&run.sinkage[1]).skip(RATE);
    let count = pairs().count() as f64;
    let absolute = (pairs().map(|(truth, seen)| (seen - truth).powi(2)).sum::<f64>() / count).sqrt();
    let relative = (pairs().map(|(truth, seen)| ((seen - truth) / truth).powi(2)).sum::<f64>() / count).sqrt();
    [absolute, 100.0 * relative]
}

/// The identification experiment on the rover, over `trials` with different noise.
///
/// # Errors
/// [`SoilFindingError`] where the rover gets stuck or an experiment determines nothing.
pub fn rover_identification(trials: u64) -> Result<Finding, SoilFindingError> {
    let seeds: Vec<u64> = (0..trials).collect();
    let at = |slip_sinkage: f64| -> Result<Vec<_>, _> {
        map_in_order(&seeds, |&seed| experiment(seed, slip_sinkage)).into_iter().collect()
    };
    let (runs, milder) = (at(SLIP_SINKAGE)?, at(MILDER)?);
    let load = nominal(&rover(0.0)).weight() / 3.0;
    let sinkage = sinkage_under_load(&rover(0.0).wheel, &testbed_sand(), load, 0.0).unwrap_or(f64::NAN);
    let [common, driven] = SPEEDS;
    Ok(Finding {
        id: "rover_identification".to_owned(),
        section: "2.4, figures 2.8, 2.14 to 2.17".to_owned(),
        title: "Identification on the rover: the rear wheel driven faster for 4 s on flat sand".to_owned(),
        rows: input_rows(&runs).into_iter().chain(strength_rows(&runs)).chain(sensitivity_rows(&milder)).collect(),
        plots: runs.first().map_or_else(Vec::new, figures),
        assumptions: vec![
            format!(
                "Half a rocker-bogie of the FSRL rover's mass in the plane, other dimensions assumed; the other wheels at \
                 {common} rad/s, the rear at {driven} rad/s."
            ),
            format!(
                "The true soil's exponent grows by {SLIP_SINKAGE} with slip (Ding et al. 2011), which the estimators do not \
                 know; without slip a wheel stands {:.1} mm deep.",
                1e3 * sinkage
            ),
            "Readings at 50 Hz; noise 0.06 deg (pitch, joints), 0.5 mm/s, 0.005 rad/s, 5 mN m, 0.6 deg (contact angles)."
                .to_owned(),
            sand_assumption(),
        ],
    })
}

/// Sinkage and slip, the inputs of the identification.
fn input_rows(runs: &[Experiment]) -> Vec<Row> {
    let over = |quantity: &str, thesis: Option<f64>, f: fn(&Experiment) -> f64, reason: &str| {
        row(quantity, thesis, runs.iter().map(f), reason)
    };
    vec![
        over(
            "RMS difference of the sinkage by kinematics from the true one, %",
            Some(13.4),
            |run| sinkage_error(run)[1],
            "Of the change since the start. The wheels of the other loops sink too where they slip, which (2.28) takes for \
             none; noise of pitch and joints adds 0.3 mm. Its size follows the assumed noise and soil, so that a likeness \
             to the thesis's figure is chance.",
        ),
        over(
            "RMS error of the sinkage by kinematics, mm",
            Some(1.0),
            |run| sinkage_error(run)[0],
            "The thesis: about 1 mm.",
        ),
        over("change of the true sinkage, mm", None, |run| last(&run.sinkage[0]), "At the end of the 4 s."),
        over(
            "error of the slip where the other wheels are taken not to slip, % slip",
            None,
            |run| last(&run.slip[1]) - last(&run.slip[0]),
            "2.3.2's assumption; the identifier uses the measured velocity.",
        ),
        over(
            "slip of the other wheels, %",
            None,
            |run| run.others,
            "The thesis takes it for very little; narrow wheels on this sand slip far more.",
        ),
    ]
}

/// Cohesion and friction angle by each method.
fn strength_rows(runs: &[Experiment]) -> Vec<Row> {
    let over = |quantity: &str, thesis: Option<f64>, f: fn(&Experiment) -> f64, reason: &str| {
        row(quantity, thesis, runs.iter().map(f), reason)
    };
    vec![
        over(
            "cohesion by (2.25), kPa",
            Some(0.325),
            |run| run.pairs[0],
            "The thesis: 0.10 to 0.55 kPa after a transient. Ours: pairs of means over 0.2 s, in the trials that have any \
             reasonable root. One load and nearly one slip hold no equation for c: its roots are noise.",
        ),
        over("share of pairs with a reasonable root of (2.25), %", None, |run| run.pairs[2], "Not in the thesis."),
        over(
            "friction angle by (2.26), deg",
            Some(28.5),
            |run| run.pairs[1],
            "The thesis: 25 to 32 deg. Truth 29.2; K taken for known. Follows the error of c.",
        ),
        over("cohesion by least squares on (2.24), kPa", None, |run| last(&run.closed[0]), "Truth 0.18; bounded by 0."),
        over("friction angle by least squares on (2.24), deg", None, |run| last(&run.closed[1]), "Truth 29.2."),
        over("friction angle by (2.26) with c known, deg", None, |run| run.cohesion_known, "Truth 29.2."),
        over(
            "cohesion by the filter, kPa",
            None,
            |run| last(&run.filtered[0]),
            "Truth 0.18; prior 0.5 +- 0.5 kPa. Three wheels at two slips settle little more than one combination of c, phi \
             and K.",
        ),
        over(
            "friction angle by the filter, deg",
            None,
            |run| last(&run.filtered[1]),
            "Truth 29.2; prior 32 +- 6 deg; K believed 14 mm (truth 10) within half and not estimated.",
        ),
        over(
            "standard deviation that the filter states for c, kPa",
            None,
            |run| run.deviations[0],
            "Near the prior's 0.5: c is hardly learned.",
        ),
        over(
            "standard deviation that the filter states for phi, deg",
            None,
            |run| run.deviations[1],
            "It contains the uncertainty of K and c.",
        ),
        over(
            "share of the driven wheel's readings that were used, %",
            None,
            |run| 100.0 * run.used,
            "Each the mean over 0.2 s.",
        ),
    ]
}

/// What changes where the soil digs less.
fn sensitivity_rows(runs: &[Experiment]) -> Vec<Row> {
    let over = |quantity: &str, f: fn(&Experiment) -> f64| {
        row(
            &format!("{quantity}, with n1 = {MILDER}"),
            None,
            runs.iter().map(f),
            "Sensitivity to the assumed slip-sinkage.",
        )
    };
    vec![
        over("RMS difference of the sinkage by kinematics from the true one, %", |run| sinkage_error(run)[1]),
        over("change of the true sinkage, mm", |run| last(&run.sinkage[0])),
        over("friction angle by (2.26) with c known, deg", |run| run.cohesion_known),
        over("friction angle found by the filter, deg", |run| last(&run.filtered[1])),
    ]
}

fn figures(run: &Experiment) -> Vec<LinePlot> {
    let line = |name: &str, y: &[f64]| series(name, run.time.iter().zip(y).map(|(t, y)| [*t, *y]));
    let plot = |id: &str, title: &str, y_label: &str, series| LinePlot {
        id: id.to_owned(),
        title: title.to_owned(),
        x_label: "time, s".to_owned(),
        y_label: y_label.to_owned(),
        series,
    };
    let both = |names: [&str; 2], values: &[Vec<f64>; 2]| {
        names.into_iter().zip(values).map(|(name, y)| line(name, y)).collect::<Vec<_>>()
    };
    vec![
        plot("figure_2_14", "Sinkage since the start", "sinkage, mm", both(["true", "by kinematics"], &run.sinkage)),
        plot(
            "figure_2_15",
            "Slip of the driven wheel",
            "slip, %",
            both(["true", "others taken not to slip"], &run.slip),
        ),
        plot(
            "figure_2_16",
            "Cohesion during the experiment",
            "cohesion, kPa",
            vec![line("least squares on (2.24)", &run.closed[0]), line("filter", &run.filtered[0])],
        ),
        plot(
            "figure_2_17",
            "Friction angle during the experiment",
            "friction angle, deg",
            vec![line("least squares on (2.24)", &run.closed[1]), line("filter", &run.filtered[1])],
        ),
    ]
}
