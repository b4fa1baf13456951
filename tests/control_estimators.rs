//! Claims: rough-terrain control runs on estimated contact angles and an identified soil, in the loop, on sensors with
//! errors; and what it is told of the soil changes what it does.
#![allow(clippy::unwrap_used, reason = "a test may fail by panicking")]

mod control_support;
#[path = "support/counting.rs"]
mod counting;

use bekker::control::ControlError;
use bekker::model::{Model, Run};
use bekker::modeldescription::Lookup;
use bekker::simulation::Status;
use control_support::{Case, thesis_rover};

/// The two-wheeled rover on gentle ground of a soil that carries it, with `words` under `[control]`.
fn started(words: &str, parameters: &str) -> Run {
    let text = format!(
        "preset = 'gentle_rtc'\n[control]\n{words}\n[parameters]\nsoil.shear_modulus = 0.01\nrtc.integral_gain = 50.0\n{parameters}"
    );
    let mut run = Model::from_toml(&text, None).unwrap().start().unwrap();
    run.inputs_mut().set("velocity_command", 0.2).unwrap();
    run
}

/// Noise of an inclinometer, a gyroscope and encoders.
const NOISE: &str = "sensor.pitch_noise = 0.01\nsensor.pitch_rate_noise = 0.005\nsensor.wheel_speed_noise = 0.02\n";

#[test]
fn property_control_drives_on_estimated_contact_angles() {
    let mut run = started("contact_angles = 'estimator'", NOISE);
    run.advance(1000).unwrap();
    let (mut square, mut flat, mut count) = (0.0, 0.0, 0.0_f64);
    for _ in 0..800 {
        assert_eq!(run.advance(10).unwrap(), Status::Running);
        for (contact, wheel) in run.rtc().unwrap().problem().distribution.contacts.iter().zip(&run.signals().wheels) {
            square += (contact.sin.asin() - wheel.contact_angle).powi(2);
            flat += wheel.contact_angle.powi(2);
            count += 1.0;
        }
    }
    let (error, slopes) = ((square / count).sqrt(), (flat / count).sqrt());
    assert!(error < 0.6 * slopes, "an RMS error of {error} rad where level ground would be {slopes} rad off");
    assert!(error > 0.0, "the truth must not have come through");
    let speed = run.signals().body.x / run.time();
    assert!((speed - 0.2).abs() < 0.03, "{speed} m/s of 0.2 m/s");
}

#[test]
fn property_control_learns_the_soil_on_the_way() {
    // The data sheet is wrong by 8 degrees and half the cohesion.
    let words = "soil = 'estimator'\n[control.nominal_soil]\nfriction_angle = 0.366\ncohesion = 500.0";
    let mut run = started(words, "sensor.torque_noise = 0.01\nsensor.velocity_noise = 0.001\n");
    let truth = run.simulation().rover().soil;
    let strength = |run: &Run| {
        let soil = run.rtc().unwrap().nominal().soil;
        // What the wheels need to know: strength under the pressure of an even share of the weight.
        soil.cohesion + 10e3 * soil.friction_angle.tan()
    };
    let expected = truth.cohesion + 10e3 * truth.friction_angle.tan();
    run.advance(5).unwrap();
    let before = (strength(&run) / expected - 1.0).abs();
    assert_eq!(run.advance(10_000).unwrap(), Status::Running);
    let after = (strength(&run) / expected - 1.0).abs();
    // On gentle ground loads and slips hardly differ: one combination of c and phi is learned, not the pair.
    assert!(before > 0.25 && after < 0.6 * before, "off by {before} before, {after} after");
}

#[test]
fn property_estimators_in_the_loop_repeat() {
    let words = "contact_angles = 'estimator'\nsoil = 'estimator'";
    let (mut once, mut twice) = (started(words, NOISE), started(words, NOISE));
    once.advance(2000).unwrap();
    for _ in 0..40 {
        twice.advance(50).unwrap();
    }
    assert_eq!(once.signals(), twice.signals());
}

#[test]
fn property_estimated_contact_angles_allocate_nothing() {
    let mut run = started("contact_angles = 'estimator'\nsolver = 'active_set'", NOISE);
    run.advance(500).unwrap();
    assert_eq!(counting::allocations(|| assert!(run.advance(500).is_ok())), 0);
}

#[test]
fn regress_the_words_survive_a_file() {
    let text = "preset = 'gentle_rtc'\n[control]\ncontact_angles = 'estimator'\nsoil = 'estimator'\n";
    let mut model = Model::from_toml(text, None).unwrap();
    model.set("contact_angle_estimation.slip", 0.2).unwrap();
    model.set("soil_identification.forgetting", 0.5).unwrap();
    let again = Model::from_toml(&model.to_toml().unwrap(), None).unwrap();
    assert_eq!(again.control, model.control);
}

#[test]
fn property_an_estimated_soil_is_checked_and_used() {
    let mut case = Case::level(thesis_rover());
    case.goal = 0.3;
    let (mut rtc, strong) = case.run();
    let bad = rtc.set_soil(f64::NAN, 0.5, 0.01).unwrap_err();
    assert!(matches!(bad, ControlError::Parameter { group: "estimated soil", .. }), "{bad}");
    assert_eq!(rtc.nominal().soil, thesis_rover().soil, "a refused estimate changes nothing");
    rtc.set_soil(0.0, 0.1, 0.01).unwrap();
    let mut command = bekker::signals::Command::torque(Vec::new());
    bekker::control::Controller::command(&mut rtc, &case.measurement(), &case.reference(), &mut command).unwrap();
    // Weak soil without cohesion: every wheel at r N tan phi, the sum r m g tan phi.
    let sum: f64 = command.values.iter().sum();
    assert!((sum - 0.1 * 98.1 * 0.1_f64.tan()).abs() < 1e-6, "{sum} N m");
    assert!(strong.iter().sum::<f64>() > 2.0 * sum);
}
