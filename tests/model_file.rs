//! Models: files in and out, and wheel speeds held by loops within the drives' limits.

use bekker::model::{ControlKind, Model, Run};
use bekker::modeldescription::Lookup;

fn started(kind: ControlKind, inverse_limit: f64) -> Run {
    let mut model = Model::preset("two_wheeled").expect("a preset");
    model.control.kind = kind;
    model.rover.soil.shear_modulus = 0.01;
    model.rover.motor.inverse_torque_limit = inverse_limit;
    let mut run = model.start().expect("starts");
    run.inputs_mut().set("wheel[1].speed_command", 2.0).expect("an input");
    run.inputs_mut().set("wheel[2].speed_command", 2.5).expect("an input");
    run.advance(2000).expect("advances");
    run
}

#[test]
fn property_the_loop_reaches_each_wheels_own_speed() {
    let run = started(ControlKind::SpeedLoop, 0.0);
    let speeds: Vec<f64> = run.signals().wheels.iter().map(|wheel| wheel.speed).collect();
    // After 4 s, eight settling times of the default gains.
    assert!((speeds[0] - 2.0).abs() < 1e-3 && (speeds[1] - 2.5).abs() < 1e-3, "{speeds:?}");
}

#[test]
fn property_a_limited_drive_falls_short_where_an_imposed_speed_does_not() {
    let limited = started(ControlKind::SpeedLoop, 1.0 / 0.5);
    assert!(limited.signals().wheels.iter().all(|wheel| wheel.speed < 1.0 && wheel.torque.abs() <= 0.5 + 1e-12));
    let imposed = started(ControlKind::Speed, 1.0 / 0.5);
    assert_eq!(imposed.signals().wheels[1].speed, 2.5);
}

#[test]
fn property_a_model_survives_its_own_toml() {
    let mut model = Model::preset("rocker_bogie_velocity").expect("a preset");
    model.control.kind = ControlKind::SpeedLoop;
    model.set("soil.cohesion", 123.456_789_012_345).expect("in range");
    let text = model.to_toml().expect("writable");
    let mut again = Model::from_toml(&text, None).expect("readable");
    assert_eq!(again.list(), model.list());
    assert_eq!(again.to_toml().expect("writable"), text);
}

#[test]
fn property_bad_model_files_say_what_and_what_was_expected() {
    let message = |text: &str| Model::from_toml(text, None).expect_err("refused").to_string();
    for (text, words) in [
        ("[parameters]\n\"soil.cohesio\" = 1.0", vec!["soil.cohesio", "soil.cohesion"]),
        ("[parameters]\nsoil.cohesion = -1.0", vec!["soil.cohesion", "-1", "0 .. 50000 Pa"]),
        ("[parameters]\nsoil.cohesion = nan", vec!["soil.cohesion", "NaN"]),
        ("[parameters]\nsoil.cohesion = 'soft'", vec!["soil.cohesion", "number", "string"]),
        ("preset = 'rover9'", vec!["rover9", "two_wheeled"]),
        ("colour = 'red'", vec!["colour", "line 1"]),
        ("[vehicle]\nwheels = [0]", vec!["2 to 8 wheels", "1"]),
        ("[vehicle]\nwheels = [0, 3]", vec!["wheel 2", "body 3"]),
        ("[vehicle]\nwheels = [0, 1]\nlinks = [1]", vec!["link 1", "body 1"]),
        ("[control]\nkind = 'magic'", vec!["magic", "rtc"]),
        ("[simulation]\nstep_size = 0.5", vec!["simulation.step_size", "0.5", "0.02"]),
        ("[terrain]\nfile = 'no_such.csv'", vec!["no_such.csv"]),
    ] {
        let message = message(text);
        for word in words {
            assert!(message.contains(word), "`{text}` gives `{message}`, without `{word}`");
        }
    }
}
