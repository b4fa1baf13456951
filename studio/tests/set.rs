//! Several experiments on one soil: the page is told the numbers of the library, of all of them and of the one that is shown.

#![allow(clippy::unwrap_used, reason = "a test may fail by panicking")]

mod support;

use bekker::diagnosis::{CompareOptions, Comparison, Given, compare};
use bekker::measurement::Experiment;
use serde_json::{Value, json};
use support::{Running, started_with};

const SET: &str = "/api/experiments/sand-plates-sand-shear";

fn set() -> Experiment {
    let read = |name: &str| {
        Experiment::read(format!(concat!(env!("CARGO_MANIFEST_DIR"), "/../examples/{}"), name)).expect("shipped")
    };
    Experiment::joint(vec![read("sand_plates"), read("sand_shear")]).expect("two experiments")
}

/// Numbers of plots are sent in single precision.
fn in_single(values: &[f64]) -> Value {
    values.iter().map(|value| f64::from(*value as f32)).collect::<Vec<_>>().into()
}

fn opened() -> (Running, Comparison) {
    let comparison = compare(Given::default(), &set(), &CompareOptions::default()).unwrap();
    (started_with("127.0.0.1:0", set()), comparison)
}

#[test]
fn agreement_a_trial_has_the_errors_of_all_and_the_rows_of_the_part_that_is_shown() {
    let (running, comparison) = opened();
    for (k, part) in comparison.experiment.parts.iter().enumerate() {
        let shown = running.post(&format!("{SET}/trial"), &json!({ "part": part.name })).json();
        assert_eq!(shown["rmse"], json!(comparison.fit().rmse));
        let runs = comparison.experiment.runs_of_parts()[k].clone();
        let modelled = comparison.fit().runs[runs].iter().map(|run| {
            let own = run
                .signals
                .iter()
                .map(|signal| (part.own(&signal.signal).unwrap().to_owned(), in_single(&signal.modelled)));
            Value::Object(own.collect())
        });
        assert_eq!(shown["runs"], modelled.collect::<Value>(), "{}", part.name);
    }
    let first = running.post(&format!("{SET}/trial"), &json!({})).json();
    assert_eq!(first["runs"].as_array().unwrap().len(), comparison.experiment.parts[0].experiment.runs.len());
    let missing = running.post(&format!("{SET}/trial"), &json!({ "part": "sand_wheel" }));
    assert_eq!(missing.status, 404);
    assert!(missing.error().contains("no experiment `sand_wheel` among these"), "{}", missing.error());
}

#[test]
fn property_the_parts_stand_under_their_own_names_and_parameters_say_whose_they_are() {
    let (running, _) = opened();
    let shown = running.get(SET).json();
    let part = |k: usize| &shown["parts"][k];
    assert_eq!([&part(0)["part"], &part(1)["part"]], ["sand_plates", "sand_shear"]);
    assert_eq!([&part(0)["kind"], &part(1)["kind"]], ["plate_sinkage", "shear"]);
    for (k, experiment) in set().parts.iter().enumerate() {
        assert_eq!(part(k)["signals"], json!(experiment.experiment.signals()));
        assert_eq!(part(k)["runs"][0]["name"], json!(experiment.experiment.runs[0].name));
    }
    let of = |list: &str, key: &str, name: &str| {
        let all = shown[list].as_array().unwrap();
        all.iter().find(|one| one[key] == name).cloned().unwrap_or_else(|| panic!("no {name}"))
    };
    assert_eq!(of("parameters", "name", "soil.k_phi")["parts"], Value::Null);
    let own = of("effects", "id", "plate_size");
    assert_eq!((&own["plain"], &own["parts"]), (&json!("plate_size"), &json!(["sand_plates"])));
    assert!(!own["about"].as_str().unwrap().is_empty());
}

#[test]
fn agreement_each_part_saves_its_own_model_and_page() {
    let (running, comparison) = opened();
    for (name, model) in &comparison.part_models {
        let saved = running.post(&format!("{SET}/export"), &json!({ "what": "toml", "part": name }));
        assert_eq!(String::from_utf8(saved.body).unwrap(), model.to_toml().unwrap(), "{name}");
        assert!(saved.head.contains(&format!("sand-plates-sand-shear-{name}.toml")), "{}", saved.head);
        let page = running.post(&format!("{SET}/export"), &json!({ "what": "report", "part": name }));
        let page = String::from_utf8_lossy(&page.body).into_owned();
        assert!(
            page.contains("One of sand_plates + sand_shear, fitted together: the model of the workbench."),
            "{name}"
        );
    }
}
