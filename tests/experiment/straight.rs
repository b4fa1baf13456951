//! Logs of vehicles that turn: straight stretches, positions, both sides, currents without a sign.

use bekker::measurement::{Experiment, ExperimentError};
use std::collections::BTreeMap;
use std::f64::consts::{FRAC_PI_2, PI};
use std::fmt::Write;

/// Time between rows, s, and speed of the vehicle, m/s.
const STEP: f64 = 0.1;
const SPEED: f64 = 0.5;

/// How far from a corner positions alone still see it, m: its segment of the route, the next one, and half a second of averages.
const CORNER: f64 = 2.0 + 0.5 * SPEED;

const RIG: &str = "[parameters]\n\"wheel.radius\" = 0.2\n\"wheel[1].x\" = -0.35\n\"wheel[2].x\" = 0.35\n";

fn read(settings: &str, csv: &str) -> Result<Experiment, ExperimentError> {
    let toml = format!("name = \"t\"\nkind = \"traverse\"\n{settings}\n{RIG}[[run]]\nfile = \"a.csv\"\n");
    let texts = [("experiment.toml", toml), ("a.csv", csv.to_owned())].map(|(name, text)| (name.to_owned(), text));
    Experiment::from_texts(&BTreeMap::from(texts))
}

/// One row of a drive in the plane.
struct Row {
    time: f64,
    speed: f64,
    heading: f64,
    at: [f64; 2],
}

/// A drive of parts (seconds, speed in m/s, yaw rate in rad/s) from the origin.
fn drive(parts: &[(f64, f64, f64)]) -> Vec<Row> {
    let mut rows = Vec::new();
    let (mut time, mut heading, mut at) = (0.0, 3.0, [400.0, -30.0]);
    for (seconds, speed, yaw_rate) in parts {
        for _ in 0..(seconds / STEP).round() as usize {
            rows.push(Row { time, speed: *speed, heading, at });
            let middle: f64 = heading + 0.5 * yaw_rate * STEP;
            at = [at[0] + speed * STEP * middle.cos(), at[1] + speed * STEP * middle.sin()];
            heading += yaw_rate * STEP;
            time += STEP;
        }
    }
    rows
}

/// Ten seconds ahead, a quarter turn on the spot, ten seconds ahead.
fn with_a_corner() -> Vec<Row> {
    drive(&[(10.0, SPEED, 0.0), (3.0, 0.0, FRAC_PI_2 / 3.0), (10.0, SPEED, 0.0)])
}

/// A table of the named columns; wheels turn as the vehicle moves, or slowly against each other where it turns on the spot.
fn csv(columns: &str, rows: &[Row], cells: impl Fn(&Row) -> Vec<f64>) -> String {
    let mut text = format!("time,wheel[1].speed,wheel[2].speed,pitch,{columns}\n");
    for row in rows {
        let wheel = row.speed / 0.2;
        let rest: Vec<String> = cells(row).iter().map(f64::to_string).collect();
        writeln!(text, "{},{wheel},{wheel},0.01,{}", row.time, rest.join(",")).unwrap();
    }
    text
}

/// A heading in degrees that jumps at 180.
fn degrees(heading: f64) -> f64 {
    (heading + PI).rem_euclid(2.0 * PI).to_degrees() - 180.0
}

const HEADING: &str = "[columns]\n\"yaw_deg\" = { signal = \"heading\", unit = \"deg\" }";

#[test]
fn analytic_a_stretch_begins_and_ends_with_turning_wheels() {
    // The vehicle is measured to move on while its wheels stand already, as where speeds are averaged.
    let rows = drive(&[(1.0, 0.0, 0.0), (10.0, SPEED, 0.0), (1.0, 0.0, 0.0)]);
    let text = csv("yaw_deg,velocity", &rows, |row| vec![degrees(row.heading), SPEED]);
    let experiment = read(HEADING, &text).unwrap();
    assert_eq!(experiment.runs.len(), 1);
    let (time, speed) =
        (experiment.runs[0].data.column("time").unwrap(), experiment.runs[0].data.column("wheel[1].speed").unwrap());
    assert_eq!(time.len(), 100);
    assert!((time[0] - 1.0).abs() < 1e-9 && speed.iter().all(|speed| *speed > 0.0));
    // Wheels that stand for a moment on the way end no stretch.
    let on_the_way = drive(&[(5.0, SPEED, 0.0), (0.2, 0.0, 0.0), (5.0, SPEED, 0.0)]);
    let text = csv("yaw_deg,velocity", &on_the_way, |row| vec![degrees(row.heading), SPEED]);
    let experiment = read(HEADING, &text).unwrap();
    assert_eq!(experiment.runs.iter().map(|run| run.data.rows()).collect::<Vec<_>>(), [102]);
}

#[test]
fn analytic_a_drive_with_a_corner_becomes_two_runs() {
    let rows = with_a_corner();
    let by_heading = csv("yaw_deg,velocity", &rows, |row| vec![degrees(row.heading), row.speed]);
    let by_rate =
        csv("yaw_rate,velocity", &rows, |row| vec![if row.speed == 0.0 { FRAC_PI_2 / 3.0 } else { 0.0 }, row.speed]);
    for (settings, text) in [(HEADING, by_heading), ("", by_rate)] {
        let experiment = read(settings, &text).unwrap();
        let names: Vec<&str> = experiment.runs.iter().map(|run| run.name.as_str()).collect();
        assert_eq!(names, ["a#1", "a#2"]);
        for (run, [from, to]) in experiment.runs.iter().zip([[0.0, 10.0], [13.0, 23.0]]) {
            let time = run.data.column("time").unwrap();
            assert!(
                (time[0] - from).abs() <= 0.5 + STEP && (time[time.len() - 1] - to).abs() <= 0.5 + STEP,
                "{time:?}"
            );
            assert_eq!(run.measured, ["pitch", "velocity"], "what tells of turns is not compared");
        }
        let doubts = experiment.doubts.join("\n");
        assert!(doubts.contains("of 230 rows are left out") && doubts.contains("2 straight stretches"), "{doubts}");
        // 0.35 m over 0.1.
        assert!(doubts.contains("a radius under 3.5 m"), "{doubts}");
    }
}

#[test]
fn analytic_a_wide_curve_is_straight_and_a_tight_one_is_not() {
    let circle = |radius: f64| {
        let rows = drive(&[(20.0, SPEED, SPEED / radius)]);
        read(HEADING, &csv("yaw_deg,velocity", &rows, |row| vec![degrees(row.heading), row.speed]))
    };
    let wide = circle(4.0).unwrap();
    assert_eq!(wide.runs.len(), 1);
    assert_eq!(wide.runs[0].data.rows(), 200);
    assert_eq!(wide.doubts, [] as [String; 0]);
    let message = circle(3.0).unwrap_err().to_string();
    assert!(message.contains("nowhere drives straight for 3 s"), "{message}");
}

#[test]
fn property_gentle_curves_are_turns_where_the_drive_needs_more() {
    // A slip angle of 0.06 rad at the lever of 0.35 m, every ten seconds for five.
    let yaw_rate = 0.06 * SPEED / 0.35;
    let rows = drive(&[[(10.0, SPEED, 0.0), (5.0, SPEED, yaw_rate)]; 12].concat());
    let curved = |row: &Row| row.time.rem_euclid(15.0) > 10.0 - 0.5 * STEP;
    let read_with = |in_curves: f64| {
        let text = csv("yaw_rate,velocity,wheel[1].current,wheel[2].current", &rows, |row| {
            let current = (if curved(row) { in_curves } else { 2.0 }) + 0.2 * (17.0 * row.time).sin();
            vec![if curved(row) { yaw_rate } else { 0.0 }, row.speed, current, current]
        });
        read("", &text).unwrap()
    };
    assert_eq!(read_with(2.0).runs.len(), 1);
    let cut = read_with(4.0);
    assert_eq!(cut.runs.len(), 12);
    let doubts = cut.doubts.join("\n");
    // 0.35 m over half of 0.1 or less.
    assert!(doubts.contains("in which its drive needs more than straight ahead"), "{doubts}");
}

#[test]
fn analytic_positions_give_the_way_the_corners_and_the_ground() {
    // The ground rises by a tenth of the way.
    let rows = drive(&[(20.0, SPEED, 0.0), (3.0, 0.0, FRAC_PI_2 / 3.0), (20.0, SPEED, 0.0)]);
    let way = |row: &Row| SPEED * if row.time < 20.0 { row.time } else { (row.time - 3.0).max(20.0) };
    let text = csv("easting,northing,ground_height", &rows, |row| vec![row.at[0], row.at[1], 7.0 + 0.1 * way(row)]);
    let experiment = read("", &text).unwrap();
    assert_eq!(experiment.runs.len(), 2);
    for (run, begins) in experiment.runs.iter().zip([0.0, 10.0]) {
        assert_eq!(run.measured, ["pitch", "x"]);
        assert!((run.x0.unwrap() - begins).abs() <= CORNER, "{:?}", run.x0);
        let x = run.data.column("x").unwrap();
        let time = run.data.column("time").unwrap();
        let middle = x.len() / 4..3 * x.len() / 4;
        for row in middle {
            let length = x[row] - x[x.len() / 4];
            let expected = SPEED * (time[row] - time[x.len() / 4]);
            assert!((length - expected).abs() < 1e-6, "row {row}: {length} for {expected}");
        }
        let ground = run.terrain.as_ref().unwrap();
        let (gx, gz) = (ground.column("x").unwrap(), ground.column("z").unwrap());
        let count = gx.len();
        assert!(gx[0] < x[0] - 1.0 && gx[count - 1] > x[x.len() - 1] + 1.0, "it goes on under the end wheels");
        let slope = (gz[3 * count / 4] - gz[count / 4]) / (gx[3 * count / 4] - gx[count / 4]);
        assert!((slope - 0.1).abs() < 1e-3, "slope {slope}");
    }
}

#[test]
fn analytic_noise_of_positions_does_not_add_up() {
    let rows = drive(&[(60.0, SPEED, 0.0)]);
    // Uniform, with a standard deviation of 2 cm.
    let noise = |seed: f64| 0.02 * 12.0_f64.sqrt() * (((12.9898 * seed).sin() * 43758.5453).rem_euclid(1.0) - 0.5);
    let text = csv("easting,northing", &rows, |row| {
        vec![row.at[0] + noise(17.0 + row.time * 97.0), row.at[1] + noise(5.0 + row.time * 131.0)]
    });
    let experiment = read("", &text).unwrap();
    let x = experiment.runs[0].data.column("x").unwrap();
    let time = experiment.runs[0].data.column("time").unwrap();
    let errors: Vec<f64> = x.iter().zip(time).map(|(x, t)| x - SPEED * t).collect();
    let scatter = (errors.iter().map(|e| e * e).sum::<f64>() / errors.len() as f64).sqrt();
    // 2 cm a position, and a thousandth of 30 m; the sum of the distances between neighbours would be off by metres.
    assert!(scatter < 0.05, "scatter {scatter}");
    // A vehicle that drives back along its way comes back to where it began.
    let back = drive(&[(20.0, SPEED, 0.0), (20.0, -SPEED, 0.0)]);
    let experiment = read("", &csv("easting,northing", &back, |row| row.at.to_vec())).unwrap();
    let x = experiment.runs.last().unwrap().data.column("x").unwrap();
    assert!(x[x.len() - 1].abs() < 0.2 && experiment.runs[0].data.column("x").unwrap()[100] > 4.0, "{x:?}");
}

#[test]
fn property_both_sides_are_averaged_and_magnitudes_get_their_sign() {
    let settings = r#"[columns]
"rpm_left" = { signal = "speed", wheels = [1, 2], side = "left" }
"rpm_right" = { signal = "speed", wheels = [1, 2], side = "right" }
"amps_left" = { signal = "current", wheels = [1, 2], side = "left", magnitude = true }
"amps_right" = { signal = "current", wheels = [1, 2], side = "right", magnitude = true }
"#;
    let mut text = "time,rpm_left,rpm_right,amps_left,amps_right\n".to_owned();
    for k in 0..40 {
        let speed = if k < 20 {
            1.0
        } else if k < 25 {
            0.0
        } else {
            -1.0
        };
        let right = if k == 3 { String::new() } else { (2.0 + f64::from(k)).to_string() };
        writeln!(text, "{},{},{},{k},{right}", f64::from(k) * STEP, speed * 0.9, speed * 1.1).unwrap();
    }
    let data = &read(settings, &text).unwrap().runs[0].data;
    let current = data.column("wheel[1+2].current").unwrap();
    assert_eq!(data.value("wheel[2].speed", 0), Some(1.0));
    assert_eq!((current[0], current[10], current[30]), (1.0, 11.0, -31.0));
    assert!(current[3].is_nan(), "a cell that one side lacks is missing");
    assert!(current[22].is_nan(), "a wheel that stands gives no sign");
    // Without the key, that is a doubt which names it.
    let one_side = "ignore = [\"*right\", \"rpm_right\", \"amps_right\"]\n[columns]\n\
                    \"rpm_left\" = { signal = \"speed\", wheels = [1, 2] }\n\
                    \"amps_left\" = { signal = \"current\", wheels = [1, 2] }\n";
    let doubts = read(one_side, &text).unwrap().doubts.join("\n");
    assert!(
        doubts.contains("never negative") && doubts.contains("`magnitude = true` in the entry of \"amps_left\""),
        "{doubts}"
    );
}

#[test]
fn property_what_a_route_lacks_is_said() {
    let rows = with_a_corner();
    let refused = |settings: &str, text: &str| read(settings, text).unwrap_err().to_string();
    let half = csv("easting", &rows, |row| vec![row.at[0]]);
    assert!(refused("", &half).contains("there is no `northing`"));
    let twice = csv("easting,northing,x", &rows, |row| vec![row.at[0], row.at[1], row.at[0]]);
    assert!(refused("", &twice).contains("positions give `x`, which another column gives too"));
    let nowhere = csv("yaw_rate,ground_height,velocity", &rows, |row| vec![0.0, 1.0, row.speed]);
    assert!(refused("", &nowhere).contains("the height of the ground needs a place"));
    let magnitude = "[columns]\n\"amps\" = { signal = \"velocity\", magnitude = true }";
    let text = csv("amps", &rows, |_| vec![1.0]);
    assert!(refused(magnitude, &text).contains("`magnitude` is for the current or torque"));
    let sign = "[columns]\n\"amps\" = { signal = \"current\", wheels = [1], magnitude = true, sign = -1 }";
    assert!(refused(sign, &text).contains("has no `sign`"));
}

#[test]
fn property_what_is_recorded_seldom_or_not_at_all_does_not_mislead() {
    // Half a metre, at a crawl: too short for a second knot of the route.
    let slow = drive(&[(10.0, 0.05, 0.0)]);
    let experiment = read("", &csv("easting,northing", &slow, |row| row.at.to_vec())).unwrap();
    let x = experiment.runs[0].data.column("x").unwrap();
    assert!((x[99] - 0.05 * 9.9).abs() < 1e-6, "{}", x[99]);
    // A receiver at 1 Hz under a recorder at 10 Hz, which holds its last position.
    let rows = drive(&[(30.0, SPEED, 0.0)]);
    let mut held = [0.0; 2];
    let mut text = "time,wheel[1].speed,wheel[2].speed,yaw_rate,easting,northing,pitch\n".to_owned();
    for (k, row) in rows.iter().enumerate() {
        if k % 10 == 0 {
            held = row.at;
        }
        // Every second speed is missing.
        let speed = if k % 2 == 0 { (SPEED / 0.2).to_string() } else { String::new() };
        writeln!(text, "{},{speed},{speed},0.004,{},{},0.01", row.time, held[0], held[1]).unwrap();
    }
    let text = text.trim_end().rsplit_once('\n').unwrap().0;
    let experiment = read("", text).unwrap();
    assert_eq!(experiment.runs.len(), 1, "{:?}", experiment.doubts);
    let run = &experiment.runs[0];
    let (x, time) = (run.data.column("x").unwrap(), run.data.column("time").unwrap());
    assert_eq!(x.iter().filter(|x| !x.is_nan()).count(), 30, "held positions are missing");
    for (x, time) in x.iter().zip(time).filter(|(x, _)| !x.is_nan()) {
        assert!((x - SPEED * time).abs() < 1e-6, "{x} at {time}");
    }
    // Backward with every second speed missing: the vehicle goes back along its way.
    let back = drive(&[(20.0, SPEED, 0.0), (20.0, -SPEED, 0.0)]);
    let mut text = "time,wheel[1].speed,wheel[2].speed,easting,northing\n".to_owned();
    for (k, row) in back.iter().enumerate() {
        let speed = if k % 2 == 0 || k == 399 { (row.speed / 0.2).to_string() } else { String::new() };
        writeln!(text, "{},{speed},{speed},{},{}", row.time, row.at[0], row.at[1]).unwrap();
    }
    let experiment = read("", &text).unwrap();
    let x = experiment.runs.last().unwrap().data.column("x").unwrap();
    assert!(x[x.len() - 1].abs() < 0.2, "{x:?}");
}

#[test]
fn property_a_log_at_one_hertz_is_cut_at_its_corner() {
    let rows: Vec<Row> = drive(&[(30.0, SPEED, 0.0), (4.0, 0.1, FRAC_PI_2 / 4.0), (30.0, SPEED, 0.0)])
        .into_iter()
        .enumerate()
        .filter_map(|(k, row)| (k % 10 == 0).then_some(row))
        .collect();
    let experiment =
        read(HEADING, &csv("yaw_deg,velocity", &rows, |row| vec![degrees(row.heading), row.speed])).unwrap();
    assert_eq!(experiment.runs.len(), 2, "{:?}", experiment.doubts);
}

#[test]
fn property_signs_are_judged_before_a_drive_is_cut() {
    let there_and_back = drive(&[(20.0, SPEED, 0.0), (1.0, 0.0, 0.0), (20.0, -SPEED, 0.0)]);
    let settings = "[columns]\n\"left\" = { signal = \"current\", wheels = [1, 2], side = \"left\" }\n\
                    \"right\" = { signal = \"current\", wheels = [1, 2], side = \"right\" }";
    let text = csv("heading,left,right", &there_and_back, |row| vec![row.heading, 2.0, 3.0]);
    let experiment = read(settings, &text).unwrap();
    let doubts = experiment.doubts.join("\n");
    assert_eq!(experiment.runs.len(), 2);
    assert!(doubts.contains("`magnitude = true` in the entries of \"left\" and \"right\""), "{doubts}");
    assert!(!doubts.contains("sign = -1"), "{doubts}");
    let one = settings.replace("side = \"left\"", "side = \"left\", magnitude = true");
    let message = read(&one, &text).unwrap_err().to_string();
    assert!(message.contains("`magnitude` is for both sides or for none"), "{message}");
}

#[test]
fn property_repeats_are_not_cut_and_times_not_missing() {
    let paused = drive(&[(2.0, 0.0, 0.0), (20.0, SPEED, 0.0)]);
    let text = csv("yaw_rate,velocity", &paused, |row| vec![0.0, row.speed]);
    let toml = format!("name = \"t\"\nkind = \"traverse\"\n{RIG}[[run]]\nfile = \"a.csv\"\ngroup = \"g\"\n");
    let texts = [("experiment.toml", toml), ("a.csv", text.clone())].map(|(name, text)| (name.to_owned(), text));
    let message = Experiment::from_texts(&BTreeMap::from(texts)).unwrap_err().to_string();
    assert!(message.contains("leave out `group`"), "{message}");
    let gap = text.replacen("\n0.1,", "\n,", 1);
    let message = read("", &gap).unwrap_err().to_string();
    assert!(message.contains("line 3, column `time`: an input may not be missing"), "{message}");
}
