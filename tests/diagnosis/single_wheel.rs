//! The diagnosis of a wheel on a carriage: the shipped experiment, whose hidden effect is known, and what is made of it.

use bekker::diagnosis::{
    CompareOptions, Control, DiagnoseOptions, Diagnosis, Progress, Spread, Task, Verdict, compare, diagnose,
};
use bekker::measurement::Experiment;
use bekker::model::Model;
use bekker::modeldescription::Lookup;
use std::path::Path;
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

/// What `tests/generators/single_wheel.py` hid: n1 of Ding's slip-sinkage, and a noise of 2 % of each signal's RMS.
const HIDDEN: f64 = 0.35;

/// Standard errors within which a fitted value must lie: 1 in 16,000 beyond.
const WITHIN: f64 = 4.0;

fn model() -> Model {
    Model::preset("two_wheeled").unwrap()
}

fn shipped() -> Experiment {
    Experiment::read(Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/sand_wheel")).unwrap()
}

/// Fewer candidates and draws, for tests that are about something else.
fn quick() -> DiagnoseOptions {
    let candidates = ["slip_sinkage", "coulomb_friction", "torque_scale"].map(str::to_owned).to_vec();
    DiagnoseOptions { candidates: Some(candidates), draws: 199, ..DiagnoseOptions::default() }
}

fn diagnosed(experiment: &Experiment, options: &DiagnoseOptions) -> Diagnosis {
    diagnose(&model(), experiment, options, &Control::default()).unwrap()
}

#[test]
fn agreement_the_hidden_effect_of_the_shipped_experiment_is_named() {
    let diagnosis = diagnosed(&shipped(), &DiagnoseOptions::default());
    assert_eq!(diagnosis.verdict, Verdict::EffectMissing);
    assert_eq!(diagnosis.effects, ["slip_sinkage"]);
    let best = &diagnosis.candidates[0];
    assert!(best.effect == "slip_sinkage" && !best.tied && best.p_value <= diagnosis.smallest_p);
    let sum: f64 = diagnosis.candidates.iter().map(|c| c.probability).sum::<f64>();
    assert!(best.probability > 0.9 && sum + diagnosis.share.enough + diagnosis.share.other < 1.5);
    let last = diagnosis.last();
    let n1 = &last.parameters.iter().find(|p| p.fitted.variable.name == "slip_sinkage.n1").unwrap().fitted;
    assert!((n1.value - HIDDEN).abs() < WITHIN * n1.deviation.unwrap(), "{} +- {:?}", n1.value, n1.deviation);
    // What is left is noise: chi-square within its own scatter, doubled since the noise itself is estimated.
    let freedom = last.degrees_of_freedom as f64;
    assert!((last.chi_square - freedom).abs() < 2.0 * WITHIN * (2.0 * freedom).sqrt(), "{}", last.chi_square);
    for (signal, before) in &diagnosis.baseline().heldout_rmse {
        let floor = diagnosis.noise_floor[signal].value().unwrap();
        let after = last.heldout_rmse[signal];
        // Nine tenths of the removable error on what was left out are gone.
        assert!(after - floor < 0.1 * (before - floor), "{signal}: {before} -> {after}, floor {floor}");
    }
}

#[test]
fn agreement_the_improved_model_shows_the_smaller_error_without_any_fit() {
    let experiment = shipped();
    let diagnosis = diagnosed(&experiment, &quick());
    let text = diagnosis.improved.to_toml().unwrap();
    let mut saved = Model::from_toml(&text, None).unwrap();
    assert!(saved.get("slip_sinkage.n1").unwrap() > 0.0);
    let again = compare(&saved, &experiment, &CompareOptions::default()).unwrap();
    for (signal, error) in &diagnosis.last().rmse {
        assert_eq!(again.fit().rmse[signal], *error, "{signal}");
    }
}

#[test]
fn property_any_number_of_threads_gives_the_same_bits() {
    let experiment = shipped();
    let with = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| diagnosed(&experiment, &quick()).to_json().to_string())
    };
    let one = with(1);
    assert!(one.contains("\"slip_sinkage\""));
    assert!(with(3) == one, "3 threads differ from 1");
}

#[test]
fn property_fits_made_elsewhere_give_the_same_answer() {
    /// Sends each task and outcome through text, as an executor on another machine would.
    struct Elsewhere(AtomicUsize);
    impl Spread for Elsewhere {
        fn fits(
            &self,
            tasks: &[Task],
            _noise: &bekker::diagnosis::Noise,
            local: &(dyn Fn(&Task) -> Option<bekker::diagnosis::Outcome> + Sync),
        ) -> Vec<Option<bekker::diagnosis::Outcome>> {
            let made = |task: &Task| {
                self.0.fetch_add(1, Ordering::Relaxed);
                let there: Task = serde_json::from_str(&serde_json::to_string(task).unwrap()).unwrap();
                let back = serde_json::to_string(&local(&there)).unwrap();
                serde_json::from_str(&back).unwrap()
            };
            tasks.iter().map(made).collect()
        }
    }
    let (experiment, spread) = (shipped(), Elsewhere(AtomicUsize::new(0)));
    let control = Control { spread: &spread, ..Control::default() };
    let there = diagnose(&model(), &experiment, &quick(), &control).unwrap();
    assert!(spread.0.load(Ordering::Relaxed) >= 3);
    assert_eq!(there.to_json(), diagnosed(&experiment, &quick()).to_json());
}

#[test]
fn property_an_interrupted_diagnosis_keeps_what_it_has() {
    let (stop, told) = (AtomicBool::new(false), Mutex::new(Vec::<f64>::new()));
    let progress = |progress: Progress| {
        told.lock().unwrap().push(progress.done / progress.total);
        if progress.done / progress.total > 0.4 {
            stop.store(true, Ordering::Relaxed);
        }
    };
    let stopped = || stop.load(Ordering::Relaxed);
    let control = Control { progress: &progress, stop: &stopped, ..Control::default() };
    let diagnosis = diagnose(&model(), &shipped(), &quick(), &control).unwrap();
    assert!(diagnosis.interrupted && diagnosis.profiles.is_empty());
    assert!(diagnosis.baseline().rmse["sinkage"] > 0.0);
    let told = told.into_inner().unwrap();
    assert!(told.windows(2).all(|pair| pair[0] <= pair[1]) && told.last() == Some(&1.0), "{told:?}");
}

#[test]
fn property_effects_can_be_part_of_the_baseline() {
    let among = |candidates: &[&str]| DiagnoseOptions {
        added: vec!["slip_sinkage".to_owned()],
        candidates: Some(candidates.iter().map(|id| (*id).to_owned()).collect()),
        ..quick()
    };
    let diagnosis = diagnosed(&shipped(), &among(&["coulomb_friction", "torque_scale"]));
    assert_eq!(diagnosis.verdict, Verdict::Explained, "{:?}", diagnosis.effects);
    // It is no candidate any more.
    let again = diagnose(&model(), &shipped(), &among(&["slip_sinkage"]), &Control::default());
    assert!(again.unwrap_err().to_string().contains("slip_sinkage"));
}

#[test]
fn property_what_cannot_show_on_a_carriage_is_said_to_be_invisible() {
    let diagnosis =
        diagnosed(&shipped(), &DiagnoseOptions { draws: 199, max_effects: 0, ..DiagnoseOptions::default() });
    let none = [
        "multi_pass",
        "soft_patch",
        "slope_strength",
        "centre_of_mass",
        "pitch_bias",
        "tether",
        "sensor_lag",
        "tracking_delay",
    ];
    for id in none.iter().chain(&["suspension_friction", "winding_heat", "voltage_limit"]) {
        assert!(diagnosis.invisible.iter().any(|other| other == id) || !listed(id), "{id}");
        assert!(diagnosis.candidates.iter().all(|candidate| candidate.effect != *id), "{id}");
    }
}

/// Whether the model lists an effect at all: joint friction needs joints.
fn listed(id: &str) -> bool {
    model().list().iter().any(|(variable, _)| variable.name.starts_with(&format!("{id}.")))
}

#[test]
fn property_bad_requests_are_refused_by_name() {
    let experiment = shipped();
    let unknown = DiagnoseOptions { candidates: Some(vec!["slip_sinkge".to_owned()]), ..DiagnoseOptions::default() };
    let message = diagnose(&model(), &experiment, &unknown, &Control::default()).unwrap_err().to_string();
    assert!(message.contains("slip_sinkge") && message.contains("slip_sinkage"), "{message}");
    let mut few = experiment.clone();
    few.runs.truncate(1);
    few.runs[0].measured.retain(|signal| signal == "sinkage");
    for name in ["load", "slip", "wheel_speed", "sinkage"] {
        assert!(few.runs[0].data.column(name).is_some());
    }
    few.runs[0].group = None;
    let error = diagnose(&model(), &few, &quick(), &Control::default());
    // Nine values and seven free parameters can be fitted; what comes of it must not be a name.
    let diagnosis = error.unwrap();
    assert_ne!(diagnosis.verdict, Verdict::EffectMissing, "{:?}", diagnosis.effects);
}
