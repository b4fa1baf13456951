//! What the page is told are the numbers of the library; work in the background tells of itself and ends when it is asked to.

#![allow(clippy::unwrap_used, reason = "a test may fail by panicking")]

mod support;

use bekker::diagnosis::{CompareOptions, Given, compare};
use bekker::model::Model;
use serde_json::{Value, json};
use support::{EXAMPLE, Running, sand, started};

const LOCAL: &str = "127.0.0.1:0";

fn trial(running: &Running, values: &Value) -> support::Answer {
    running.post(&format!("{EXAMPLE}/trial"), &json!({ "values": values, "axis": "slip" }))
}

/// Calibrates and waits for the step.
fn calibrated(running: &Running) -> Value {
    assert_eq!(running.post(&format!("{EXAMPLE}/jobs"), &json!({ "kind": "calibrate" })).status, 200);
    let second = |event: &Value| event["steps"].get(1).is_some();
    let found = running.event(|name, data| (name == "step" && data["at"] == 1) || (name == "snapshot" && second(data)));
    if found["steps"].is_array() { found["steps"][1].clone() } else { found["step"].clone() }
}

#[test]
fn agreement_a_trial_has_the_errors_of_a_comparison() {
    let running = started(LOCAL);
    let comparison = compare(Given::default(), &sand(), &CompareOptions::default()).unwrap();
    let shown = trial(&running, &json!({})).json();
    assert_eq!(shown["rmse"], json!(comparison.fit().rmse));
    assert_eq!(shown["runs"].as_array().unwrap().len(), comparison.experiment.runs.len());
    assert_eq!(shown["curves"]["slip"]["groups"].as_array().unwrap().len(), 6);
    let listed = running.get(EXAMPLE).json();
    assert_eq!(listed["signals"], json!(["drawbar_pull", "torque", "sinkage"]));
    assert!(listed["parameters"].as_array().unwrap().iter().any(|parameter| parameter["effect"] == "slip_sinkage"));
}

#[test]
fn property_a_whole_diagnosis_by_hand() {
    let running = started(LOCAL);
    let step = calibrated(&running);
    // Fit the missing effect, accept it, and save.
    let order = json!({ "kind": "fit", "effects": ["slip_sinkage"], "values": step["values"] });
    assert_eq!(running.post(&format!("{EXAMPLE}/jobs"), &order).status, 200);
    let with_it = |found: &Value| found["effects"] == json!(["slip_sinkage"]);
    let in_snapshot =
        |data: &Value| data["found"].as_array().and_then(|all| all.iter().find(|found| with_it(found)).cloned());
    let found = running
        .event(|name, data| (name == "fit" && with_it(data)) || (name == "snapshot" && in_snapshot(data).is_some()));
    let found = in_snapshot(&found).unwrap_or(found);
    let accepted = running.post(
        &format!("{EXAMPLE}/steps"),
        &json!({ "label": "+ slip sinkage", "parent": 1, "effects": ["slip_sinkage"], "values": found["values"] }),
    );
    assert_eq!(accepted.json()["at"], 2);
    // Another tab, or one that comes back, is told all of it.
    let snapshot = running.event(|name, _| name == "snapshot");
    let (before, after) =
        (&snapshot["steps"][1]["rmse"]["drawbar_pull"], &snapshot["steps"][2]["rmse"]["drawbar_pull"]);
    assert!(after.as_f64().unwrap() < 0.7 * before.as_f64().unwrap(), "{before} {after}");
    let saved = running.post(&format!("{EXAMPLE}/export"), &json!({ "what": "toml", "values": found["values"] }));
    assert!(saved.head.contains("filename=\"a-wheel-on-dry-sand.toml\""), "{}", saved.head);
    let model = Model::from_toml(std::str::from_utf8(&saved.body).unwrap(), None).unwrap();
    let again = compare(&model, &sand(), &CompareOptions::default()).unwrap();
    assert_eq!(json!(again.fit().rmse), snapshot["steps"][2]["rmse"]);
    let report = running.post(&format!("{EXAMPLE}/export"), &json!({ "what": "report", "values": found["values"] }));
    assert!(String::from_utf8_lossy(&report.body).contains("model and measurement"));
    let none = running.post(&format!("{EXAMPLE}/export"), &json!({ "what": "fmu", "values": {} }));
    assert_eq!(none.status, 404, "this program has no packer");
}

#[test]
fn property_a_search_tells_of_fits_as_they_come_and_stops() {
    let running = started(LOCAL);
    calibrated(&running);
    assert_eq!(running.post(&format!("{EXAMPLE}/jobs"), &json!({ "kind": "rank" })).status, 200);
    let single = |data: &Value| data["effects"].as_array().is_some_and(|effects| effects.len() == 1);
    let some = |data: &Value| data["found"].as_array().is_some_and(|all| all.iter().any(single));
    running.event(|name, data| (name == "fit" && single(data)) || (name == "snapshot" && some(data)));
    let stopped = running.ask("DELETE", &format!("{EXAMPLE}/jobs/rank"), "", b"");
    assert_eq!(stopped.json()["stopped"], true);
    running.event(|name, data| {
        (name == "job" && data["kind"] == "rank" && data["running"] == false)
            || (name == "snapshot" && data["jobs"] == json!([]))
    });
}

#[test]
fn property_what_cannot_be_is_refused_in_words() {
    let running = started(LOCAL);
    let refused = |answer: support::Answer, words: &str| {
        assert!((400..500).contains(&answer.status), "{answer:?}");
        assert!(answer.error().contains(words), "{}", answer.error());
    };
    refused(trial(&running, &json!({ "soil.cohesoin": 1.0 })), "did you mean soil.cohesion");
    refused(trial(&running, &json!({ "soil.cohesion": -1.0 })), "outside its allowed range");
    refused(trial(&running, &json!({ "soil.cohesion": "much" })), "the request");
    refused(running.get("/api/experiments/no-such"), "no open experiment `no-such`");
    refused(running.get("/elsewhere"), "there is no such page");
    refused(running.post(&format!("{EXAMPLE}/jobs"), &json!({ "kind": "fit" })), "not calibrated yet");
    refused(running.post(&format!("{EXAMPLE}/jobs"), &json!({ "kind": "dig" })), "unknown variant");
    refused(running.post(&format!("{EXAMPLE}/export"), &json!({ "what": "diagnosis" })), "rank the effects first");
    let step = json!({ "label": "x", "parent": 7, "effects": [], "values": {} });
    refused(running.post(&format!("{EXAMPLE}/steps"), &step), "no such step");
    refused(running.post("/api/uploads/99/proposal", &json!({})), "choose the files again");
}

#[test]
fn property_columns_are_mapped_by_choosing() {
    let running = started(LOCAL);
    let number = running.post("/api/uploads", &json!({})).json()["upload"].as_u64().unwrap();
    let at = |what: &str| format!("/api/uploads/{number}/{what}");
    let csv = "W [N];Schlupf;omega;DP [N];z mm;remark\n20;0,1;0,2;1,0;9;a\n20;0,2;0,2;2,0;10;b\n20;0,3;0,2;2,5;11;c\n";
    assert_eq!(running.ask("PUT", &at("files?path=Lauf%201.csv"), "", csv.as_bytes()).status, 200);
    let proposal = running.post(&at("proposal"), &json!({ "kind": "single_wheel" })).json();
    assert_eq!(proposal["ready"], false);
    let names: Vec<&str> =
        proposal["columns"].as_array().unwrap().iter().map(|c| c["name"].as_str().unwrap()).collect();
    assert_eq!(names, ["W [N]", "Schlupf", "omega", "DP [N]", "z mm", "remark"]);
    let choices = json!({ "columns": {
        "W [N]": { "target": "load", "unit": "N" }, "Schlupf": { "target": "slip" }, "omega": { "target": "wheel_speed" },
        "DP [N]": { "target": "drawbar_pull", "unit": "N" }, "z mm": { "target": "sinkage", "unit": "mm" }, "remark": null,
    }, "filled": { "wheel.radius": 0.1, "wheel.width": 0.1 } });
    let changed = running.post(&at("proposal"), &choices).json();
    assert_eq!(changed["missing"], json!([]), "{changed}");
    let wrong = running.post(&at("proposal"), &json!({ "columns": { "z mm": { "target": "sinkage", "unit": "kg" } } }));
    assert!(wrong.error().contains("z mm"), "{}", wrong.error());
    let wrong = running.post(&at("proposal"), &json!({ "columns": { "z mm": { "target": "sinkege" } } }));
    assert!(wrong.error().contains("did you mean sinkage"), "{}", wrong.error());
    let opened = running.post(&at("open"), &json!({ "settings": changed["settings"] }));
    assert_eq!(opened.status, 200, "{:?}", String::from_utf8_lossy(&opened.body));
    let id = opened.json()["id"].as_str().unwrap().to_owned();
    let shown = running.get(&format!("/api/experiments/{id}")).json();
    let sinkages = shown["runs"][0]["data"]["sinkage"].as_array().unwrap().iter().map(|z| 1e3 * z.as_f64().unwrap());
    assert_eq!(
        sinkages.map(|z| format!("{z:.6}")).collect::<Vec<_>>(),
        ["9.000000", "10.000000", "11.000000"],
        "in mm"
    );
}
