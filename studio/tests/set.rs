//! Several experiments on one soil: the page is told the numbers of the library, of all of them and of the one that is shown.

#![allow(clippy::unwrap_used, reason = "a test may fail by panicking")]

mod support;

use bekker::diagnosis::{CompareOptions, Comparison, Given, compare};
use bekker::measurement::{Experiment, Share};
use bekker::model::Model;
use serde_json::{Value, json};
use support::{Running, started_with, started_with_all};

const SET: &str = "/api/experiments/sand-plates-sand-shear";

fn read(name: &str) -> Experiment {
    Experiment::read(format!(concat!(env!("CARGO_MANIFEST_DIR"), "/../examples/{}"), name)).expect("shipped")
}

fn set() -> Experiment {
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

#[test]
fn agreement_a_set_that_is_put_together_on_the_page_is_that_of_the_folders() {
    let (plates, wheel) = (read("sand_plates"), read("sand_wheel"));
    let apart = vec![(plates.clone(), Given::default()), (wheel.clone(), Given::default())];
    let running = started_with_all("127.0.0.1:0", apart);
    let listed = running.get("/api/experiments").json();
    let ids: Vec<&Value> = listed["experiments"].as_array().unwrap().iter().map(|one| &one["id"]).collect();
    let made = running.post("/api/sets", &json!({ "experiments": ids, "soil_scatter": 0.1, "share": ["soil"] })).json();
    assert_eq!((&made["parts"], &made["example"]), (&json!(2), &json!(false)));
    let path = format!("/api/experiments/{}", made["id"].as_str().unwrap());
    let given = Given::default().with_share(&[Share::Soil]).with_soil_scatter(0.1).unwrap();
    let together = Experiment::joint(vec![plates, wheel]).unwrap();
    let comparison = compare(given, &together, &CompareOptions::default()).unwrap();
    assert_eq!(running.post(&format!("{path}/trial"), &json!({})).json()["rmse"], json!(comparison.fit().rmse));
    let shown = running.get(&path).json();
    let parameters = shown["parameters"].as_array().unwrap();
    let scatter = parameters.iter().find(|own| own["name"] == "soil_scatter in sand_plates.stiffness");
    assert_eq!(scatter.unwrap()["prior"]["sd"], json!(0.1));
    // The experiments by themselves stay open.
    assert_eq!(running.get("/api/experiments").json()["experiments"].as_array().unwrap().len(), 3);
}

#[test]
fn property_what_is_no_set_is_refused_by_name() {
    let with_model = Given::default().with_model(Model::preset("two_wheeled").unwrap(), "two_wheeled");
    let other = Given::default().with_model(Model::preset("rocker_bogie").unwrap(), "rocker_bogie");
    let open = vec![
        (read("sand_plates"), Given::default()),
        (read("sand_shear"), with_model),
        (read("sand_wheel"), other),
        (set(), Given::default()),
    ];
    let running = started_with_all("127.0.0.1:0", open);
    let [plates, shear, wheel, pair] =
        ["plates-on-dense-sand", "shear-tests-of-dense-sand", "a-wheel-on-dry-sand", "sand-plates-sand-shear"];
    let refused = |body: Value, status: u16, words: &str| {
        let answer = running.post("/api/sets", &body);
        assert!(
            answer.status == status && answer.error().contains(words),
            "{body}: {} {}",
            answer.status,
            answer.error()
        );
    };
    refused(json!({ "experiments": [plates] }), 422, "at least two");
    refused(json!({ "experiments": [plates, plates] }), 422, "named twice");
    refused(json!({ "experiments": [plates, "nothing"] }), 404, "no open experiment `nothing`");
    refused(json!({ "experiments": [plates, pair] }), 422, "several experiments already");
    refused(json!({ "experiments": [shear, wheel] }), 422, "different models");
    refused(json!({ "experiments": [plates, shear], "soil_scatter": 0.9 }), 422, "from 0 to 0.5");
    refused(json!({ "experiments": [plates, shear], "share": ["weather"] }), 422, "weather");
    assert_eq!(
        running.post("/api/sets", &json!({ "experiments": [plates, shear] })).status,
        200,
        "one model is enough"
    );
}
