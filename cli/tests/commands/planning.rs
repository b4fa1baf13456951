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
