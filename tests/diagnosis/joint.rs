//! Several experiments on one soil, diagnosed together: what is shared, what stays with each, and where an effect acts.

use crate::noisy_wheel::{wheel_on, wheel_with};
use bekker::diagnosis::{
    CompareError, CompareOptions, Comparison, Control, DiagnoseOptions, Diagnosis, Given, Verdict, compare, diagnose,
    plain_effect,
};
use bekker::measurement::{Experiment, JointError, Prior};
use bekker::modeldescription::Lookup;
use std::path::Path;

/// Standard errors within which an estimate must lie: 1 in 16,000 beyond.
const WITHIN: f64 = 4.0;
/// n1 of Ding's slip-sinkage where it acts.
const HIDDEN: f64 = 0.25;

/// A wheel of this width (m) on the default soil, `n1` of slip-sinkage, measured three times under two loads.
fn wheel(folder: &str, name: &str, width: f64, n1: f64, settings: &str) -> Experiment {
    wheel_on(folder, name, width, n1, settings, 1.0)
}

/// Two wheels, of which the second one has slip-sinkage of `n1`.
fn pair(folder: &str, n1: f64) -> Experiment {
    Experiment::joint(vec![wheel(folder, "narrow", 0.10, 0.0, ""), wheel(folder, "wide", 0.16, n1, "")]).unwrap()
}

fn diagnosed(experiment: &Experiment) -> Diagnosis {
    // An effect is tried wherever it may act.
    let candidates = Some(["slip_sinkage", "torque_scale"].map(str::to_owned).to_vec());
    let options = DiagnoseOptions { candidates, draws: 199, ..DiagnoseOptions::default() };
    diagnose(Given::default(), experiment, &options, &Control::default()).unwrap()
}

#[test]
fn property_each_experiment_keeps_its_signals_runs_and_parameters() {
    let joint = pair("names", 0.0);
    assert_eq!(joint.name, "narrow + wide");
    assert_eq!(joint.runs.len(), 12);
    assert_eq!(joint.runs_of_parts(), [0..6, 6..12]);
    assert_eq!(joint.signals()[..2], ["narrow.drawbar_pull", "narrow.torque"]);
    let (first, last) = (&joint.runs[0], &joint.runs[11]);
    assert_eq!((first.name.as_str(), last.name.as_str()), ("narrow/load25_a", "wide/load50_c"));
    assert_eq!((first.parameters["wheel.width"], last.parameters["wheel.width"]), (0.10, 0.16));
    // Inputs have no name of their own: they are set, not measured.
    assert!(last.data.column("slip").is_some() && last.data.column("torque").is_none());
    let fewer = joint.with_runs(&[0, 11]);
    assert_eq!(fewer.runs_of_parts(), [0..1, 1..2]);
    assert_eq!(fewer.parts[1].experiment.runs[0].name, "load50_c");
}

#[test]
fn property_folders_of_one_name_are_told_apart_and_a_set_is_not_nested() {
    let same = [wheel("one", "wheel", 0.10, 0.0, ""), wheel("two", "wheel", 0.16, 0.0, "")];
    let joint = Experiment::joint(same.to_vec()).unwrap();
    assert_eq!(joint.name, "wheel + wheel_2");
    assert_eq!(Experiment::joint(same[..1].to_vec()).unwrap_err(), JointError::TooFew(1));
    let nested = Experiment::joint(vec![joint, same[0].clone()]).unwrap_err();
    assert_eq!(nested, JointError::Nested("wheel + wheel_2".to_owned()));
}

#[test]
fn agreement_an_effect_of_one_experiment_is_named_with_its_place() {
    let experiment = pair("one_place", HIDDEN);
    let diagnosis = diagnosed(&experiment);
    assert_eq!(diagnosis.verdict, Verdict::EffectMissing);
    assert_eq!(diagnosis.effects, ["slip_sinkage in wide"]);
    let json = diagnosis.to_json();
    assert_eq!(json["effects"], serde_json::json!(["slip_sinkage"]));
    assert_eq!(json["where"], serde_json::json!({ "slip_sinkage": ["wide"] }));
    let strength = diagnosis.last().parameters.iter().find(|parameter| parameter.effect).unwrap();
    assert_eq!(strength.fitted.variable.name, "slip_sinkage in wide.n1");
    let error = strength.fitted.deviation.unwrap();
    assert!((strength.fitted.value - HIDDEN).abs() < WITHIN * error, "{} +- {error}", strength.fitted.value);
    // Each improved model gives its own experiment the errors of the joint fit.
    let [(narrow, without), (wide, with)] = diagnosis.improved_parts.as_slice() else { panic!("two models") };
    assert_eq!((narrow.as_str(), wide.as_str()), ("narrow", "wide"));
    assert_eq!(without.clone().get("slip_sinkage.n1").unwrap(), 0.0);
    assert_eq!(with.clone().get("slip_sinkage.n1").unwrap(), strength.fitted.value);
    for (part, model) in experiment.parts.iter().zip([without, with]) {
        let own = compare(model, &part.experiment, &CompareOptions::default()).unwrap();
        for (signal, error) in &own.fit().rmse {
            assert_eq!(diagnosis.last().rmse[&part.signal(signal)], *error, "{signal} of {}", part.name);
        }
    }
}

#[test]
fn agreement_an_effect_of_all_experiments_is_named_once() {
    let soft = [wheel("all", "narrow", 0.10, HIDDEN, ""), wheel("all", "wide", 0.16, HIDDEN, "")];
    let diagnosis = diagnosed(&Experiment::joint(soft.to_vec()).unwrap());
    assert_eq!(diagnosis.effects, ["slip_sinkage"]);
    assert_eq!(diagnosis.to_json()["where"], serde_json::json!({ "slip_sinkage": ["narrow", "wide"] }));
}

#[test]
fn agreement_nothing_is_missing_where_nothing_was_hidden() {
    let diagnosis = diagnosed(&pair("clean", 0.0));
    assert_eq!(diagnosis.verdict, Verdict::Explained);
    // Two widths tell k_c from k_phi, which neither wheel does by itself.
    let names: Vec<&str> =
        diagnosis.baseline().parameters.iter().map(|own| own.fitted.variable.name.as_str()).collect();
    assert!(
        names.contains(&"soil.k_c") && names.iter().filter(|name| **name == "soil.k_phi").count() == 1,
        "{names:?}"
    );
}

#[test]
fn property_any_number_of_threads_gives_the_same_bits() {
    let experiment = pair("threads", HIDDEN);
    let with = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| diagnosed(&experiment).to_json().to_string())
    };
    assert_eq!(with(1), with(3));
}

#[test]
fn property_what_one_experiment_states_of_the_soil_holds_in_all() {
    let stated = wheel("stated", "narrow", 0.10, 0.0, "\"soil.cohesion\" = 900.0\n");
    let other = wheel("stated", "wide", 0.16, 0.0, "");
    let joint = Experiment::joint(vec![stated.clone(), other]).unwrap();
    let diagnosis = diagnosed(&joint);
    assert!(!diagnosis.baseline().parameters.iter().any(|own| own.fitted.variable.name == "soil.cohesion"));
    let line = "soil.cohesion: 900, which narrow states, holds in wide too";
    assert!(diagnosis.sources.iter().any(|source| source == line), "{:?}", diagnosis.sources);
    for (_, model) in &diagnosis.improved_parts {
        assert_eq!(model.clone().get("soil.cohesion").unwrap(), 900.0);
    }
    let against = wheel("stated", "third", 0.12, 0.0, "\"soil.cohesion\" = 800.0\n");
    let joint = Experiment::joint(vec![stated, against]).unwrap();
    let refused = diagnose(Given::default(), &joint, &DiagnoseOptions::default(), &Control::default()).unwrap_err();
    let CompareError::Vehicle(words) = refused else { panic!("{refused}") };
    assert!(words.contains("soil.cohesion is 900 in narrow and 800 in third"), "{words}");
}

#[test]
fn analytic_two_different_priors_of_one_soil_count_together() {
    // 1000 +- 100 and 1300 +- 200: weights 4 to 1.
    let prior = |mean: f64, sd: f64| format!("[priors]\n\"soil.cohesion\" = {{ mean = {mean}, sd = {sd} }}\n");
    let one = wheel("priors", "narrow", 0.10, 0.0, &prior(1000.0, 100.0));
    let two = wheel("priors", "wide", 0.16, 0.0, &prior(1300.0, 200.0));
    let of = |parts: &[&Experiment]| {
        let joint = Experiment::joint(parts.iter().map(|part| (*part).clone()).collect()).unwrap();
        let found = diagnosed(&joint);
        let cohesion = found.baseline().parameters.iter().find(|own| own.fitted.variable.name == "soil.cohesion");
        cohesion.unwrap().fitted.prior.unwrap()
    };
    let both = of(&[&one, &two]);
    let rounding = 1e-9;
    assert!(
        (both.mean - 1060.0).abs() < rounding && (both.deviation - (8000.0_f64).sqrt()).abs() < rounding,
        "{both:?}"
    );
    // One test that both folders state is one test.
    let again = wheel("priors_again", "wide", 0.16, 0.0, &prior(1000.0, 100.0));
    assert_eq!(of(&[&one, &again]).deviation, 100.0);
}

#[test]
fn property_beds_that_differ_as_beds_do_are_no_missing_effect() {
    // The second bed is 8 % stiffer: 1.6 of the assumed standard deviations.
    let stiffer = 1.08;
    let narrow = wheel("beds", "narrow", 0.10, 0.0, "");
    let wide = wheel_on("beds", "wide", 0.16, 0.0, "", stiffer);
    let joint = Experiment::joint(vec![narrow, wide]).unwrap();
    let diagnosis = diagnosed(&joint);
    assert_eq!(diagnosis.verdict, Verdict::Explained, "{:?}", diagnosis.effects);
    let factor = |part: &str| {
        let name = format!("soil_scatter in {part}.stiffness");
        diagnosis.baseline().parameters.iter().find(|own| own.fitted.variable.name == name).unwrap().fitted.clone()
    };
    // The widths tell k_c from k_phi only weakly, so that a part of the difference stays in k_c.
    assert!(factor("wide").value >= factor("narrow").value);
    assert!(diagnosis.sources.iter().any(|line| line.contains("differ by 5 % from one experiment to the next")));
    // In one bed there are no factors.
    let given = Given::default().with_soil_scatter(0.0).unwrap();
    let options = CompareOptions { calibrate: true, ..CompareOptions::default() };
    let same = compare(given, &joint, &options).unwrap();
    let names = same.calibrated.unwrap().0.parameters.into_iter().map(|own| own.variable.name);
    assert!(!names.into_iter().any(|name| name.starts_with("soil_scatter")));
    let refused = Given::default().with_soil_scatter(0.8).unwrap_err().to_string();
    assert!(refused.contains("0 to 0.5"), "{refused}");
}

#[test]
fn property_two_soils_that_are_taken_for_one_are_no_effect() {
    // The stresses of the second soil are largest further ahead, as an exit angle moves them.
    let soil = [("soil.c1", 1.0, 0.08), ("soil.exponent", 1.05, 0.0), ("soil.friction_angle", 0.97, 0.0)];
    let narrow = wheel("two_soils", "narrow", 0.10, 0.0, "");
    let wide = wheel_with("two_soils", "wide", 0.16, "", &soil);
    let joint = Experiment::joint(vec![narrow, wide]).unwrap();
    let candidates = Some(["exit_angle", "slip_sinkage", "torque_scale"].map(str::to_owned).to_vec());
    let options = DiagnoseOptions { candidates, draws: 199, ..DiagnoseOptions::default() };
    let diagnosis = diagnose(Given::default(), &joint, &options, &Control::default()).unwrap();
    let cautions = &diagnosis.cautions;
    assert_eq!(diagnosis.verdict, Verdict::Undetermined, "{:?} {cautions:?}", diagnosis.effects);
    let told = |caution: &String| caution.contains("may not stand on one soil") && caution.contains("narrow or wide");
    assert!(cautions.iter().any(told), "{cautions:?}");
    // Each on a soil of its own is what the model gives.
    let apart = Given::default().with_share(&[]);
    let diagnosis = diagnose(apart, &joint, &options, &Control::default()).unwrap();
    assert_eq!(diagnosis.verdict, Verdict::Explained, "{:?}", diagnosis.effects);
}

/// Names of the baseline's parameters.
fn free(given: Given, experiment: &Experiment) -> Vec<(String, Option<Prior>)> {
    let options = CompareOptions { calibrate: true, ..CompareOptions::default() };
    let (calibration, _) = compare(given, experiment, &options).unwrap().calibrated.unwrap();
    calibration.parameters.into_iter().map(|own| (own.variable.name, own.prior)).collect()
}

#[test]
fn property_what_is_set_by_hand_goes_before_what_folders_state() {
    let one = wheel("set", "narrow", 0.10, 0.0, "\"soil.cohesion\" = 900.0\n");
    let two = wheel("set", "wide", 0.16, 0.0, "\"soil.cohesion\" = 800.0\n");
    let joint = Experiment::joint(vec![one, two]).unwrap();
    let given = Given::default().with_value("soil.cohesion", 1000.0);
    let compared = compare(given, &joint, &CompareOptions::default()).unwrap();
    for (name, model) in &compared.part_models {
        assert_eq!(model.clone().get("soil.cohesion").unwrap(), 1000.0, "{name}");
    }
}

#[test]
fn property_a_stated_value_with_a_prior_stays_free_in_all() {
    let mean = "\"soil.cohesion\" = 900.0\n[priors]\n\"soil.cohesion\" = { sd = 150.0 }\n";
    let one = wheel("mean", "narrow", 0.10, 0.0, mean);
    let two = wheel("mean", "wide", 0.16, 0.0, "");
    let joint = Experiment::joint(vec![one, two]).unwrap();
    let names = free(Given::default(), &joint);
    let (_, prior) = names.iter().find(|(name, _)| name == "soil.cohesion").unwrap();
    assert_eq!(prior.unwrap(), Prior { mean: 900.0, deviation: 150.0 });
}

#[test]
fn property_a_class_that_one_folder_names_is_that_of_the_soil() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples");
    let read = |name: &str| Experiment::read(folder.join(name)).unwrap();
    let (mut plates, shear) = (read("sand_plates"), read("sand_shear"));
    plates.soil_class = Some("dry sand".to_owned());
    let joint = Experiment::joint(vec![plates, shear]).unwrap();
    let names = free(Given::default(), &joint);
    // Only the shear tests tell of the cohesion.
    let (_, prior) = names.iter().find(|(name, _)| name == "soil.cohesion").unwrap();
    assert!(prior.is_some(), "{names:?}");
}

#[test]
fn property_a_known_soil_is_a_prior_of_what_any_experiment_tells() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples");
    let read = |name: &str| Experiment::read(folder.join(name)).unwrap();
    let (plates, shear) = (read("sand_plates"), read("sand_shear"));
    let joint = Experiment::joint(vec![plates, shear]).unwrap();
    // With what was hidden in them, so that noise alone is left.
    let added = ["seating", "shear_softening"].map(str::to_owned).to_vec();
    let options = CompareOptions { calibrate: true, added, ..CompareOptions::default() };
    let soil = compare(Given::default(), &joint, &options).unwrap().soil.unwrap();
    assert_eq!(soil.parameters.len(), 6);
    let again = compare(Given::default().with_soil(soil, "soil.toml"), &joint, &options).unwrap();
    let lines: Vec<&String> = again.sources.iter().filter(|line| line.contains("priors of soil.toml")).collect();
    let [line] = lines.as_slice() else { panic!("said once: {:?}", again.sources) };
    for name in
        ["soil.k_c", "soil.k_phi", "soil.exponent", "soil.cohesion", "soil.friction_angle", "soil.shear_modulus"]
    {
        assert!(line.contains(name), "{name}: {line}");
    }
    // The same measurements under what they told before: all errors shrink by about the square root of two.
    let error = |comparison: &Comparison, name: &str| {
        let parameters = &comparison.calibrated.as_ref().unwrap().0.parameters;
        parameters.iter().find(|own| own.variable.name == name).unwrap().deviation.unwrap()
    };
    let alone = compare(Given::default(), &joint, &options).unwrap();
    for name in ["soil.friction_angle", "soil.shear_modulus"] {
        let ratio = error(&again, name) / error(&alone, name);
        // Between no prior at all and one that is twice as good.
        assert!((0.55..0.85).contains(&ratio), "{name}: {ratio}");
    }
}

#[test]
fn property_one_name_for_two_effects_is_refused() {
    let text = |gain: f64| {
        format!(
            "[[effect]]\nid = \"mine\"\nabout = \"weaker soil\"\ntarget = \"soil.cohesion\"\nmode = \"factor\"\nexpression = \"1 - {gain} * loss\"\n[effect.parameters.loss]\nneutral = 0.0\nmin = 0.0\nmax = 0.4\nabout = \"share\"\n"
        )
    };
    let with = |name: &str, width: f64, gain: f64| {
        let mut own = wheel("effects", name, width, 0.0, "");
        own.effects = bekker::effects::EffectDefinition::all_from_toml(&text(gain)).unwrap();
        own
    };
    let joint = Experiment::joint(vec![with("narrow", 0.10, 1.0), with("wide", 0.16, 2.0)]).unwrap();
    let refused = compare(Given::default(), &joint, &CompareOptions::default()).unwrap_err().to_string();
    assert!(refused.contains("`mine` is defined differently in narrow and wide"), "{refused}");
}

#[test]
fn property_an_effect_has_a_plain_name() {
    assert_eq!(plain_effect("slip_sinkage in wide"), "slip_sinkage");
}
