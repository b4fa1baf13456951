//! `pose` and `plan`.

use crate::program::{done, file, json, refused, shown};

#[test]
fn property_a_pose_is_told_and_written() {
    let path = file("pose.json");
    let out = done(&["pose", "benign:3", "--at", "1,1", "--json", shown(&path)]);
    for part in ["reference point", "left bogie", "stability angle", "largest thrust", "safe"] {
        assert!(out.contains(part), "no `{part}` in: {out}");
    }
    let pose = json(&path);
    assert_eq!(pose["wheels"].as_array().map(Vec::len), Some(6));
    assert!(pose["roll"].as_f64().is_some_and(|roll| roll.abs() < 1.2) && pose["safe"].is_boolean());
}

#[test]
fn property_a_plan_is_told_and_written_as_table_and_page() {
    let (table, page) = (file("path.csv"), file("path.html"));
    let out = done(&[
        "plan",
        "benign:3",
        "--start",
        "1,1",
        "--goal",
        "2,1.6",
        "--csv",
        shown(&table),
        "--html",
        shown(&page),
    ]);
    assert!(out.contains("path of") && out.contains("places evaluated"), "{out}");
    let table = std::fs::read_to_string(&table).expect("the table is there");
    assert!(table.starts_with("travelled,x,y,z,heading") && table.lines().count() > 10);
    assert!(std::fs::read_to_string(&page).expect("the page is there").contains("on which every stand holds"));
    assert!(out.contains("other path, "), "{out}");
    let numbers = done(&["plan", "benign", "--list"]);
    assert!(numbers.contains("limits.stability") && numbers.contains("range_error.random"), "{numbers}");
}

#[test]
fn property_a_plan_by_energy_is_told_in_joules_and_needs_soil() {
    let (plan, page) = (file("energy.json"), file("energy.html"));
    let by_energy = ["plan", "benign:3", "--start", "1,1", "--goal", "0.89,2.09", "--by-energy"];
    let out =
        done(&[&by_energy[..], &["--soil", "fsrl_ditch", "--json", shown(&plan), "--html", shown(&page)]].concat());
    assert!(out.contains("path of") && out.contains(", energy ") && out.contains(" J\n"), "{out}");
    let points = json(&plan)["points"].as_array().map_or(0, Vec::len);
    assert!(points > 10, "{points}");
    let page = std::fs::read_to_string(&page).expect("the page is there");
    assert!(page.contains("on which every stand holds") && page.contains("\"energy "));
    refused(&by_energy, &["by energy", "soil"]);
}

#[test]
fn property_the_slip_along_a_plan_on_soil_has_a_band_of_what_is_known_of_the_soil() {
    let plan = ["plan", "benign:3", "--start", "1,1", "--goal", "0.89,2.09", "--soil", "fsrl_ditch"];
    let (found, assumed) = (file("slip.json"), file("slip.csv"));
    let out = done(&[&plan[..], &["--alternatives", "--json", shown(&found), "--csv", shown(&assumed)]].concat());
    assert!(out.contains("largest slip") && out.contains("nearest to it"), "{out}");
    let answer = json(&found);
    assert!(answer["energy"].as_f64().is_some_and(|energy| energy > 0.0));
    let looked = ["alternatives", "alternatives_missing"].map(|key| answer[key].as_array().map_or(0, Vec::len));
    assert!(looked[0] + looked[1] == 5, "{looked:?}");
    let width = |answer: &serde_json::Value| {
        let ends = ["slip_low", "slip", "slip_high"].map(|key| answer["points"][0][key].as_f64());
        let [low, slip, high] = ends.map(|end| end.expect("a number"));
        assert!(low < slip && slip < high, "{ends:?}");
        high - low
    };
    let table = std::fs::read_to_string(&assumed).expect("the table is there");
    assert!(table.starts_with("travelled,") && table.lines().next().is_some_and(|line| line.ends_with(",slip_none")));
    let soil = file("soil.toml");
    let parameter = "name = \"soil.friction_angle\"\nvalue = 0.5\nunit = \"rad\"\nscale = \"linear\"\nsd = 0.01\nat_bound = false\n";
    let text = format!("name = \"shear box\"\n[[parameter]]\n{parameter}covariance = [1e-4]\n");
    std::fs::write(&soil, text).expect("the folder can be written");
    let known = file("known.json");
    let out = done(&[&plan[..], &["--soil-from", shown(&soil), "--json", shown(&known)]].concat());
    assert!(out.contains("shear box"), "{out}");
    assert!(width(&json(&known)) < 0.2 * width(&answer));
    refused(&[&plan[..], &["--soil-class", "custard"]].concat(), &["custard", "dry sand"]);
}

#[test]
fn property_what_cannot_be_planned_is_told_in_one_line() {
    let plan = |map, start, goal| ["plan", map, "--start", start, "--goal", goal];
    refused(&plan("benign:3", "1,1", "60,6"), &["the goal (60, 6) is off the map"]);
    refused(&plan("no_such.asc", "1,1", "2,2"), &["no_such.asc"]);
    refused(&plan("hills.xyz", "1,1", "2,2"), &["hills.xyz", ".tif"]);
    refused(&plan("benign:three", "1,1", "2,2"), &["benign:three", "seed"]);
    refused(&["pose", "benign", "--at", "4,4", "--robot", "tank"], &["unknown robot `tank`", "fsrl"]);
    refused(&["pose", "benign", "--at", "4,4", "--set", "limits.stabilty=1"], &["limits.stabilty"]);
    refused(
        &["pose", "benign", "--at", "4,4", "--robot", "sample_return", "--active", "1"],
        &["1 values", "5 active joints"],
    );
}
