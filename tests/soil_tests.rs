//! Tests of a soil by plates and by shear: what is read, what a calibration finds, what is said of k_c and k_phi, and what is known
//! of a soil from one experiment to the next.

#![allow(clippy::unwrap_used, reason = "a test may fail by panicking")]

use bekker::diagnosis::{
    CompareOptions, Comparison, Control, DiagnoseOptions, Diagnosis, Given, SeparateOptions, Verdict, compare,
    diagnose, separate,
};
use bekker::known_soil::KnownSoil;
use bekker::measurement::Experiment;
use bekker::model::{Model, ModelKind};
use bekker::modeldescription::Lookup;
use std::fmt::Write;
use std::path::Path;

/// Exact measurements give the parameters back to what a search resolves.
const FOUND: f64 = 1e-4;

/// A plate test of its own formula: diameters (m), tests of each, k by the width of contact.
fn plates(diameters: &[f64], repeats: usize, scatter: f64, modulus: impl Fn(f64) -> f64) -> Experiment {
    let mut toml = "name = \"plates\"\nkind = \"plate_sinkage\"\n".to_owned();
    let mut files = Vec::new();
    for (k, diameter) in diameters.iter().enumerate() {
        for repeat in 0..repeats {
            let factor = 1.0 + scatter * (repeat as f64 - 0.5 * (repeats - 1) as f64);
            let mut rows = "sinkage,force\n".to_owned();
            for row in 1..=20 {
                let z = 0.0015 * f64::from(row);
                let pressure = modulus(0.5 * diameter) * z.powf(0.9);
                // A scatter of rows beside that of whole tests, in no order.
                let noise = 0.25 * scatter * (7.3 * f64::from(row) + 2.1 * repeat as f64 + 4.7 * k as f64).sin();
                let force = (factor + noise) * pressure * std::f64::consts::PI * diameter * diameter / 4.0;
                writeln!(rows, "{z},{force}").unwrap();
            }
            writeln!(toml, "[[run]]\nfile = \"{k}{repeat}.csv\"\ngroup = \"{k}\"\nparameters = {{ \"plate.diameter\" = {diameter} }}").unwrap();
            files.push((format!("{k}{repeat}.csv"), rows));
        }
    }
    files.push(("experiment.toml".to_owned(), toml));
    Experiment::from_texts(&files.into_iter().collect()).unwrap()
}

fn calibrated(given: Given, experiment: &Experiment) -> Comparison {
    compare(given, experiment, &CompareOptions { calibrate: true, ..CompareOptions::default() }).unwrap()
}

fn value(comparison: &Comparison, name: &str) -> f64 {
    let (calibration, _) = comparison.calibrated.as_ref().unwrap();
    calibration.parameters.iter().find(|parameter| parameter.variable.name == name).unwrap().value
}

fn says(lines: &[String], words: &[&str]) -> bool {
    lines.iter().any(|line| words.iter().all(|word| line.contains(word)))
}

#[test]
fn analytic_plates_of_three_sizes_give_k_c_k_phi_and_n_back() {
    let comparison = calibrated(Given::default(), &plates(&[0.04, 0.08, 0.2], 2, 0.0, |b| 30e3 / b + 2e6));
    for (name, expected) in [("soil.k_c", 30e3), ("soil.k_phi", 2e6), ("soil.exponent", 0.9)] {
        let found = value(&comparison, name);
        assert!((found / expected - 1.0).abs() < FOUND, "{name}: {found}");
    }
    assert!(!says(&comparison.cautions, &["cannot be told apart"]), "{:?}", comparison.cautions);
    // The saved model is the soil, and of it only what was found.
    assert_eq!(comparison.model.kind, ModelKind::SoilTest);
    let text = comparison.model.to_toml().unwrap();
    assert!(text.contains("soil.k_phi") && !text.contains("soil.cohesion"), "{text}");
    let read = Model::from_toml(&text, None).unwrap();
    assert_eq!(read.tested_soil(), comparison.model.tested_soil());
    let rover = Model::preset("gentle_velocity").unwrap().with_rig_of(&read).unwrap();
    assert_eq!(rover.kind, ModelKind::Rover);
    assert!((rover.clone().get("soil.k_phi").unwrap() / 2e6 - 1.0).abs() < FOUND);
    assert_eq!(rover.rover.wheel, Model::preset("gentle_velocity").unwrap().rover.wheel);
}

#[test]
fn property_it_is_said_where_plates_do_not_tell_k_c_from_k_phi() {
    let near = calibrated(Given::default(), &plates(&[0.040, 0.045], 3, 0.04, |b| 30e3 / b + 2e6));
    assert!(
        says(&near.cautions, &["cannot be told apart by contact widths of 20 mm to 22.5 mm"]),
        "{:?}",
        near.cautions
    );
    let one = calibrated(Given::default(), &plates(&[0.1], 3, 0.04, |b| 30e3 / b + 2e6));
    assert!(
        says(&one.cautions, &["all plates have the contact width b = 50 mm", "cannot be told apart"]),
        "{:?}",
        one.cautions
    );
    let apart = calibrated(Given::default(), &plates(&[0.04, 0.08, 0.2], 3, 0.04, |b| 60e3 / b + 2e6));
    assert!(!says(&apart.cautions, &["cannot be told apart"]), "{:?}", apart.cautions);
}

#[test]
fn property_it_is_said_where_k_grows_with_the_plate_so_that_no_pair_fits() {
    let grows = calibrated(Given::default(), &plates(&[0.06, 0.08, 0.1], 3, 0.04, |b| 3e6 * (b / 0.03).powi(2)));
    assert!(
        says(&grows.cautions, &["k grows with the plate", "no pair (k_c, k_phi)", "k < 0 for plates narrower than"]),
        "{:?}",
        grows.cautions
    );
    assert_eq!(value(&grows, "soil.k_c"), 0.0);
}

fn diagnosed(folder: &str) -> Diagnosis {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples").join(folder);
    // As a user runs it.
    let options = DiagnoseOptions::default();
    diagnose(Given::default(), &Experiment::read(folder).unwrap(), &options, &Control::default()).unwrap()
}

#[test]
fn agreement_what_the_generator_hid_in_the_shipped_plates_is_named() {
    let diagnosis = diagnosed("sand_plates");
    assert_eq!((diagnosis.verdict, &diagnosis.effects[..]), (Verdict::EffectMissing, &["seating".to_owned()][..]));
    // `tests/generators/soil_tests.py` hid 3 mm; two standard errors of it.
    let last = diagnosis.last().parameters.iter().find(|p| p.fitted.variable.name == "seating.offset").unwrap();
    let error = last.fitted.deviation.unwrap();
    assert!((last.fitted.value - 0.003).abs() < 2.0 * error && error < 0.0006, "{} +- {error}", last.fitted.value);
}

#[test]
fn agreement_what_the_generator_hid_in_the_shipped_shear_tests_is_named() {
    let diagnosis = diagnosed("sand_shear");
    assert_eq!(
        (diagnosis.verdict, &diagnosis.effects[..]),
        (Verdict::EffectMissing, &["shear_softening".to_owned()][..])
    );
}

#[test]
fn property_only_effects_of_the_test_are_candidates() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/sand_shear");
    let experiment = Experiment::read(folder).unwrap();
    let options = SeparateOptions { calibrate: false, ..SeparateOptions::default() };
    let separation = separate(Given::default(), &experiment, &options).unwrap();
    let known = ["moisture", "shear_rate", "box_friction", "shear_play", "shear_softening"];
    let ids = separation.effects.iter().map(|sight| &sight.effect).chain(&separation.invisible);
    assert!(ids.clone().all(|id| known.contains(&id.as_str())) && ids.count() == known.len());
    let refused = compare(
        Given::default(),
        &experiment,
        &CompareOptions { calibrate: true, added: vec!["slip_sinkage".to_owned()], ..CompareOptions::default() },
    );
    assert!(
        refused.unwrap_err().to_string().contains("no candidate effect `slip_sinkage`; those that can be added are")
    );
}

/// An experiment of one plate with these rows, under these settings.
fn read(settings: &str, rows: &str) -> Result<Experiment, String> {
    let toml = format!("name = \"t\"\nkind = \"plate_sinkage\"\n{settings}\n[[run]]\nfile = \"a.csv\"\n");
    let files = [("experiment.toml", toml), ("a.csv", rows.to_owned())];
    Experiment::from_texts(&files.map(|(name, text)| (name.to_owned(), text)).into()).map_err(|error| error.to_string())
}

#[test]
fn property_what_cannot_be_right_in_a_plate_test_is_refused_in_words() {
    let plate = "parameters = { \"plate.diameter\" = 0.1 }";
    let good = "sinkage,force\n0.001,10\n0.002,20\n0.003,30\n";
    let experiment = read(plate, good).unwrap();
    assert_eq!(experiment.signals(), ["force"]);
    for (settings, rows, words) in [
        (plate, "sinkage,force\n1,10\n2,20\n3,30\n", "unit = \"mm\""),
        (plate, "sinkage,force\n0.001,10\n0.003,30\n0.001,5\n", "without the way back"),
        (plate, "sinkage,force\n0.001,-10\n0.002,-20\n0.003,-30\n", "sign = -1"),
        (plate, "force\n10\n20\n30\n", "needs this column"),
        (plate, "sinkage\n0.001\n0.002\n0.003\n", "force, pressure"),
        (plate, "sinkage,force,slip\n0.001,10,0\n0.002,20,0\n0.003,30,0\n", "unknown column `slip`"),
        ("parameters = { \"plate.diamter\" = 0.1 }", good, "plate.diameter"),
    ] {
        let error = read(settings, rows).and_then(|experiment| {
            compare(Given::default(), &experiment, &CompareOptions::default()).map(|_| ()).map_err(|e| e.to_string())
        });
        assert!(error.as_ref().is_err_and(|error| error.contains(words)), "{words}: {error:?}");
    }
    let unsized_plate = compare(Given::default(), &read("", good).unwrap(), &CompareOptions::default()).unwrap_err();
    assert!(
        unsized_plate.to_string().contains("give `plate.diameter`, or `plate.width` and `plate.length`"),
        "{unsized_plate}"
    );
}

#[test]
fn property_long_recordings_are_averaged_over_equal_steps_in_tests_that_repeat_each_other() {
    let rows = |offset: f64, count: i32| {
        let row = |k: i32| {
            let z = (f64::from(k) + offset) * 0.03 / f64::from(count);
            format!("{z},{}\n", 1e5 * z)
        };
        format!("sinkage,force\n{}", (1..=count).map(row).collect::<String>())
    };
    let toml = "name = \"t\"\nkind = \"plate_sinkage\"\nparameters = { \"plate.diameter\" = 0.1 }\n[[run]]\nfile = \"a.csv\"\n[[run]]\nfile = \"b.csv\"\n";
    let files = [("experiment.toml", toml.to_owned()), ("a.csv", rows(0.0, 300)), ("b.csv", rows(0.4, 500))];
    let experiment = Experiment::from_texts(&files.map(|(name, text)| (name.to_owned(), text)).into()).unwrap();
    assert_eq!(experiment.runs[0].data.rows(), experiment.runs[1].data.rows());
    assert!(experiment.runs[0].data.rows() <= 40 && experiment.runs[0].group == experiment.runs[1].group);
    assert_eq!(experiment.replicates().len(), experiment.runs[0].data.rows());
    for run in &experiment.runs {
        for row in 0..run.data.rows() {
            let (z, force) = (run.data.value("sinkage", row).unwrap(), run.data.value("force", row).unwrap());
            assert!((force / (1e5 * z) - 1.0).abs() < FOUND, "a mean of a straight line lies on it");
        }
    }
    assert!(
        says(&experiment.doubts, &["averaged over"]) && says(&experiment.doubts, &["taken for repeats"]),
        "{:?}",
        experiment.doubts
    );
}

/// A soil that plates found.
fn found() -> KnownSoil {
    calibrated(Given::default(), &plates(&[0.04, 0.08, 0.2], 3, 0.04, |b| 30e3 / b + 2e6)).soil.unwrap()
}

#[test]
fn property_a_found_soil_is_a_prior_of_another_experiment() {
    let soil = found();
    let names: Vec<&str> = soil.parameters.iter().map(|parameter| parameter.name.as_str()).collect();
    assert_eq!(names, ["soil.k_c", "soil.k_phi", "soil.exponent"]);
    assert_eq!(KnownSoil::from_toml(&soil.to_toml().unwrap()).unwrap(), soil);
    // One plate alone tells a sum; with the soil it tells both again.
    let one = plates(&[0.08], 3, 0.04, |b| 30e3 / b + 2e6);
    let given = || Given::default().with_soil(soil.clone(), "soil.toml");
    let with = calibrated(given(), &one);
    let (k_c, k_phi) = (value(&with, "soil.k_c"), value(&with, "soil.k_phi"));
    assert!((k_c / 30e3 - 1.0).abs() < 0.2 && (k_phi / 2e6 - 1.0).abs() < 0.1, "{k_c} {k_phi}");
    assert!(says(&with.sources, &["priors of soil.toml", "with their covariance", "soil.k_c"]), "{:?}", with.sources);
    assert!(!says(&with.cautions, &["moved further"]), "{:?}", with.cautions);
    // What is known twice is known better, by about the root of two.
    let twice = calibrated(given(), &plates(&[0.04, 0.08, 0.2], 3, 0.04, |b| 30e3 / b + 2e6)).soil.unwrap();
    let ratio = twice.parameters[2].sd / soil.parameters[2].sd;
    assert!((0.6..0.8).contains(&ratio), "{ratio}");
}

#[test]
fn property_what_moves_from_a_known_soil_by_two_deviations_is_flagged() {
    let other = plates(&[0.04, 0.08, 0.2], 3, 0.04, |b| 90e3 / b + 6e6);
    let moved = calibrated(Given::default().with_soil(found(), "soil.toml"), &other);
    assert!(
        says(&moved.cautions, &["together the soil moved further from soil.toml than two standard deviations"]),
        "{:?}",
        moved.cautions
    );
    assert!(says(&moved.cautions, &["soil.k_phi moved by"]), "{:?}", moved.cautions);
}

#[test]
fn property_a_known_soil_goes_before_the_class_and_after_the_folder() {
    let soil = found();
    let text = |head: &str| {
        let mut rows = "sinkage,force\n".to_owned();
        (1..=20).for_each(|k| writeln!(rows, "{},{}", 0.001 * f64::from(k), 3.0 * f64::from(k)).unwrap());
        let toml = format!("name = \"t\"\nkind = \"plate_sinkage\"\n{head}\n[[run]]\nfile = \"a.csv\"\n");
        Experiment::from_texts(&[("experiment.toml".to_owned(), toml), ("a.csv".to_owned(), rows)].into()).unwrap()
    };
    let sources = |head: &str| {
        let given = Given::default().with_soil(soil.clone(), "soil.toml");
        compare(given, &text(head), &CompareOptions::default()).unwrap().sources
    };
    let plate = "parameters.\"plate.diameter\" = 0.1";
    let own = sources(&format!("{plate}\npriors.\"soil.exponent\" = {{ mean = 1.0, sd = 0.1 }}"));
    assert!(says(&own, &["soil.exponent: prior 1 +- 0.1 from [priors], not", "from soil.toml"]), "{own:?}");
    let class = sources(&format!("soil.class = \"dry sand\"\n{plate}"));
    assert!(
        !says(&class, &["priors of the soil class", "soil.exponent"])
            && says(&class, &["priors of soil.toml", "soil.exponent"]),
        "{class:?}"
    );
    let near = soil.parameters[2].value + soil.parameters[2].sd;
    let held = sources(&format!("{plate}\nparameters.\"soil.exponent\" = {near}"));
    assert!(
        says(&held, &["soil.exponent", "is taken for known, +1.0 standard deviations", "the others follow it"]),
        "{held:?}"
    );
    let far = sources(&format!("{plate}\nparameters.\"soil.exponent\" = 1.4"));
    assert!(says(&far, &["is taken for known", "used without it"]), "{far:?}");
}

#[test]
fn property_a_found_soil_holds_a_width_also_where_a_bound_is_active() {
    let grows = calibrated(Given::default(), &plates(&[0.06, 0.08, 0.1], 3, 0.04, |b| 3e6 * (b / 0.03).powi(2)));
    let soil = grows.soil.unwrap();
    let k_c = &soil.parameters[0];
    assert!(k_c.at_bound && k_c.value == 0.0 && k_c.sd > 0.0 && k_c.sd.is_finite(), "{k_c:?}");
    assert!(soil.covariance().cholesky().is_some());
}
