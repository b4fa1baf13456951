//! What an experiment can tell apart, before and after it is made, and which would tell more.
#![allow(clippy::unwrap_used, reason = "a test may fail by panicking")]

use bekker::diagnosis::{
    CompareError, CompareOptions, Control, DiagnoseOptions, Diagnosis, Likeness, NoiseSource, Progress,
    SeparateOptions, Separation, SingleWheelPlan, TraversePlan, Verdict, compare, diagnose, modelled, sensitivity,
    separate,
};
use bekker::measurement::{Experiment, Prior, Table};
use bekker::model::Model;
use bekker::modeldescription::Lookup;
use nalgebra::{DMatrix, DVector};
use rand::SeedableRng;
use rand_distr::{Distribution, Normal};
use std::path::PathBuf;
use std::sync::Mutex;
use std::time::{Duration, Instant};

/// Whitened size at which an effect counts as found, and how closely it is met: the search ends where wanted over found is within
/// 1 % of 1, so that found over wanted is within 1.01 %, rounded up.
const DETECTABLE: f64 = 5.0;
const MET: f64 = 0.011;

fn model() -> Model {
    let mut model = Model::preset("two_wheeled_speed").unwrap();
    model.set("soil.shear_modulus", 0.015).unwrap();
    model
}

fn plan(loads: &[f64], speeds: &[f64]) -> SingleWheelPlan {
    SingleWheelPlan {
        loads: loads.to_vec(),
        wheel_speeds: speeds.to_vec(),
        repeats: 1,
        ..SingleWheelPlan::of(&model())
    }
}

fn look(experiment: &Experiment) -> Separation {
    separate(&model(), experiment, &SeparateOptions::default()).unwrap()
}

fn smallest(separation: &Separation, effect: &str) -> f64 {
    separation.effect(effect).unwrap().smallest[0].value.unwrap()
}

fn folder(name: &str) -> PathBuf {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(name);
    let _ = std::fs::remove_dir_all(&folder);
    folder
}

/// Size of a change of the measured values in standard deviations, after a least-squares fit of the free parameters took
/// what it can.
fn size_beyond(separation: &Separation, experiment: &Experiment, slopes: &[Vec<f64>], change: &[f64]) -> f64 {
    let mut deviations = Vec::new();
    for run in &experiment.runs {
        for signal in &run.measured {
            deviations.extend(std::iter::repeat_n(separation.noise[signal].model.deviation, run.data.rows()));
        }
    }
    let white = |values: &[f64]| values.iter().zip(&deviations).map(|(v, sd)| v / sd).collect::<Vec<_>>();
    let columns: Vec<DVector<f64>> = slopes.iter().map(|slope| DVector::from_vec(white(slope)).normalize()).collect();
    let basis = DMatrix::from_columns(&columns).qr().q();
    let change = DVector::from_vec(white(change));
    (&change - &basis * (basis.transpose() * &change)).norm()
}

#[test]
fn agreement_the_smallest_strength_is_five_sigma_beyond_a_refit() {
    let experiment = plan(&[10.0, 20.0, 40.0], &[0.3, 1.2]).experiment().unwrap();
    let separation = look(&experiment);
    let absorbing: Vec<&str> = separation.absorbing.iter().map(|(name, _)| name.as_str()).collect();
    assert!(absorbing.contains(&"soil.friction_angle") && !absorbing.contains(&"wheel.radius"), "{absorbing:?}");
    let base = sensitivity(&model(), &experiment, &absorbing).unwrap();
    let mut checked = 0;
    for sight in &separation.effects {
        for strength in &sight.smallest {
            let Some(value) = strength.value else { continue };
            let mut with = model();
            with.set(&strength.variable.name, value).unwrap();
            let changed = modelled(&with, &experiment).unwrap();
            let change: Vec<f64> = changed.iter().zip(&base.values).map(|(a, b)| a - b).collect();
            let size = size_beyond(&separation, &experiment, &base.slopes, &change);
            assert!((size / DETECTABLE - 1.0).abs() < MET, "{}: {value} gives {size}", strength.variable.name);
            checked += 1;
        }
    }
    assert!(checked >= 4, "{:?}", separation.effects);
}

#[test]
fn property_dry_and_viscous_friction_need_two_speeds() {
    let one = look(&plan(&[20.0], &[0.3]).experiment().unwrap());
    let two = look(&plan(&[20.0], &[0.3, 1.2]).experiment().unwrap());
    let cosine = |separation: &Separation| separation.cosine("coulomb_friction", "viscous_friction").unwrap();
    assert!(cosine(&one) > 0.999, "{}", cosine(&one));
    assert_eq!(one.ties().next().unwrap().likeness, Likeness::Same);
    assert!(cosine(&two) < 0.8, "{}", cosine(&two));
}

#[test]
fn property_less_noise_and_known_soil_show_weaker_effects() {
    let mut experiment = plan(&[20.0], &[0.3]).experiment().unwrap();
    let usual = look(&experiment);
    assert!(usual.noise.values().all(|noise| noise.source == NoiseSource::Default));
    for (signal, noise) in &usual.noise {
        experiment.noise.insert(signal.clone(), 0.5 * noise.model.deviation);
    }
    let stated = look(&experiment);
    assert!(stated.noise.values().all(|noise| noise.source == NoiseSource::Stated));
    // A torque that is added is linear to rounding.
    let ratio = smallest(&stated, "coulomb_friction") / smallest(&usual, "coulomb_friction");
    assert!((ratio - 0.5).abs() < MET, "{ratio}");
    for (name, value) in &usual.absorbing {
        experiment.priors.insert(name.clone(), Prior { mean: *value, deviation: 0.01 * value.abs().max(1e-3) });
    }
    let share = |separation: &Separation| separation.effect("slip_sinkage").unwrap().visible_share;
    assert!(share(&look(&experiment)) > 2.0 * share(&stated), "priors keep the soil from absorbing the effect");
}

#[test]
fn property_what_is_too_weak_is_said_to_be_unseen() {
    let mut experiment = plan(&[20.0], &[0.3]).experiment().unwrap();
    experiment.noise =
        [("drawbar_pull", 1e3), ("torque", 1e3), ("sinkage", 1.0)].map(|(s, sd)| (s.to_owned(), sd)).into();
    let separation = look(&experiment);
    assert!(!separation.effects.is_empty());
    assert!(separation.effects.iter().all(|sight| !sight.visible), "{:?}", separation.effects);
    assert!(separation.effects.iter().flat_map(|sight| &sight.smallest).all(|strength| strength.value.is_none()));
    assert!(separation.pairs.is_empty());
    assert!(separation.invisible.iter().any(|id| id == "tether"), "a carriage does not travel");
}

#[test]
fn property_a_plan_reads_back_and_cannot_be_compared() {
    for (name, experiment) in [
        ("plan_wheel", SingleWheelPlan::of(&model()).experiment().unwrap()),
        ("plan_rover", TraversePlan { duration: 4.0, ..TraversePlan::of(&model()) }.experiment().unwrap()),
    ] {
        let folder = folder(name);
        experiment.write(&folder).unwrap();
        let read = Experiment::read_plan(&folder).unwrap();
        assert_eq!(read.signals(), experiment.signals());
        assert_eq!(read.parameters, experiment.parameters);
        for (read, planned) in read.runs.iter().zip(&experiment.runs) {
            assert_eq!((&read.name, &read.group, &read.x0), (&planned.name, &planned.group, &planned.x0));
            assert_eq!((&read.terrain, &read.parameters), (&planned.terrain, &planned.parameters));
            for column in &planned.inputs {
                assert_eq!(read.data.column(column), planned.data.column(column));
            }
        }
        let refused = Experiment::read(&folder).unwrap_err().to_string();
        assert!(refused.contains("nothing is measured yet") && refused.contains("runs"), "{refused}");
        assert!(matches!(compare(&model(), &read, &CompareOptions::default()), Err(CompareError::NothingMeasured)));
        let diagnosed = diagnose(&model(), &read, &DiagnoseOptions::default(), &Control::default());
        assert_eq!(diagnosed.err(), Some(CompareError::NothingMeasured));
        assert!(experiment.write(&folder).is_err(), "what is recorded there is kept");
    }
}

#[test]
fn property_impossible_plans_are_refused() {
    let base = SingleWheelPlan::of(&model());
    let refused = |plan: SingleWheelPlan| plan.experiment().unwrap_err().to_string();
    assert!(refused(SingleWheelPlan { loads: vec![], ..base.clone() }).contains("loads"));
    assert!(refused(SingleWheelPlan { loads: vec![f64::NAN], ..base.clone() }).contains("NaN"));
    assert!(refused(SingleWheelPlan { slips: vec![0.1, -1.0], ..base.clone() }).contains("-1"));
    assert!(refused(SingleWheelPlan { repeats: 0, ..base }).contains("repeats"));
    let base = TraversePlan::of(&model());
    let refused = |plan: TraversePlan| plan.experiment().unwrap_err().to_string();
    assert!(refused(TraversePlan { slopes: vec![1.0], ..base.clone() }).contains("slopes"));
    assert!(refused(TraversePlan { duration: f64::INFINITY, ..base }).contains("duration"));
}

#[test]
fn property_a_planned_hill_is_driven_up_and_down() {
    let slope = 6.0_f64.to_radians();
    let plan = TraversePlan {
        speeds: vec![0.2],
        slopes: vec![slope],
        masses: Vec::new(),
        repeats: 1,
        signals: vec!["pitch".to_owned()],
        ..TraversePlan::of(&model())
    };
    let pitch = modelled(&model(), &plan.experiment().unwrap()).unwrap();
    let (low, high) = pitch.iter().fold((0.0_f64, 0.0_f64), |(l, h), p| (l.min(*p), h.max(*p)));
    // The rear wheel sinks deeper than the front one uphill, so the pitch passes the slope a little.
    assert!(high > 0.8 * slope && high < 1.5 * slope && low < -0.6 * slope, "{low} {high}");
    assert!(pitch[0].abs() < 0.02, "it starts on level ground: {}", pitch[0]);
}

/// Measurements of a hidden effect under the inputs of a plan.
fn measured(planned: &Experiment, hidden: &[(&str, f64)], noise: &[(&str, f64)]) -> Experiment {
    let mut truth = model();
    for (name, value) in hidden {
        truth.set(name, *value).unwrap();
    }
    let values = modelled(&truth, planned).unwrap();
    let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(7);
    let mut experiment = planned.clone();
    let mut at = 0;
    for run in &mut experiment.runs {
        let rows = run.data.rows();
        // Time and inputs stand before what is measured.
        let given = run.data.names().iter().filter(|name| !run.measured.contains(name));
        let mut columns: Vec<Vec<f64>> = given.map(|name| run.data.column(name).unwrap().to_vec()).collect();
        for signal in &run.measured {
            let deviation = noise.iter().find(|(name, _)| name == signal).unwrap().1;
            let error = Normal::new(0.0, deviation).unwrap();
            columns.push(values[at..at + rows].iter().map(|value| value + error.sample(&mut rng)).collect());
            at += rows;
        }
        let mut table = Table::new(run.data.names().iter().cloned()).unwrap();
        for row in 0..rows {
            table.push(&columns.iter().map(|column| column[row]).collect::<Vec<_>>()).unwrap();
        }
        run.data = table;
    }
    experiment
}

#[test]
fn property_a_tie_is_followed_by_an_experiment_that_separates_it() {
    let planned = SingleWheelPlan { repeats: 3, ..plan(&[20.0], &[0.3]) }.experiment().unwrap();
    let noise = [("drawbar_pull", 0.1), ("torque", 0.01), ("sinkage", 0.0003)];
    let experiment = measured(&planned, &[("coulomb_friction.torque", 0.2)], &noise);
    let candidates = ["coulomb_friction", "viscous_friction", "slip_sinkage"].map(str::to_owned).to_vec();
    let options = DiagnoseOptions { candidates: Some(candidates.clone()), draws: 199, ..Default::default() };
    let diagnosis = diagnose(&model(), &experiment, &options, &Control::default()).unwrap();
    let frictions = ["coulomb_friction", "viscous_friction"].map(str::to_owned);
    assert!(frictions.iter().all(|id| diagnosis.tied().contains(&id.as_str())), "{:?}", diagnosis.tied());
    let first = &diagnosis.suggestions[0];
    assert_eq!(diagnosis.next_experiment(), first.text);
    assert!(first.text.contains("second wheel speed") && first.text.contains("falls from 1.00"), "{}", first.text);
    assert!(frictions.iter().all(|id| first.effects.contains(id)), "{first:?}");
    // The figures hold: the experiment that is suggested does separate them.
    let speeds: Vec<f64> = vec![0.3, 1.2];
    let next = SingleWheelPlan { repeats: 3, ..plan(&[20.0], &speeds) }.experiment().unwrap();
    let separation = separate(&diagnosis.improved, &next, &SeparateOptions::default());
    assert!(separation.is_ok());
    let followed = measured(&next, &[("coulomb_friction.torque", 0.2)], &noise);
    let options = DiagnoseOptions { candidates: Some(candidates), draws: 199, ..Default::default() };
    let again = diagnose(&model(), &followed, &options, &Control::default()).unwrap();
    assert_eq!(again.effects, ["coulomb_friction"], "{:?}", again.verdict);
}

#[test]
fn property_what_a_flat_traverse_hides_another_would_show() {
    let planned = TraversePlan {
        speeds: vec![0.1],
        slopes: vec![0.0],
        masses: Vec::new(),
        duration: 6.0,
        every: 0.2,
        repeats: 2,
        signals: ["x", "pitch", "wheel[1].torque"].map(str::to_owned).to_vec(),
        ..TraversePlan::of(&model())
    };
    let noise = [("x", 0.01), ("pitch", 0.01), ("wheel[1].torque", 0.5)];
    let experiment = measured(&planned.experiment().unwrap(), &[], &noise);
    let candidates = Some(vec!["coulomb_friction".to_owned()]);
    let options = DiagnoseOptions { candidates, draws: 99, ..Default::default() };
    let diagnosis = diagnose(&model(), &experiment, &options, &Control::default()).unwrap();
    let first = &diagnosis.suggestions[0];
    assert!(first.text.starts_with("repeat with ") && first.text.contains("it would show"), "{first:?}");
    assert_eq!(first.effects, ["coulomb_friction"], "{first:?}");
    assert!(first.text.contains("coulomb_friction from "), "the strength that it would find: {first:?}");
}

/// Time within which a stop has to be answered.
const ANSWER: Duration = Duration::from_secs(2);

/// A diagnosis that is told to stop when `stage` begins, and how long it took from there.
fn stopped_at(
    stage: &str,
    experiment: &Experiment,
    options: &DiagnoseOptions,
) -> (Result<Diagnosis, CompareError>, Duration) {
    let asked: Mutex<Option<Instant>> = Mutex::new(None);
    let progress = |progress: Progress| {
        if progress.stage.contains(stage) {
            asked.lock().unwrap().get_or_insert_with(Instant::now);
        }
    };
    let stop = || asked.lock().unwrap().is_some();
    let control = Control { progress: &progress, stop: &stop, ..Control::default() };
    let diagnosis = diagnose(&model(), experiment, options, &control);
    let asked = asked.lock().unwrap().expect("the stage was reached");
    (diagnosis, asked.elapsed())
}

#[test]
fn property_an_interrupted_diagnosis_returns_what_it_has() {
    let planned = SingleWheelPlan { repeats: 3, ..plan(&[20.0], &[0.3]) }.experiment().unwrap();
    let noise = [("drawbar_pull", 0.1), ("torque", 0.01), ("sinkage", 0.0003)];
    let experiment = measured(&planned, &[], &noise);
    let options = DiagnoseOptions::default();
    let (nothing, took) = stopped_at("calibrating", &experiment, &options);
    assert_eq!(nothing.err(), Some(CompareError::Interrupted));
    assert!(took < ANSWER, "{took:?}");
    let (diagnosis, took) = stopped_at("fitting each effect", &experiment, &options);
    let diagnosis = diagnosis.unwrap();
    assert!(took < ANSWER, "{took:?}");
    assert!(diagnosis.interrupted && diagnosis.verdict == Verdict::Undetermined);
    assert!(diagnosis.not_tried.iter().any(|line| line.starts_with("fits of")), "{:?}", diagnosis.not_tried);
    assert!(diagnosis.baseline().rmse["drawbar_pull"] < 0.2);
    assert!(diagnosis.improved.to_toml().is_ok());
}

#[test]
fn property_a_traverse_answers_a_stop_at_any_stage() {
    let planned = TraversePlan {
        speeds: vec![0.1],
        slopes: vec![0.0],
        masses: Vec::new(),
        duration: 6.0,
        every: 0.2,
        repeats: 2,
        signals: ["x", "pitch", "wheel[1].torque"].map(str::to_owned).to_vec(),
        ..TraversePlan::of(&model())
    };
    let noise = [("x", 0.001), ("pitch", 0.001), ("wheel[1].torque", 0.02)];
    let experiment = measured(&planned.experiment().unwrap(), &[("coulomb_friction.torque", 0.2)], &noise);
    let candidates = ["coulomb_friction", "viscous_friction", "drag"].map(str::to_owned).to_vec();
    let options = DiagnoseOptions { candidates: Some(candidates), draws: 199, ..Default::default() };
    for stage in ["calibrating", "noise alone", "fitting each effect", "predicting", "planning"] {
        let (diagnosis, took) = stopped_at(stage, &experiment, &options);
        assert!(took < ANSWER, "{stage}: {took:?}");
        match diagnosis {
            Err(error) => {
                assert_eq!(error, CompareError::Interrupted, "{stage}");
                assert!(["calibrating", "noise alone"].contains(&stage), "{stage}");
            }
            Ok(diagnosis) => {
                assert!(diagnosis.interrupted && diagnosis.suggestions.is_empty(), "{stage}");
                assert!(!diagnosis.not_tried.is_empty(), "{stage}");
                assert!(stage == "planning" || diagnosis.verdict == Verdict::Undetermined, "{stage}");
            }
        }
    }
}

#[test]
fn property_a_budget_decides_what_is_tried_and_changes_no_number() {
    let planned = SingleWheelPlan { repeats: 3, ..plan(&[20.0], &[0.3]) }.experiment().unwrap();
    let noise = [("drawbar_pull", 0.1), ("torque", 0.01), ("sinkage", 0.0003)];
    let experiment = measured(&planned, &[("coulomb_friction.torque", 0.2)], &noise);
    let candidates = ["coulomb_friction", "slip_sinkage", "drag"].map(str::to_owned).to_vec();
    let options = DiagnoseOptions { candidates: Some(candidates), draws: 199, ..Default::default() };
    let within = |seconds: f64| {
        let control = Control { budget: Some(Duration::from_secs_f64(seconds)), ..Control::default() };
        diagnose(&model(), &experiment, &options, &control).unwrap()
    };
    let whole = diagnose(&model(), &experiment, &options, &Control::default()).unwrap();
    assert!(whole.not_tried.is_empty() && !whole.interrupted);
    let short = within(1e-3);
    assert!(!short.interrupted && short.verdict == Verdict::Undetermined);
    assert_eq!(short.not_tried[0], "fits of coulomb_friction, drag, slip_sinkage, coulomb_friction + drag and 2 more");
    assert!(short.candidates.iter().all(|candidate| !candidate.refitted));
    assert_eq!(short.baseline().chi_square, whole.baseline().chi_square);
    assert_eq!(short.baseline().parameters, whole.baseline().parameters);
    assert_eq!((short.smallest_p, short.lack_of_fit), (whole.smallest_p, whole.lack_of_fit));
    assert_eq!(within(1e5).to_json(), whole.to_json(), "enough time changes nothing");
}

#[test]
fn property_a_carriage_with_known_soil_is_asked_for_at_most_three_things_that_it_can_do() {
    let mut planned = SingleWheelPlan { repeats: 3, ..plan(&[20.0], &[0.3]) }.experiment().unwrap();
    for (name, value) in [("soil.cohesion", 1000.0), ("soil.friction_angle", 29.0_f64.to_radians())] {
        planned.priors.insert(name.to_owned(), Prior { mean: value, deviation: 0.05 * value });
    }
    let noise = [("drawbar_pull", 0.1), ("torque", 0.01), ("sinkage", 0.0003)];
    // An exit angle that other effects may stand in for at one load, and friction, which one speed does not tell apart.
    for hidden in [[("exit_angle.lambda", 0.2)], [("coulomb_friction.torque", 0.2)]] {
        let experiment = measured(&planned, &hidden, &noise);
        let options = DiagnoseOptions { draws: 199, ..Default::default() };
        let diagnosis = diagnose(&model(), &experiment, &options, &Control::default()).unwrap();
        assert!(diagnosis.suggestions.len() <= 3, "{:?}", diagnosis.suggestions);
        for suggestion in &diagnosis.suggestions {
            for wrong in ["rover", "wheel by wheel", "plate and a shear ring", "rut", " .. "] {
                assert!(!suggestion.text.contains(wrong), "`{wrong}` in: {}", suggestion.text);
            }
        }
    }
}

#[test]
fn property_a_standard_error_never_exceeds_the_prior_or_the_bounds() {
    let mut planned = SingleWheelPlan { repeats: 1, ..plan(&[20.0], &[0.3]) }.experiment().unwrap();
    let noise = [("drawbar_pull", 1e-3), ("torque", 1e-4), ("sinkage", 1e-5)];
    planned.noise = noise.map(|(signal, deviation)| (signal.to_owned(), deviation)).into();
    // A prior that the data hardly add to, and a misfit of hundreds of standard deviations by which the error is enlarged.
    planned.priors.insert("soil.c2".to_owned(), Prior { mean: 0.2, deviation: 1e-3 });
    let experiment = measured(&planned, &[("slip_sinkage.n1", 0.4)], &noise);
    let options = CompareOptions { calibrate: true, ..CompareOptions::default() };
    let (calibration, _) = compare(&model(), &experiment, &options).unwrap().calibrated.unwrap();
    assert!(calibration.chi_square > 100.0 * calibration.degrees_of_freedom as f64, "{}", calibration.chi_square);
    let known = calibration.parameters.iter().find(|parameter| parameter.variable.name == "soil.c2").unwrap();
    assert!(known.deviation.is_none_or(|deviation| deviation <= 1e-3), "{:?}", known.deviation);
    for parameter in &calibration.parameters {
        let width = parameter.variable.max - parameter.variable.min;
        assert!(parameter.deviation.is_none_or(|deviation| deviation <= width), "{}", parameter.variable.name);
    }
    assert!(known.deviation.is_some() || known.at_bound);
}

#[test]
fn property_a_made_experiment_counts_with_the_scatter_of_its_repeats() {
    let planned = SingleWheelPlan { repeats: 3, ..plan(&[20.0], &[0.3, 1.2]) }.experiment().unwrap();
    let noise = [("drawbar_pull", 0.1), ("torque", 0.01), ("sinkage", 0.0003)];
    let separation = look(&measured(&planned, &[], &noise));
    assert!(separation.calibrated);
    for (signal, deviation) in noise {
        let assumed = &separation.noise[signal];
        assert_eq!(assumed.source, NoiseSource::Replicates);
        // 40 degrees of freedom: a scatter of 11 %; three of them.
        assert!((assumed.model.deviation / deviation - 1.0).abs() < 0.34, "{signal}: {}", assumed.model.deviation);
    }
}
