//! The state of each kind of model as bytes.
#![allow(clippy::unwrap_used, reason = "a test may fail by panicking")]

mod core_support;

use bekker::model::Model as RoverModel;
use bekker::modeldescription::Lookup;
use bekker_fmu::Kind;
use bekker_fmu::model::FmuModel;
use bekker_modeldescription::xml::{Causality, Entry, Kind as Type, Variability};
use core_support::{all, bits, get, loaded, set};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// A model, its kind, and parameters that are set before the start.
type Case = (RoverModel, Kind, Vec<(&'static str, f64)>);

fn models() -> Vec<Case> {
    let preset = |name| RoverModel::preset(name).unwrap();
    let estimators =
        "preset = \"gentle_rtc\"\n[control]\nkind = \"rtc\"\ncontact_angles = \"estimator\"\nsoil = \"estimator\"\n";
    let mut noisy = RoverModel::from_toml(estimators, None).unwrap();
    noisy.set("sensor.pitch_noise", 0.005).unwrap();
    noisy.set("sensor.wheel_speed_noise", 0.05).unwrap();
    vec![
        (preset("two_wheeled"), Kind::RoverWithController, vec![("soil.cohesion", 1200.0)]),
        (preset("rocker_bogie"), Kind::Rover, vec![("sensor_lag.dead_time", 0.013), ("sensor.velocity_noise", 0.01)]),
        (noisy.clone(), Kind::RoverWithController, vec![("wheel.radius", 0.105)]),
        (noisy, Kind::Controller, vec![("mode", 1.0), ("rtc.integral_gain", 5.0)]),
        (preset("gentle_velocity"), Kind::Controller, vec![("velocity_control.ki", 15.0)]),
    ]
}

/// Inputs of the size that each of them has.
fn steer(model: &mut dyn FmuModel, dice: &mut ChaCha8Rng) {
    for input in all(model, Causality::Input) {
        let name = model.description().entries[input].variable.name.clone();
        let value = match name.rsplit('.').next().unwrap() {
            "torque_command" => dice.random_range(0.0..0.3),
            "velocity_command" | "velocity" => dice.random_range(0.1..0.3),
            "speed" => dice.random_range(1.0..3.0),
            _ => dice.random_range(-0.05..0.05),
        };
        model.set(input, value);
    }
}

/// Goes on over some points, on whole steps and between.
fn drive(model: &mut dyn FmuModel, points: usize, dice: &mut ChaCha8Rng) {
    for _ in 0..points {
        steer(model, dice);
        let time = model.elapsed() + dice.random_range(0.3..4.0) * model.inner_step();
        model.advance_to(time).unwrap();
    }
}

#[test]
fn property_a_state_goes_on_to_the_same_bits_in_a_fresh_instance() {
    for (k, (model, kind, parameters)) in models().into_iter().enumerate() {
        let mut dice = ChaCha8Rng::seed_from_u64(k as u64);
        let mut first = loaded(&model, kind);
        for (name, value) in parameters {
            set(&mut *first, name, value);
        }
        first.start().unwrap();
        drive(&mut *first, 60, &mut dice);
        let bytes = first.serialise().unwrap();
        let mut second = loaded(&model, kind);
        second.deserialise(&bytes).unwrap();
        assert_eq!(bits(&*second), bits(&*first), "model {k}");
        assert_eq!(second.elapsed(), first.elapsed());
        let (mut dice, mut same) = (ChaCha8Rng::seed_from_u64(99), ChaCha8Rng::seed_from_u64(99));
        drive(&mut *first, 60, &mut dice);
        drive(&mut *second, 60, &mut same);
        assert_eq!(bits(&*second), bits(&*first), "model {k}: later on");
        assert_eq!(second.serialise().unwrap(), first.serialise().unwrap(), "model {k}: later on");
        assert_ne!(first.serialise().unwrap(), bytes);
        // A fixed parameter that has been set without a start is a value, and not yet the run's; a tunable one acts.
        for variability in [Variability::Fixed, Variability::Tunable] {
            let mut parameters = first.description().entries.iter().filter(|e| e.causality == Causality::Parameter);
            let some =
                |entry: &&Entry| entry.variability == variability && entry.kind == Type::Real && entry.start > 0.0;
            let name = parameters.find(some).unwrap().variable.name.clone();
            let value = get(&*first, &name) * 0.99;
            set(&mut *first, &name, value);
            second.deserialise(&first.serialise().unwrap()).unwrap();
            assert_eq!(get(&*second, &name), value);
            drive(&mut *first, 5, &mut dice);
            drive(&mut *second, 5, &mut same);
            let mut third = loaded(&model, kind);
            third.deserialise(&first.serialise().unwrap()).unwrap();
            drive(&mut *third, 5, &mut ChaCha8Rng::seed_from_u64(7));
            drive(&mut *first, 5, &mut ChaCha8Rng::seed_from_u64(7));
            drive(&mut *second, 5, &mut ChaCha8Rng::seed_from_u64(7));
            assert_eq!(bits(&*second), bits(&*first), "model {k}: `{name}` on the way");
            assert_eq!(bits(&*third), bits(&*first), "model {k}: `{name}` from before");
        }
    }
}

#[test]
fn property_other_bytes_are_refused_and_change_nothing() {
    let mut all = models();
    let (other, kind, _) = all.remove(1);
    let mut foreign = loaded(&other, kind);
    foreign.start().unwrap();
    for (model, kind, _) in all {
        let mut fmu = loaded(&model, kind);
        fmu.start().unwrap();
        fmu.advance_to(10.0 * fmu.inner_step()).unwrap();
        let bytes = fmu.serialise().unwrap();
        fmu.advance_to(20.0 * fmu.inner_step()).unwrap();
        let now = fmu.serialise().unwrap();
        let mut damaged = bytes.clone();
        *damaged.last_mut().unwrap() ^= 1;
        let wrong: [&[u8]; 5] = [&[], &bytes[..bytes.len() - 1], &bytes[..20], &damaged, &foreign.serialise().unwrap()];
        for bytes in wrong {
            let failure = fmu.deserialise(bytes).unwrap_err();
            assert!(failure.0.contains("saved state"), "{failure}");
            assert_eq!(fmu.serialise().unwrap(), now, "{failure}");
        }
        fmu.deserialise(&bytes).unwrap();
        assert_eq!(fmu.serialise().unwrap(), bytes);
    }
}
