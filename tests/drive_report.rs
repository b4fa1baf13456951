//! The page of a traverse: its windows, the rover on its ground, where it fails, what does not count.
#![allow(clippy::unwrap_used, reason = "a test may fail by panicking")]
#![cfg(feature = "report")]

#[path = "support/hill_drive.rs"]
#[allow(dead_code, reason = "tests use parts of it")]
mod hill_drive;

#[path = "support/saved_page.rs"]
#[allow(dead_code, reason = "tests use parts of it")]
mod saved_page;

use bekker::diagnosis::{CompareOptions, Comparison, Uncounted, compare};
use bekker::report::comparison_page;
use hill_drive::{PERIOD, PLANTED, ROWS, drive, shipped};
use saved_page::{data, numbers, text};
use std::path::Path;
use std::sync::LazyLock;

/// Words of two bytes over the 6 m of the drive.
const WRITTEN: f64 = 1e-4;
/// Rows that are missing, and those in which the torque of wheel 1 is recorded wrong by twenty times its noise: the last third.
const GAP: std::ops::Range<usize> = 95..125;
const WRONG: std::ops::Range<usize> = 180..ROWS;
/// Column of the torque of wheel 1, and by how much it is wrong, N m.
const TORQUE: usize = 6;
const TOO_MUCH: f64 = 0.4;

/// The drive with a gap and a wrong torque, compared with its own soil, which is known.
static COMPARISON: LazyLock<Comparison> = LazyLock::new(|| {
    let mut experiment = drive(|row, cells| {
        if WRONG.contains(&row) {
            cells[TORQUE] = cells[TORQUE].map(|torque| torque + TOO_MUCH);
        }
        !GAP.contains(&row)
    });
    experiment.parameters.extend(PLANTED.map(|(name, value)| (name.to_owned(), value)));
    // One parameter that the drive tells nothing of keeps the calibration, which cuts the drive, quick.
    experiment.priors.insert("soil.cohesion".to_owned(), bekker::measurement::Prior { mean: 1000.0, deviation: 100.0 });
    compare(&shipped(), &experiment, &CompareOptions { calibrate: true, ..CompareOptions::default() }).unwrap()
});

static PAGE: LazyLock<String> = LazyLock::new(|| comparison_page(&COMPARISON));

#[test]
fn property_the_page_of_a_drive_is_complete_and_alone() {
    std::fs::write(Path::new(env!("CARGO_TARGET_TMPDIR")).join("drive.html"), &*PAGE).unwrap();
    for tag in ["<script src", "<link rel=\"style", "<img", "@import", "<iframe"] {
        assert!(!PAGE.contains(tag), "{tag}");
    }
    let text = text(&PAGE);
    assert_eq!(text.matches("<script").count(), text.matches("</script>").count());
    assert!(!text.contains("NaN"));
    for heading in ["Under which conditions", "What is not counted, and why"] {
        assert_eq!(text.matches(&format!("<h3>{heading}</h3>")).count(), 1, "{heading}");
    }
}

#[test]
fn agreement_the_page_holds_what_was_measured_and_what_the_model_says() {
    let (saved, comparison) = (data(&PAGE), &*COMPARISON);
    let (run, fit) = (&saved["experiment"]["runs"][0], comparison.fit());
    let model = &saved["models"][1];
    let own = &comparison.experiment.runs[0].data;
    assert_eq!(numbers(&run["data"]["time"]).len(), own.rows());
    for signal in ["x", "pitch"] {
        let known = fit.runs[0].signal(signal).unwrap();
        let (measured, modelled) = (numbers(&run["data"][signal]), numbers(&model["runs"][0][signal]));
        for row in 0..own.rows() {
            assert!((measured[row] - known.measured[row]).abs() < WRITTEN, "measured {signal} in row {row}");
            assert!((modelled[row] - known.modelled[row]).abs() < WRITTEN, "modelled {signal} in row {row}");
        }
    }
    // The rover stands where the model has it, and its windows begin where they do.
    let (motion, drawn) = (&fit.motion[0], &model["motion"][0]);
    for (row, x) in numbers(&drawn["centres"][1][0]).iter().enumerate() {
        assert!((x - motion.centres[row][1][0]).abs() < WRITTEN, "{x}");
    }
    let begins: Vec<f64> = drawn["windows"].as_array().unwrap().iter().map(|window| numbers(window)[0]).collect();
    assert_eq!(begins, motion.windows.iter().map(|window| window.start as f64).collect::<Vec<_>>());
    // Height was not recorded, and nothing pretends that it was.
    assert!(run["data"]["z"].is_null() && PAGE.contains("Its height was not measured"));
}

#[test]
fn analytic_wheels_stand_on_the_ground_and_its_slope_is_that_of_the_line_between_them() {
    let motion = &COMPARISON.fit().motion[0];
    let height = |x: f64| 0.03 * (2.0 * x).sin();
    for (row, wheels) in motion.centres.iter().enumerate() {
        let [rear, front] = [wheels[0], wheels[1]];
        for centre in [rear, front] {
            // A wheel stands a little deeper than its radius above the ground, and the foot is not quite under its centre.
            let clear = centre[1] - height(centre[0]);
            assert!((0.8..1.05).contains(&(clear / motion.radius)), "row {row}: {clear}");
        }
        let slope = ((height(front[0]) - height(rear[0])) / (front[0] - rear[0])).atan();
        // The chassis is pitched by a few degrees, so that its wheels stand a little nearer to each other.
        assert!((motion.slope[row] - slope).abs() < 0.01, "row {row}: {} and {slope}", motion.slope[row]);
    }
    // Both wheels carry the whole weight, but for what heave and slope change.
    let weight = 9.81 * shipped().rover.total_mass();
    let loads: Vec<f64> = (0..motion.slope.len()).map(|row| motion.load[0][row] + motion.load[1][row]).collect();
    let mean = loads.iter().sum::<f64>() / loads.len() as f64;
    assert!((mean / weight - 1.0).abs() < 0.05, "{mean} and {weight}");
}

#[test]
fn property_start_and_gap_are_said_with_their_times_and_do_not_count() {
    let comparison = &*COMPARISON;
    let of = |why: Uncounted| comparison.uncounted.iter().filter(|rows| rows.why == why).collect::<Vec<_>>();
    let (starts, gaps) = (of(Uncounted::Start), of(Uncounted::Gap));
    assert_eq!((starts.len(), gaps.len(), comparison.uncounted.len()), (1, 1, 2), "{:?}", comparison.uncounted);
    assert_eq!(starts[0].rows.0, 1);
    let end = GAP.end as f64 * PERIOD;
    let [from, _] = gaps[0].seconds.unwrap();
    assert!((from - end).abs() < 1e-9, "{from}");
    assert!(gaps[0].reason.contains(&format!("no rows from {:.1} to {end:.1} s", (GAP.start - 1) as f64 * PERIOD)));
    // What does not count has no residual, and what counts has one.
    let fit = comparison.fit().runs[0].signal("x").unwrap();
    for (row, residual) in fit.residual.iter().enumerate() {
        let counts = !comparison.uncounted.iter().any(|rows| (rows.rows.0..=rows.rows.1).contains(&(row + 1)));
        assert_eq!(counts, !residual.is_nan(), "row {row}");
    }
    assert!(PAGE.contains("at the start of 1 run, ") && PAGE.contains("behind 1 gap in the recording"));
    // The page takes its residuals from the rows that it is told do not count.
    let told = data(&PAGE)["experiment"]["uncounted"].clone();
    for (told, rows) in told.as_array().unwrap().iter().zip(&comparison.uncounted) {
        assert_eq!(
            (told["first"].as_u64(), told["last"].as_u64()),
            (Some(rows.rows.0 as u64), Some(rows.rows.1 as u64))
        );
    }
    assert_eq!(told.as_array().unwrap().len(), comparison.uncounted.len());
}

#[test]
fn property_the_window_that_is_wrong_is_named_first() {
    let facts = PAGE.split("<div class=\"drive-facts\">").nth(1).unwrap();
    let facts = &facts[..facts.find("</div>").unwrap()];
    let worst = facts.split("the worst are ").nth(1).unwrap();
    let time: f64 = worst.split("run run at ").nth(1).unwrap().split(" to ").next().unwrap().parse().unwrap();
    assert!(time >= WRONG.start as f64 * PERIOD - 6.0, "{worst}");
    assert!(worst.split(';').next().unwrap().contains("torque of wheel 1"), "{worst}");
    // The fit spreads a part of what is wrong over the other windows, which are far better.
    let ratio: f64 = worst.split("torque of wheel 1 ").nth(1).unwrap().split(' ').next().unwrap().parse().unwrap();
    assert!(ratio > 5.0, "{worst}");
    let others =
        worst.split(';').skip(1).filter_map(|rest| rest.split(" times").next()?.rsplit(' ').next()?.parse().ok());
    assert!(others.into_iter().all(|other: f64| other < 0.5 * ratio), "{worst}");
}
