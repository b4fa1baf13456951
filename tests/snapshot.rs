//! A run's state as bytes goes on to the same bits.
#![allow(clippy::unwrap_used, reason = "a test may fail by panicking")]

use bekker::model::{ControlKind, Model, Run};
use bekker::modeldescription::{Lookup, Parameters};
use bekker::simulation::Status;
use bekker::snapshot::{Fingerprint, FrameError, SnapshotError, close};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// Inner steps before and after the state is saved: 0.4 s each.
const STEPS: u64 = 200;

/// A model by its name, with parameters set.
fn model(preset: &str, kind: Option<ControlKind>, parameters: &[(&str, f64)], words: &str) -> Model {
    let text = format!("preset = \"{preset}\"\n{words}");
    let mut model = Model::from_toml(&text, None).unwrap();
    model.control.kind = kind.unwrap_or(model.control.kind);
    for (name, value) in parameters {
        model.set(name, *value).unwrap();
    }
    model
}

const NOISE: [(&str, f64); 5] = [
    ("sensor.pitch_noise", 0.01),
    ("sensor.velocity_noise", 0.01),
    ("sensor.wheel_speed_noise", 0.05),
    ("sensor.wheel_speed_resolution", 0.02),
    ("sensor.contact_angle_noise", 0.01),
];

/// Effects with every kind of memory that there is.
const MEMORIES: [(&str, f64); 9] = [
    ("multi_pass.growth", 0.3),
    ("sensor_lag.time_constant", 0.05),
    ("sensor_lag.dead_time", 0.033),
    ("tracking_delay.dead_time", 0.027),
    ("winding_heat.thermal_resistance", 10.0),
    ("winding_heat.time_constant", 2.0),
    ("suspension_friction.moment", 0.05),
    ("slip_sinkage.n1", 0.4),
    ("slip_sinkage.length", 0.05),
];

fn models() -> Vec<Model> {
    let estimators = "[control]\nkind = \"rtc\"\ncontact_angles = \"estimator\"\nsoil = \"estimator\"\n";
    let loops = [("rtc.speed_kp", 0.3), ("rtc.speed_ki", 2.0), ("rtc.integral_gain", 20.0)];
    let noisy =
        [NOISE.as_slice(), &[("sensor.torque_noise", 0.05), ("sensor.pitch_rate_noise", 0.01)], &loops].concat();
    let jointed = [NOISE[..3].to_vec(), vec![("sensor.link_angle_noise", 0.01), ("rtc.minimum_load", 0.2)]].concat();
    vec![
        model("two_wheeled", None, &[], ""),
        model("two_wheeled_speed", None, &[("multi_pass.growth", 0.3), ("sensor_lag.dead_time", 0.02)], ""),
        model("two_wheeled", Some(ControlKind::SpeedLoop), &NOISE[2..4], ""),
        model("gentle_velocity", None, &[("velocity_control.kd", 0.01)], ""),
        model("gentle_rtc", None, &NOISE, ""),
        model("gentle_rtc", None, &noisy, estimators),
        model("rocker_bogie", None, &MEMORIES, ""),
        model("rocker_bogie", Some(ControlKind::Rtc), &jointed, "[control]\nkind = \"rtc\"\nsolver = \"active_set\"\n"),
        model(
            "gentle_velocity",
            Some(ControlKind::Slip),
            &[("sensor.pitch_period", 0.03)],
            "[control]\nkind = \"slip\"\n",
        ),
        model("gentle_velocity", Some(ControlKind::EqualTorque), &[], "[control]\nkind = \"equal_torque\"\n"),
    ]
}

/// New inputs, of the size that each kind of them has.
fn steer(run: &mut Run, dice: &mut ChaCha8Rng) {
    let names: Vec<String> = run.inputs_mut().list().into_iter().map(|(variable, _)| variable.name).collect();
    for name in names {
        let [from, to] = match name.rsplit('.').next().unwrap() {
            "torque_command" => [-0.1, 0.8],
            "speed_command" => [-1.0, 4.0],
            _ => [-0.1, 0.4],
        };
        run.inputs_mut().set(&name, from + (to - from) * dice.random::<f64>()).unwrap();
    }
}

/// Drives `steps` inner steps in pieces of random length with random inputs.
fn drive(run: &mut Run, steps: u64, dice: &mut ChaCha8Rng) {
    let mut left = steps;
    while left > 0 {
        let some = dice.random_range(1..=left.min(37));
        steer(run, dice);
        run.advance(some).unwrap();
        left -= some;
    }
}

fn bits(run: &Run) -> Vec<u64> {
    let mut all = Vec::new();
    run.signals().values(&mut |value| all.push(value.to_bits()));
    all
}

#[test]
fn property_a_restored_run_goes_on_to_the_same_bits() {
    for (k, model) in models().into_iter().enumerate() {
        let mut dice = ChaCha8Rng::seed_from_u64(k as u64);
        let mut run = model.start().unwrap();
        let before = dice.random_range(STEPS / 2..STEPS);
        drive(&mut run, before, &mut dice);
        assert_eq!(run.status(), Status::Running, "model {k} ended before it was saved");
        let bytes = run.snapshot().unwrap();
        let mut fresh = model.start().unwrap();
        fresh.restore(&bytes).unwrap();
        assert_eq!(bits(&fresh), bits(&run), "model {k}: the signals on return");
        let mut same = dice.clone();
        drive(&mut run, STEPS, &mut dice);
        drive(&mut fresh, STEPS, &mut same);
        assert_eq!(bits(&fresh), bits(&run), "model {k}: the signals later on");
        assert_eq!(fresh.measurement(), run.measurement(), "model {k}: what control saw");
        assert_eq!(fresh.snapshot(), run.snapshot(), "model {k}: the state later on");
        assert_ne!(run.snapshot().unwrap(), bytes, "model {k} has not moved");
        // Back in the run that has gone on.
        run.restore(&bytes).unwrap();
        assert_eq!(run.snapshot().unwrap(), bytes);
    }
}

#[test]
fn property_a_state_survives_into_another_process() {
    let folder = std::env::temp_dir().join(format!("bekker-snapshot-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let mut runs = Vec::new();
    for (k, model) in models().into_iter().enumerate() {
        let file = folder.join(format!("{k}.toml"));
        std::fs::write(&file, model.to_toml().unwrap()).unwrap();
        let mut run = Model::read(&file).unwrap().start().unwrap();
        drive(&mut run, STEPS / 2, &mut ChaCha8Rng::seed_from_u64(k as u64));
        std::fs::write(folder.join(format!("{k}.state")), run.snapshot().unwrap()).unwrap();
        runs.push(run);
    }
    let child = std::process::Command::new(std::env::current_exe().unwrap())
        .args(["--exact", "the_other_process", "--ignored"])
        .env(FOLDER, &folder)
        .output()
        .unwrap();
    assert!(child.status.success(), "{}", String::from_utf8_lossy(&child.stdout));
    for (k, mut run) in runs.into_iter().enumerate() {
        drive(&mut run, STEPS, &mut ChaCha8Rng::seed_from_u64(100 + k as u64));
        let there = std::fs::read(folder.join(format!("{k}.later"))).unwrap();
        assert_eq!(run.snapshot().unwrap(), there, "model {k}");
    }
    std::fs::remove_dir_all(folder).unwrap();
}

const FOLDER: &str = "BEKKER_TEST_SNAPSHOTS";

#[test]
#[ignore = "runs in a child process"]
fn the_other_process() {
    let folder = std::path::PathBuf::from(std::env::var_os(FOLDER).unwrap());
    for k in 0..models().len() {
        let mut run = Model::read(&folder.join(format!("{k}.toml"))).unwrap().start().unwrap();
        run.restore(&std::fs::read(folder.join(format!("{k}.state"))).unwrap()).unwrap();
        drive(&mut run, STEPS, &mut ChaCha8Rng::seed_from_u64(100 + k as u64));
        std::fs::write(folder.join(format!("{k}.later")), run.snapshot().unwrap()).unwrap();
    }
}

#[test]
fn property_bytes_that_do_not_fit_are_refused_and_change_nothing() {
    let model = model("gentle_rtc", None, &NOISE, "");
    let mut run = model.start().unwrap();
    run.advance(100).unwrap();
    let bytes = run.snapshot().unwrap();
    run.advance(10).unwrap();
    let now = run.snapshot().unwrap();
    let mut refused = |bytes: &[u8]| {
        let error = run.restore(bytes).unwrap_err();
        assert_eq!(run.snapshot().unwrap(), now, "{error}: something has changed");
        error
    };
    for length in 0..bytes.len() {
        refused(&bytes[..length]);
    }
    assert!(matches!(refused(&[&bytes[..], &[0]].concat()), SnapshotError::Frame(FrameError::Size { .. })));
    for place in 0..bytes.len() {
        let mut damaged = bytes.clone();
        damaged[place] ^= 0x10;
        refused(&damaged);
    }
    let mut other = model.clone();
    other.set("soil.cohesion", 900.0).unwrap();
    let foreign = other.start().unwrap().snapshot().unwrap();
    assert_eq!(refused(&foreign), SnapshotError::Frame(FrameError::Model));
}

#[test]
fn property_bodies_that_lie_neither_panic_nor_take_memory() {
    let model = model("gentle_rtc", None, &NOISE, "[control]\nkind = \"rtc\"\ncontact_angles = \"estimator\"\n");
    let mut run = model.start().unwrap();
    run.advance(100).unwrap();
    let bytes = run.snapshot().unwrap();
    let head: [u8; 4] = bytes[..4].try_into().unwrap();
    let mut dice = ChaCha8Rng::seed_from_u64(1);
    let mut refused = 0;
    for _ in 0..2000 {
        // A frame that is right around a body that is wrong: a number of it is any number.
        let mut body = bytes[32..].to_vec();
        let place = dice.random_range(0..body.len() / 8) * 8;
        let wrong = if dice.random() { dice.random::<u64>() } else { u64::from(dice.random::<u8>()) };
        body[place..place + 8].copy_from_slice(&wrong.to_le_bytes());
        let framed = close(head, 1, Fingerprint::of(&model), &body);
        refused += u32::from(model.start().unwrap().restore(&framed).is_err());
    }
    // Lengths and codes are some hundredths of the numbers.
    assert!(refused > 20, "{refused}");
}

#[test]
#[cfg(feature = "rigid")]
fn property_rigid_bodies_say_that_they_cannot() {
    let model = model("two_wheeled", None, &[], "[simulation]\nplant = \"rigid_bodies\"\n");
    assert_eq!(model.start().unwrap().snapshot(), Err(SnapshotError::RigidBodies));
}
