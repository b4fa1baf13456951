//! The thesis's vehicles against what it says of them.
#![allow(clippy::unwrap_used, reason = "a test may fail by panicking")]

use bekker::model::Model;
use bekker::rover::Rover;

/// Shares are printed as whole per cents.
const PRINTED: f64 = 0.005;
/// Unequal sinkage pitches the rover, and the centre of mass, 0.14 m above ground on a base of 0.4 m, moves load to the other end.
const PITCHED: f64 = 0.14 / 0.4;

#[test]
fn published_the_fsrl_rover_stands_on_its_wheels_as_section_4_4_2_says() {
    let run = Model::new("fsrl", Rover::fsrl()).start().unwrap();
    let loads: Vec<f64> = run.signals().wheels.iter().map(|wheel| wheel.normal_force).collect();
    let (weight, pitch) = (loads.iter().sum::<f64>(), run.signals().body.pitch.abs());
    assert!((weight - 3.05 * 9.81).abs() < 1e-3, "half of 6.1 kg: {weight}");
    for (load, share) in loads.iter().zip([0.49, 0.35, 0.16]) {
        assert!((load / weight - share).abs() < PRINTED + PITCHED * pitch, "{loads:?}, pitch {pitch}");
    }
}

#[test]
fn published_the_fsrl_rover_drives_at_8_cm_a_second_and_12_rpm() {
    let radius = Rover::fsrl().wheel.radius;
    let rim = radius * 12.0 * std::f64::consts::TAU / 60.0;
    assert!((rim - 0.08).abs() < 5e-4, "{rim}");
}

#[test]
fn property_every_course_can_be_started_on() {
    for preset in ["challenging_velocity", "challenging_rtc", "fsrl_ditch", "fsrl_incline"] {
        let mut run = Model::preset(preset).unwrap().start().unwrap();
        run.advance(1500).unwrap();
        println!("{preset}: {:?} x {:.3} after {} s", run.status(), run.signals().body.x, run.time());
        assert!(run.signals().body.x > 0.02, "{preset}: {} m", run.signals().body.x);
    }
}
