//! The model as curves beside the points of a wheel on a carriage, and what the pages draw of it.

#![cfg(feature = "report")]

use crate::saved_page::{data, figures, numbers};
use bekker::diagnosis::{Axis, CompareOptions, Comparison, CurveGroup, Curves, Rig, compare, steady_point};
use bekker::measurement::Experiment;
use bekker::model::Model;
use bekker::modeldescription::Lookup;
use bekker::report::comparison_page;
use std::path::Path;

/// Inputs that went through a division and back.
const ROUNDING: f64 = 1e-12;

/// The carriage's speed over the wheel's radius, rad/s, and loads (N) that were meant to be one.
const CARRIAGE: f64 = 0.17;
const LOADS: [f64; 15] = [24.0, 25.3, 24.5, 24.3, 25.1, 24.5, 26.1, 25.2, 24.6, 24.8, 25.6, 21.6, 26.0, 25.9, 25.0];

fn compared(name: &str, rows: &[[f64; 3]], settings: &str, options: &CompareOptions, model: &Model) -> Comparison {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("diagnosis_curves").join(name);
    std::fs::create_dir_all(&folder).unwrap();
    let rig = Rig::of(&Model::preset("two_wheeled").unwrap().rover);
    let mut csv = "load,slip,wheel_speed,drawbar_pull,sinkage\n".to_owned();
    for [load, slip, speed] in rows {
        let point = steady_point(&rig, *load, *slip, *speed).unwrap();
        csv += &format!("{load},{slip},{speed},{},{}\n", point.drawbar_pull, point.sinkage);
    }
    std::fs::write(folder.join("rows.csv"), csv).unwrap();
    let toml = format!("name = \"{name}\"\nkind = \"single_wheel\"\n{settings}\n[[run]]\nfile = \"rows.csv\"\n");
    std::fs::write(folder.join("experiment.toml"), toml).unwrap();
    compare(model, &Experiment::read(&folder).unwrap(), options).unwrap()
}

/// Rows as the carriage of a public data set gives them: its speed is held, the load scatters, the slip is set.
fn carriage_rows() -> Vec<[f64; 3]> {
    let slips = [0.0, 0.231, 0.5, 0.75, 0.9];
    let row = |(k, load): (usize, &f64)| {
        let slip = slips[k / 3] + 0.0004 * (k % 3) as f64;
        [*load, slip, CARRIAGE / (1.0 - slip)]
    };
    LOADS.iter().enumerate().map(row).collect()
}

/// `name` is that of the folder: tests run side by side.
fn carriage(name: &str, settings: &str) -> Comparison {
    let model = Model::preset("two_wheeled").unwrap();
    compared(name, &carriage_rows(), settings, &CompareOptions::default(), &model)
}

fn over(curves: &[Curves], axis: Axis) -> &[CurveGroup] {
    &curves.iter().find(|curves| curves.axis == axis).unwrap().groups
}

#[test]
fn agreement_unequal_inputs_still_give_one_curve_at_their_typical_values() {
    let comparison = carriage("curve", "");
    assert_eq!(comparison.curves.iter().map(|curves| curves.axis).collect::<Vec<_>>(), [Axis::Slip]);
    let [group] = over(&comparison.curves, Axis::Slip) else { panic!("one group") };
    assert_eq!((group.rows.len(), group.name.as_str()), (15, ""));
    let mean = LOADS.iter().sum::<f64>() / 15.0;
    let rig = Rig::of(&Model::preset("two_wheeled").unwrap().rover);
    let curve = &group.models[0].signals["drawbar_pull"];
    assert!(group.at.len() > 50 && group.at[0] == 0.0 && *group.at.last().unwrap() == 0.9008);
    for (k, (slip, [load, own_slip, speed])) in group.at.iter().zip(&group.inputs).enumerate() {
        assert!((load - mean).abs() < 30.0 * ROUNDING && own_slip == slip);
        // The carriage's speed is held, so the wheel's follows from the slip.
        assert!((speed - CARRIAGE / (1.0 - slip)).abs() < 2.0 * ROUNDING, "{speed} at {slip}");
        let point = steady_point(&rig, *load, *slip, *speed).unwrap();
        assert_eq!(curve.value[k], point.drawbar_pull);
        assert!(curve.low[k] <= curve.value[k] && curve.value[k] <= curve.high[k]);
    }
    // Somewhere the pull does not depend on the load, elsewhere it does.
    assert!(curve.low.iter().zip(&curve.high).filter(|(low, high)| high > low).count() > 50);
}

#[test]
fn property_the_band_holds_the_model_at_the_inputs_of_every_row() {
    let comparison = carriage("band", "");
    let group = &over(&comparison.curves, Axis::Slip)[0];
    let step = group.at[1] - group.at[0];
    for (signal, curve) in &group.models[0].signals {
        let fit = comparison.fit().runs[0].signal(signal).unwrap();
        for (row, [_, slip, _]) in carriage_rows().into_iter().enumerate() {
            // The places of the grid about the row.
            let at = ((slip / step) as usize).min(group.at.len() - 2);
            let low = curve.low[at].min(curve.low[at + 1]);
            let high = curve.high[at].max(curve.high[at + 1]);
            // Rows at the ends of the band touch it.
            let slack = 1e-9 * (high - low);
            let value = fit.modelled[row];
            assert!((low - slack..=high + slack).contains(&value), "{signal} {slip}: {low} {value} {high}");
        }
    }
}

#[test]
fn property_set_points_of_load_and_speed_are_groups_over_every_axis() {
    let mut rows = Vec::new();
    for load in [20.0, 20.1, 40.0] {
        for speed in [0.2, 0.8] {
            rows.extend([0.1, 0.2, 0.4].map(|slip| [load, slip, speed]));
        }
    }
    let model = Model::preset("two_wheeled").unwrap();
    let comparison = compared("set_points", &rows, "", &CompareOptions::default(), &model);
    let names = |axis| over(&comparison.curves, axis).iter().map(|group| group.name.clone()).collect::<Vec<_>>();
    let expected = ["20 to 20.1 N, 0.2 rad/s", "20 to 20.1 N, 0.8 rad/s", "40 N, 0.2 rad/s", "40 N, 0.8 rad/s"];
    assert_eq!(names(Axis::Slip), expected);
    assert_eq!(names(Axis::Load)[..2], ["slip 0.1, 0.2 rad/s", "slip 0.1, 0.8 rad/s"]);
    assert_eq!(names(Axis::WheelSpeed)[..2], ["20 to 20.1 N, slip 0.1", "20 to 20.1 N, slip 0.2"]);
    // Every row is in one group of each axis.
    for curves in &comparison.curves {
        let mut all: Vec<_> = curves.groups.iter().flat_map(|group| group.rows.clone()).collect();
        all.sort_unstable();
        assert_eq!(all, (0..rows.len()).map(|row| (0, row)).collect::<Vec<_>>());
    }
}

#[test]
fn property_places_without_an_answer_are_left_out_of_the_curve() {
    let rows: Vec<[f64; 3]> =
        (0..12).map(|k| [10.0 + 30.0 * f64::from(k / 2), 0.1 + 0.2 * f64::from(k % 2), 0.5]).collect();
    // As given the soil is so soft that the wheel sinks to its axle under the larger loads.
    let mut soft = Model::preset("two_wheeled").unwrap();
    soft.set("soil.k_phi", 2e4).unwrap();
    let comparison =
        compared("soft", &rows, "", &CompareOptions { calibrate: true, ..CompareOptions::default() }, &soft);
    assert!(!comparison.given_unanswered.is_empty());
    for group in over(&comparison.curves, Axis::Load) {
        let given = &group.models[0].signals["sinkage"];
        let answered = given.value.iter().filter(|value| !value.is_nan()).count();
        assert!((1..given.value.len()).contains(&answered), "{answered} of {}", given.value.len());
        for (value, (low, high)) in given.value.iter().zip(given.low.iter().zip(&given.high)) {
            assert_eq!((value.is_nan(), value.is_nan()), (low.is_nan(), high.is_nan()));
        }
        let calibrated = &group.models[1];
        assert_eq!(calibrated.step, Some(0));
        assert!(calibrated.signals["sinkage"].value.iter().all(|value| value.is_finite()));
    }
}

#[test]
fn agreement_the_page_draws_the_curves_and_the_noise_in_force() {
    let comparison = carriage("noise", "[noise]\ndrawbar_pull = 0.3");
    let page = comparison_page(&comparison);
    let saved = data(&page);
    let drawn = &saved["models"][0]["curves"]["slip"]["groups"][0]["signals"]["drawbar_pull"];
    let curve = &over(&comparison.curves, Axis::Slip)[0].models[0].signals["drawbar_pull"];
    let largest = curve.high.iter().fold(0.0_f64, |most, value| most.max(value.abs()));
    let ends = [(&curve.value, &drawn["value"]), (&curve.low, &drawn["band"][0]), (&curve.high, &drawn["band"][1])];
    for (values, drawn) in ends {
        for (value, drawn) in values.iter().zip(numbers(drawn)) {
            // Words of two bytes.
            assert!((drawn - value).abs() <= 1e-4 * largest, "{drawn} {value}");
        }
    }
    // The page draws twice the noise in force; without noise no bars.
    assert_eq!(saved["experiment"]["noise"]["drawbar_pull"]["value"], 0.3);
    assert!(page.contains("two standard deviations of the noise of one sample (drawbar pull 0.600 N)"));
    let silent = comparison_page(&carriage("silent", ""));
    assert!(data(&silent)["experiment"]["noise"]["drawbar_pull"]["value"].is_null());
    assert!(silent.contains("there are no error bars"));
    // Accidental loads have a smooth instead of a line from level to level, set-points of slip have means.
    let of = |mark: &str| {
        let own = figures(&page).into_iter().filter(|figure| figure["y"]["label"] == "drawbar pull residual (N)");
        own.filter(|figure| figure["traces"].as_array().unwrap().iter().any(|trace| trace["mark"] == mark)).count()
    };
    assert_eq!((of("means"), of("line")), (2, 1), "means over slip and wheel speed");
}
