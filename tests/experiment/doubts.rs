//! Values that physics refuses or doubts: wrong units and signs on small generated data of a wheel and a rover.

use bekker::measurement::{Experiment, ExperimentError};
use std::collections::BTreeMap;

const RADIUS: f64 = 0.1;

fn read(toml: &str, csv: &str) -> Result<Experiment, ExperimentError> {
    let texts = [("experiment.toml", toml), ("a.csv", csv)].map(|(name, text)| (name.to_owned(), text.to_owned()));
    Experiment::from_texts(&BTreeMap::from(texts))
}

/// One row of a wheel: load (N), slip, wheel speed (rad/s), pull (N), torque (N m), sinkage (m).
type Row = [f64; 6];

/// A wheel of 50 N whose pull saturates with slip, as sand gives it, changed by `mishap`.
fn wheel(mishap: impl Fn(&mut Row)) -> Result<Experiment, ExperimentError> {
    let mut csv = "load,slip,wheel_speed,drawbar_pull,torque,sinkage\n".to_owned();
    for k in -4..=8 {
        let slip = 0.1 * f64::from(k);
        let pull = 50.0 * (0.4 * (5.0 * slip).tanh() - 0.12);
        let torque = 50.0 * RADIUS * (0.5 * (5.0 * slip).tanh() + 0.05);
        let mut row = [50.0, slip, 0.3, pull, torque, 0.012 + 0.01 * slip.max(0.0)];
        mishap(&mut row);
        csv += &(row.map(|value| format!("{value}")).join(",") + "\n");
    }
    let toml = format!(
        "name = \"t\"\nkind = \"single_wheel\"\n[parameters]\n\"wheel.radius\" = {RADIUS}\n\"wheel.width\" = 0.08\n[[run]]\nfile = \"a.csv\"\n"
    );
    read(&toml, &csv)
}

/// The one doubt about the mishap.
fn doubt(mishap: impl Fn(&mut Row)) -> String {
    let doubts = wheel(mishap).unwrap().doubts;
    assert_eq!(doubts.len(), 1, "{doubts:?}");
    doubts[0].clone()
}

#[test]
fn property_sound_data_raise_no_doubt() {
    assert_eq!(wheel(|_| ()).unwrap().doubts, [] as [String; 0]);
    // A wheel that turns backward pulls backward.
    let backward = |row: &mut Row| {
        for k in [2, 3, 4] {
            row[k] = -row[k];
        }
    };
    assert_eq!(wheel(backward).unwrap().doubts, [] as [String; 0]);
}

#[test]
fn property_units_of_a_wheel_are_doubted_with_the_line_that_mends_them() {
    let kilonewtons = doubt(|row| row[3] *= 1e-3);
    assert!(kilonewtons.contains("\"drawbar_pull\" = { signal = \"drawbar_pull\", unit = \"kN\" }"), "{kilonewtons}");
    let kilograms = doubt(|row| row[0] /= 9.81);
    assert!(kilograms.contains("\"load\" = { signal = \"load\", unit = \"kg\" }"), "{kilograms}");
    // 30 rpm, which are 3.1 rad/s.
    let rpm = doubt(|row| row[2] = 30.0);
    assert!(rpm.contains("\"wheel_speed\" = { signal = \"wheel_speed\", unit = \"rpm\" }"), "{rpm}");
}

#[test]
fn property_a_light_load_shows_in_the_sinkage_alone() {
    let lines = |load: f64| {
        let rows = (0..4).map(|k| format!("{load},{},0.2,{}\n", 0.05 * f64::from(k), 0.015 + 0.001 * f64::from(k)));
        "load,slip,wheel_speed,sinkage\n".to_owned() + &rows.collect::<String>()
    };
    let toml = "name = \"t\"\nkind = \"single_wheel\"\n[parameters]\n\"wheel.radius\" = 0.058\n\"wheel.width\" = 0.05\n[[run]]\nfile = \"a.csv\"\n";
    assert_eq!(read(toml, &lines(25.0)).unwrap().doubts, [] as [String; 0]);
    let doubts = read(toml, &lines(25.0 / 9.81)).unwrap().doubts;
    assert!(doubts[0].contains("unit = \"kg\""), "{doubts:?}");
}

#[test]
fn property_signs_that_cannot_be_are_refused() {
    let error = wheel(|row| row[3] = -row[3]).unwrap_err();
    assert_eq!(error.column.as_deref(), Some("drawbar_pull"));
    let message = error.to_string();
    assert!(message.contains("\"drawbar_pull\" = { signal = \"drawbar_pull\", sign = -1 }"), "{message}");
    let error = wheel(|row| row[5] = -row[5]).unwrap_err();
    assert_eq!(error.column.as_deref(), Some("sinkage"));
    let message = error.to_string();
    assert!(message.contains("\"sinkage\" = { signal = \"sinkage\", sign = -1 }"), "{message}");
    // Without skid a turned pull is unlikely only.
    let turned = doubt(|row| {
        row[1] = row[1].max(0.0);
        row[3] = -row[3] * f64::from(u8::from(row[1] > 0.0)) + 6.0 * f64::from(u8::from(row[1] <= 0.0));
    });
    assert!(turned.contains("falls with slip") && turned.contains("sign = -1"), "{turned}");
}

#[test]
fn property_parameters_and_priors_in_other_units() {
    let with = |lines: &str| {
        let toml = format!("name = \"t\"\nkind = \"single_wheel\"\n{lines}\n[[run]]\nfile = \"a.csv\"\n");
        read(&toml, "load,slip,wheel_speed,sinkage\n30,0.1,0.2,0.01\n")
    };
    let refused = [
        (
            "[priors]\n\"soil.friction_angle\" = { mean = 3.0, sd = 0.1 }",
            "write { mean = 3, sd = 0.1, unit = \"deg\" }",
        ),
        ("[parameters]\n\"soil.friction_angle\" = 30", "write { value = 30, unit = \"deg\" }"),
        ("[parameters]\n\"wheel.radius\" = 58", "write { value = 58, unit = \"mm\" }"),
        ("[priors]\n\"soil.shear_modulus\" = { mean = 15, sd = 5 }", "unit = \"mm\""),
    ];
    for (lines, words) in refused {
        let error = with(lines).unwrap_err();
        assert!(error.line == Some(4) && error.to_string().contains(words), "{error}");
    }
    let doubted = [
        (
            "[priors]\n\"soil.friction_angle\" = { mean = 0.5, sd = 3.0 }",
            "the standard deviation 3 rad of `soil.friction_angle` is wider than its range",
        ),
        ("[parameters]\n\"soil.cohesion\" = 1.2", "{ value = 1.2, unit = \"kPa\" }"),
        ("[priors]\n\"soil.cohesion\" = { mean = 1.2, sd = 0.3 }", "{ mean = 1.2, unit = \"kPa\" }"),
        ("[parameters]\n\"soil.k_phi\" = 1500", "{ value = 1500, unit = \"kN/m^(n+2)\" }"),
    ];
    for (lines, words) in doubted {
        let doubts = with(lines).unwrap().doubts;
        assert!(doubts.len() == 1 && doubts[0].contains(words), "{doubts:?}");
    }
    let sound = "[parameters]\n\"soil.cohesion\" = 0\n[priors]\n\"soil.friction_angle\" = { mean = 0.5, sd = 0.05 }";
    assert_eq!(with(sound).unwrap().doubts, [] as [String; 0]);
}

/// A drive at 0.1 m/s: command (rad/s), velocity (m/s), pitch (rad), torque (N m), changed by `mishap`.
fn rover(mishap: impl Fn(&mut [f64; 4])) -> Vec<String> {
    let mut csv = "time,wheel[1].speed_command,velocity,pitch,wheel[1].torque\n".to_owned();
    for k in 0..20 {
        let mut row = [1.1, 0.1, 0.1 * f64::from(k % 3), 0.4];
        mishap(&mut row);
        csv += &format!("{},{}\n", 0.1 * f64::from(k), row.map(|value| format!("{value}")).join(","));
    }
    let toml = "name = \"t\"\nkind = \"traverse\"\n[parameters]\n\"wheel.radius\" = 0.1\n[[run]]\nfile = \"a.csv\"\n";
    read(toml, &csv).unwrap().doubts
}

#[test]
fn property_units_and_signs_of_a_drive_are_doubted() {
    assert_eq!(rover(|_| ()), [] as [String; 0]);
    type Change<'a> = (&'a str, &'a dyn Fn(&mut [f64; 4]));
    let cases: [Change; 4] = [
        ("unit = \"rpm\"", &|row| row[0] *= 30.0 / std::f64::consts::PI),
        ("signal = \"velocity\", sign = -1", &|row| row[1] = -row[1]),
        ("signal = \"pitch\", unit = \"deg\"", &|row| row[2] *= 10.0),
        ("signal = \"wheel[1].torque\", sign = -1", &|row| row[3] = -row[3]),
    ];
    for (words, mishap) in cases {
        let doubts = rover(mishap);
        assert!(doubts.len() == 1 && doubts[0].contains(words), "{words}: {doubts:?}");
    }
}

#[test]
fn property_a_rover_that_stands_at_the_end_while_its_wheels_turn_is_doubted() {
    // Of 20 rows at 10 Hz the last twelve: 1.1 s. The rover of each call counts its rows by itself.
    let ending = |standing: i32, speed: f64| {
        let row_number = std::cell::Cell::new(0);
        rover(move |row| {
            if row_number.get() >= 20 - standing {
                (row[0], row[1]) = (speed, 0.001);
            }
            row_number.set(row_number.get() + 1);
        })
    };
    let doubts = ending(12, 1.1);
    assert_eq!(doubts.len(), 1, "{doubts:?}");
    assert!(
        doubts[0].contains("from 0.8 s to the last row the rover stands while `wheel[1].speed_command` goes on"),
        "{doubts:?}"
    );
    assert!(doubts[0].contains("at the same value in every row"), "{doubts:?}");
    // A short halt, and a rover whose wheels stand too, are no doubt.
    assert_eq!(ending(8, 1.1), [] as [String; 0]);
    assert_eq!(ending(12, 0.0), [] as [String; 0]);
}

#[test]
fn property_the_same_doubt_about_several_files_is_said_once() {
    let rows = |degrees: f64| {
        let row = |k: usize| format!("{k},1,{}\n", degrees + k as f64 * 0.01);
        "time,wheel[1].speed_command,pitch\n".to_owned() + &(0..10).map(row).collect::<String>()
    };
    let runs = ["a", "b", "c"].map(|name| format!("[[run]]\nfile = \"{name}.csv\"\n")).concat();
    let settings = ("experiment.toml".to_owned(), format!("name = \"t\"\nkind = \"traverse\"\n{runs}"));
    let files = [("a", 2.0), ("b", 2.5), ("c", 0.1)].map(|(name, degrees)| (format!("{name}.csv"), rows(degrees)));
    let experiment = Experiment::from_texts(&[settings].into_iter().chain(files).collect()).unwrap();
    assert_eq!(experiment.doubts.len(), 1, "{:?}", experiment.doubts);
    assert!(
        experiment.doubts[0].starts_with("a.csv and 1 more file: `pitch` reaches 2.09 rad"),
        "{:?}",
        experiment.doubts
    );
}
