//! Noise without repeats, repeats of several rigs and days, and one baseline for comparison and diagnosis.

use bekker::diagnosis::{
    CompareOptions, Control, DiagnoseOptions, Diagnosis, FloorSource, Rig, Verdict, compare, diagnose, steady_point,
};
use bekker::measurement::Experiment;
use bekker::model::Model;
use bekker::modeldescription::Lookup;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use std::fmt::Write;
use std::path::Path;

/// Standard deviation of a drawbar pull in the generated experiments, N.
const SCATTER: f64 = 0.3;

/// Standard errors within which an estimate must lie: 1 in 16,000 beyond.
const WITHIN: f64 = 4.0;

fn baseline() -> Model {
    Model::preset("two_wheeled").unwrap()
}

/// One row of a generated experiment.
struct Row {
    label: &'static str,
    slip: f64,
    width: f64,
    noise: f64,
}

/// The drawbar pull (N) and the sinkage (m) of the default soil, and `extra` of slip-sinkage.
fn point(row: &Row, extra: f64) -> (f64, f64) {
    let mut rig = Rig::of(&baseline().rover);
    rig.wheel.width = row.width;
    rig.set("slip_sinkage.n1", extra).unwrap();
    let point = steady_point(&rig, 40.0, row.slip, 0.5).unwrap();
    (point.drawbar_pull, point.sinkage)
}

/// An experiment of runs; `settings` goes before the runs, `parameters` is that of each run.
fn written(name: &str, settings: &str, runs: &[(&str, Vec<Row>)], extra: f64) -> Experiment {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("diagnosis_noise").join(name);
    std::fs::create_dir_all(&folder).unwrap();
    let mut toml = format!("name = \"{name}\"\nkind = \"single_wheel\"\n{settings}");
    for (k, (parameters, rows)) in runs.iter().enumerate() {
        let labelled = rows.iter().any(|row| !row.label.is_empty());
        let mut csv = format!("{}load,slip,wheel_speed,drawbar_pull\n", if labelled { "condition," } else { "" });
        for row in rows {
            let label = if labelled { format!("{},", row.label) } else { String::new() };
            let (pull, _) = point(row, extra);
            writeln!(csv, "{label}40,{},0.5,{:.9e}", row.slip, pull + row.noise).unwrap();
        }
        std::fs::write(folder.join(format!("run{k}.csv")), csv).unwrap();
        writeln!(toml, "[[run]]\nfile = \"run{k}.csv\"\nparameters = {{ {parameters} }}").unwrap();
    }
    std::fs::write(folder.join("experiment.toml"), toml).unwrap();
    Experiment::read(&folder).unwrap()
}

/// Seeded draws of a normal variable with unit variance.
fn draws(seed: u64) -> impl FnMut() -> f64 {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    move || StandardNormal.sample(&mut rng)
}

/// `count` rows without labels at slips from 0.02 to 0.7.
fn sweep(count: usize, seed: u64) -> Vec<Row> {
    let mut unit = draws(seed);
    let slip = |k: usize| 0.02 + 0.68 * k as f64 / (count - 1) as f64;
    let row = |k| Row { label: "", slip: slip(k), width: 0.15, noise: SCATTER * unit() };
    (0..count).map(row).collect()
}

/// A diagnosis that looks for one effect, with few draws: these tests are about the noise.
fn diagnosed(experiment: &Experiment) -> Diagnosis {
    let candidates = Some(vec!["slip_sinkage".to_owned()]);
    let options = DiagnoseOptions { candidates, draws: 99, max_effects: 1, ..DiagnoseOptions::default() };
    diagnose(&baseline(), experiment, &options, &Control::default()).unwrap()
}

/// Soil parameters that are known, so that two are free: the friction angle and the shear modulus.
const KNOWN: &str = "[parameters]\n\"soil.cohesion\" = 1000\n\"soil.k_phi\" = 8.5e5\n\"soil.exponent\" = 1\n\"soil.c1\" = 0.4\n\"soil.c2\" = 0.2\n";

#[test]
fn regress_eleven_rows_without_repeats_leave_the_floor_unknown() {
    for seed in [1, 2] {
        let diagnosis = diagnosed(&written("eleven", "", &[("", sweep(11, seed))], 0.8));
        assert_eq!(diagnosis.verdict, Verdict::Undetermined);
        assert_eq!(diagnosis.noise_floor_source, FloorSource::Unknown);
        assert_eq!(diagnosis.noise_floor["drawbar_pull"].value(), None);
        assert!(diagnosis.cautions.iter().any(|caution| caution.contains("noise floor unknown")));
        // What stands in for the noise is what the model misses: its chi-square is that of its freedom.
        let step = diagnosis.baseline();
        assert!(step.chi_square < 2.0 * step.degrees_of_freedom as f64, "{}", step.chi_square);
        assert!(diagnosis.noise["drawbar_pull"].deviation > 0.5 * step.rmse["drawbar_pull"]);
    }
}

#[test]
fn regress_a_stated_noise_is_not_replaced_by_a_curve_through_eleven_rows() {
    let settings = "[noise]\ndrawbar_pull = 0.3\n";
    let diagnosis = diagnosed(&written("eleven_stated", settings, &[("", sweep(11, 3))], 0.0));
    let noise = diagnosis.noise["drawbar_pull"];
    assert_eq!((noise.deviation, noise.run_share, noise.correlation), (SCATTER, 0.0, 0.0));
    assert_eq!(diagnosis.noise_floor_source, FloorSource::Stated);
    assert!(diagnosis.cautions.iter().all(|caution| !caution.contains("stated noise")), "{:?}", diagnosis.cautions);
    assert!(diagnosis.baseline().chi_square < 100.0, "{}", diagnosis.baseline().chi_square);
}

#[test]
fn property_a_stated_noise_wins_over_a_curve_that_scatters_more() {
    let settings = format!("{KNOWN}[noise]\ndrawbar_pull = 0.1\n");
    let diagnosis = diagnosed(&written("stated", &settings, &[("", sweep(60, 4))], 0.0));
    assert_eq!(diagnosis.noise["drawbar_pull"].deviation, 0.1);
    let cautions = &diagnosis.cautions;
    assert!(cautions.iter().any(|caution| caution.contains("may be too small")), "{cautions:?}");
}

#[test]
fn property_enough_rows_show_their_noise_about_a_curve() {
    const ROWS: usize = 120;
    let diagnosis = diagnosed(&written("many", KNOWN, &[("", sweep(ROWS, 5))], 0.0));
    let error = WITHIN / (2.0 * 0.5 * ROWS as f64).sqrt();
    let found = diagnosis.noise["drawbar_pull"].deviation;
    assert!((found / SCATTER - 1.0).abs() < error, "{found}");
    let cautions = &diagnosis.cautions;
    assert!(cautions.iter().any(|caution| caution.contains("stands in for it")), "{cautions:?}");
    assert!(cautions.iter().all(|caution| !caution.contains("nothing is decided")), "{cautions:?}");
}

const LABELS: [(&str, f64); 6] = [("a", 0.02), ("b", 0.1), ("c", 0.2), ("d", 0.35), ("e", 0.5), ("f", 0.7)];

/// Samples of every label, `count` each, with what a run has in common.
fn labelled(count: usize, width: f64, common: f64, own: f64, unit: &mut impl FnMut() -> f64) -> Vec<Row> {
    let mut rows = Vec::new();
    for (label, slip) in LABELS {
        rows.extend((0..count).map(|_| Row { label, slip, width, noise: common + own * unit() }));
    }
    rows
}

#[test]
fn regress_labels_are_not_pooled_over_runs_with_other_parameters() {
    let unit = &mut draws(6);
    let mut run = |width| labelled(5, width, 0.0, SCATTER, unit);
    let runs = [("\"wheel.width\" = 0.15", run(0.15)), ("\"wheel.width\" = 0.05", run(0.05))];
    let experiment = written("widths", KNOWN, &runs, 0.0);
    assert_eq!(experiment.replicates().len(), 12);
    let comparison = compare(&baseline(), &experiment, &CompareOptions::default()).unwrap();
    let floor = comparison.noise_floor["drawbar_pull"].replicates.unwrap();
    assert_eq!(floor.degrees_of_freedom, 60 - 12);
    let error = WITHIN / (2.0 * floor.degrees_of_freedom as f64).sqrt();
    assert!((floor.deviation / SCATTER - 1.0).abs() < error, "{floor:?}");
    // Pooled, the widths would count as noise.
    let (wide, narrow) = (point(&runs[0].1[0], 0.0).0, point(&runs[1].1[0], 0.0).0);
    assert!((wide - narrow).abs() > 3.0 * SCATTER, "{wide} and {narrow}");
}

#[test]
fn property_planted_scatter_within_and_between_days_is_found() {
    const DAYS: usize = 16;
    let (within, between) = (0.2, 0.5_f64);
    let unit = &mut draws(7);
    let day = |_| {
        let common = between * unit();
        ("", labelled(2, 0.15, common, within, unit))
    };
    let runs: Vec<_> = (0..DAYS).map(day).collect();
    let noise = diagnosed(&written("days", KNOWN, &runs, 0.0)).noise["drawbar_pull"];
    let found_within = noise.deviation * (1.0 - noise.run_share).sqrt();
    let found_between = noise.deviation * noise.run_share.sqrt();
    let error = |freedom: usize| WITHIN / (2.0 * freedom as f64).sqrt();
    assert!((found_within / within - 1.0).abs() < error(DAYS * 11 - 5), "{noise:?}");
    assert!((found_between / between - 1.0).abs() < error(DAYS - 1), "{noise:?}");
}

#[test]
fn property_days_of_one_sample_do_not_tell_a_share() {
    let unit = &mut draws(8);
    let single = |k: usize| {
        let (label, slip) = LABELS[k % LABELS.len()];
        ("", vec![Row { label, slip, width: 0.15, noise: SCATTER * unit() }])
    };
    let runs: Vec<_> = (0..36).map(single).collect();
    let noise = diagnosed(&written("single", KNOWN, &runs, 0.0)).noise["drawbar_pull"];
    assert_eq!((noise.run_share, noise.correlation), (0.0, 0.0));
    assert!((noise.deviation / SCATTER - 1.0).abs() < WITHIN / (2.0 * 30.0_f64).sqrt(), "{noise:?}");
}

#[test]
fn property_repeats_that_contradict_a_stated_noise_are_taken() {
    let unit = &mut draws(9);
    let runs = [("", labelled(4, 0.15, 0.0, SCATTER, unit))];
    let diagnosis = diagnosed(&written("contradicted", &format!("{KNOWN}[noise]\ndrawbar_pull = 0.05\n"), &runs, 0.0));
    let (floor, noise) = (diagnosis.noise_floor["drawbar_pull"], diagnosis.noise["drawbar_pull"]);
    assert!(floor.contradicted && floor.stated == Some(0.05));
    assert_eq!((floor.source(), floor.value()), (FloorSource::Replicates, floor.replicates.map(|p| p.deviation)));
    assert!((noise.deviation / SCATTER - 1.0).abs() < WITHIN / (2.0 * 18.0_f64).sqrt(), "{noise:?}");
    assert!(diagnosis.cautions.iter().any(|caution| caution.contains("contradicted by the repeats")));
}

#[test]
fn agreement_a_calibration_is_the_baseline_of_the_diagnosis() {
    let shipped = Experiment::read(Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/sand_wheel")).unwrap();
    let unit = &mut draws(10);
    let days: Vec<_> = (0..3).map(|_| ("", labelled(2, 0.15, 0.5 * unit(), SCATTER, unit))).collect();
    for experiment in [shipped, written("same", "", &days, 0.4), written("same_few", "", &[("", sweep(20, 11))], 0.4)] {
        let options = CompareOptions { calibrate: true, ..CompareOptions::default() };
        let comparison = compare(&baseline(), &experiment, &options).unwrap();
        let diagnosis = diagnosed(&experiment);
        let (calibration, fit) = comparison.calibrated.as_ref().unwrap();
        let step = diagnosis.baseline();
        for (ours, theirs) in calibration.parameters.iter().zip(&step.parameters) {
            assert_eq!(*ours, theirs.fitted, "{}", experiment.name);
        }
        assert_eq!((calibration.chi_square, &fit.rmse), (step.chi_square, &step.rmse), "{}", experiment.name);
        assert_eq!(comparison.noise_floor, diagnosis.noise_floor, "{}", experiment.name);
    }
}
