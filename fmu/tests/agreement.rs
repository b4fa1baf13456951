//! The FMU computes what the core computes, to the last bit.
#![allow(clippy::unwrap_used)]

mod host;

use bekker::model::Model;
#[cfg(feature = "rigid")]
use bekker::{model::Plant, obstacle::Obstacle};
use bekker_fmu::fmi3::*;
use bekker_modeldescription::{Lookup, Parameters};
use host::{Fmu, INNER, get, messages, model, set, step};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::ptr::null_mut;

/// Wheel torques that drive the rover forward: up to 0.3 of weight times radius, under what spins a wheel, N m.
fn torques(random: &mut ChaCha8Rng, model: &Model) -> Vec<f64> {
    let rover = &model.rover;
    let wheels = rover.wheels.len();
    let weight = rover.total_mass() * rover.environment.gravity / wheels as f64;
    (0..wheels).map(|_| random.random_range(0.0..0.3) * weight * rover.wheel.radius).collect()
}

fn bits(values: &[f64]) -> Vec<u64> {
    values.iter().map(|value| value.to_bits()).collect()
}

/// References of all inputs and of all signals.
fn references(fmu: &Fmu, model: &Model) -> (Vec<u32>, Vec<u32>) {
    let names = |list: Vec<(bekker_modeldescription::Variable, f64)>| -> Vec<u32> {
        list.iter().map(|(variable, _)| fmu.reference(&variable.name)).collect()
    };
    (names(model.inputs().list()), names(model.start().unwrap().signals().clone().list()))
}

#[test]
fn agreement_of_the_fmu_with_the_core() {
    let mut random = ChaCha8Rng::seed_from_u64(2);
    for preset in ["two_wheeled", "rocker_bogie"] {
        let mut model = model(preset);
        let fmu = Fmu::new(&model);
        let (inputs, signals) = references(&fmu, &model);
        let instance = fmu.instantiate();
        for (name, factor) in [("soil.cohesion", 0.7), ("soil.k_phi", 1.2), ("wheel.radius", 0.95)] {
            let value = factor * model.get(name).unwrap();
            model.set(name, value).unwrap();
            assert_eq!(set(instance, &[fmu.reference(name)], &[value]), Status::Ok, "{:?}", messages());
        }
        assert_eq!(fmi3EnterInitializationMode(instance, 0, 0.0, 0.0, 0, 0.0), Status::Ok);
        assert_eq!(fmi3ExitInitializationMode(instance), Status::Ok, "{:?}", messages());
        let mut run = model.start().unwrap();
        let mut fastest = 0.0_f64;
        for k in 0..100 {
            let values = torques(&mut random, &model);
            assert_eq!(set(instance, &inputs, &values), Status::Ok, "{:?}", messages());
            run.inputs_mut().set_all(&values).unwrap();
            let stepped = step(instance, f64::from(k) * 10.0 * INNER, 10.0 * INNER);
            assert_eq!((stepped.status, stepped.terminate), (Status::Ok, false), "{:?}", messages());
            run.advance(10).unwrap();
            let mut expected = Vec::new();
            run.signals().values(&mut |value| expected.push(value));
            assert_eq!(bits(&get(instance, &signals).unwrap()), bits(&expected), "{preset}, step {k}");
            fastest = fastest.max(run.signals().body.velocity.abs());
        }
        assert!(fastest > 1e-3, "{preset}: the rover has moved, at most at {fastest} m/s");
        fmi3FreeInstance(instance);
    }
}

#[cfg(feature = "rigid")]
#[test]
fn agreement_of_rigid_bodies_on_a_rock() {
    let mut model = model("rocker_bogie_speed");
    model.stepping.plant = Plant::RigidBodies;
    model.obstacles.push(Obstacle::rock(0.35, 0.06, 0.16));
    let fmu = Fmu::new(&model);
    let (inputs, signals) = references(&fmu, &model);
    let instance = fmu.instantiate();
    model.set("obstacle[1].height", 0.05).unwrap();
    assert_eq!(set(instance, &[fmu.reference("obstacle[1].height")], &[0.05]), Status::Ok, "{:?}", messages());
    assert_eq!(fmi3EnterInitializationMode(instance, 0, 0.0, 0.0, 0, 0.0), Status::Ok);
    assert_eq!(fmi3ExitInitializationMode(instance), Status::Ok, "{:?}", messages());
    assert_eq!(set(instance, &inputs, &[1.5; 3]), Status::Ok, "{:?}", messages());
    let mut run = model.start().unwrap();
    run.inputs_mut().set_all(&[1.5; 3]).unwrap();
    let mut steepest: f64 = 0.0;
    for k in 0..300 {
        let stepped = step(instance, f64::from(k) * 10.0 * INNER, 10.0 * INNER);
        assert_eq!((stepped.status, stepped.terminate), (Status::Ok, false), "{:?}", messages());
        run.advance(10).unwrap();
        let mut expected = Vec::new();
        run.signals().values(&mut |value| expected.push(value));
        assert_eq!(bits(&get(instance, &signals).unwrap()), bits(&expected), "step {k}");
        steepest = run.signals().wheels.iter().fold(steepest, |most, wheel| most.max(wheel.contact_angle));
    }
    assert!(steepest > 0.5, "a wheel has climbed the rock: {steepest} rad");
    fmi3FreeInstance(instance);
}

#[test]
fn agreement_of_effects_of_the_users_own() {
    let mut model = model("two_wheeled");
    model.add_effects(include_str!("../../examples/own_effects.toml")).unwrap();
    model.set("softening.a", 0.2).unwrap();
    let fmu = Fmu::new(&model);
    let stiffness = &fmu.description.entries[fmu.reference("cable.k") as usize];
    assert_eq!((stiffness.variable.unit.symbol, stiffness.start), ("N/m", 0.0));
    let (inputs, signals) = references(&fmu, &model);
    let instance = fmu.instantiate();
    for (name, value) in [("cable.k", 5.0), ("stribeck.torque", 0.1)] {
        model.set(name, value).unwrap();
        assert_eq!(set(instance, &[fmu.reference(name)], &[value]), Status::Ok, "{:?}", messages());
    }
    assert_ne!(set(instance, &[fmu.reference("cable.k")], &[11.0]), Status::Ok, "beyond its bounds");
    assert_eq!(fmi3EnterInitializationMode(instance, 0, 0.0, 0.0, 0, 0.0), Status::Ok, "{:?}", messages());
    assert_eq!(fmi3ExitInitializationMode(instance), Status::Ok, "{:?}", messages());
    let mut run = model.start().unwrap();
    assert_eq!(set(instance, &inputs, &[1.5; 2]), Status::Ok, "{:?}", messages());
    run.inputs_mut().set_all(&[1.5; 2]).unwrap();
    let stepped = step(instance, 0.0, 100.0 * INNER);
    assert_eq!((stepped.status, stepped.terminate), (Status::Ok, false), "{:?}", messages());
    run.advance(100).unwrap();
    let mut expected = Vec::new();
    run.signals().values(&mut |value| expected.push(value));
    assert_eq!(bits(&get(instance, &signals).unwrap()), bits(&expected));
    fmi3FreeInstance(instance);
}

#[test]
fn agreement_of_a_restored_state_with_the_first_time() {
    let fmu = Fmu::preset("two_wheeled");
    let model = model("two_wheeled");
    let (inputs, signals) = references(&fmu, &model);
    let instance = fmu.running();
    let mut state = null_mut();
    let drive = |from: i32, seed: u64| {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        for k in from..from + 30 {
            assert_eq!(set(instance, &inputs, &torques(&mut random, &model)), Status::Ok);
            assert_eq!(step(instance, f64::from(k) * 0.02, 0.02).status, Status::Ok, "{:?}", messages());
        }
        bits(&get(instance, &signals).unwrap())
    };
    drive(0, 1);
    // SAFETY: a valid place.
    unsafe { assert_eq!(fmi3GetFMUState(instance, &mut state), Status::Ok) };
    let first = drive(30, 2);
    assert_eq!(fmi3SetFMUState(instance, state), Status::Ok);
    let other = drive(30, 3);
    assert_eq!(fmi3SetFMUState(instance, state), Status::Ok);
    let second = drive(30, 2);
    assert_eq!(first, second);
    assert_ne!(first, other, "other torques lead elsewhere");
    fmi3FreeInstance(instance);
}

#[test]
fn agreement_after_reset_with_a_new_instance() {
    let fmu = Fmu::preset("two_wheeled");
    let (inputs, signals) = references(&fmu, &model("two_wheeled"));
    let radius = fmu.reference("wheel.radius");
    let drive = |instance: Instance| {
        assert_eq!(fmi3EnterInitializationMode(instance, 0, 0.0, 0.0, 0, 0.0), Status::Ok);
        assert_eq!(fmi3ExitInitializationMode(instance), Status::Ok, "{:?}", messages());
        assert_eq!(set(instance, &inputs, &[1.0, 0.8]), Status::Ok);
        assert_eq!(step(instance, 0.0, 0.5).status, Status::Ok, "{:?}", messages());
        bits(&get(instance, &signals).unwrap())
    };
    let [used, new] = [fmu.instantiate(), fmu.instantiate()];
    assert_eq!(set(used, &[radius], &[0.12]), Status::Ok);
    let changed = drive(used);
    assert_eq!(fmi3Reset(used), Status::Ok);
    let (reset, fresh) = (drive(used), drive(new));
    assert_eq!(reset, fresh);
    assert_ne!(changed, fresh, "the radius matters");
    fmi3FreeInstance(used);
    fmi3FreeInstance(new);
}

/// Full torque backwards and forwards on the spot digs the rover in or turns its wheels in vain.
#[test]
fn property_an_end_event_terminates_without_an_error() {
    let mut model = model("two_wheeled");
    model.set("soil.cohesion", 0.0).unwrap();
    model.set("soil.friction_angle", 0.2).unwrap();
    let fmu = Fmu::new(&model);
    let (inputs, _) = references(&fmu, &model);
    let instance = fmu.running();
    assert_eq!(set(instance, &inputs, &[20.0, 20.0]), Status::Ok);
    let stepped = step(instance, 0.0, 60.0);
    assert_eq!((stepped.status, stepped.terminate), (Status::Ok, true), "{:?}", messages());
    assert!(stepped.time > 0.0 && stepped.time < 60.0, "{}", stepped.time);
    assert!(messages().iter().any(|line| line.contains("the simulation ends at")));
    let mut event = 0_i64;
    // SAFETY: one reference, one place.
    unsafe { assert_eq!(fmi3GetInt64(instance, &fmu.reference("event"), 1, &mut event, 1), Status::Ok) };
    assert_ne!(event, 0);
    assert_eq!(step(instance, stepped.time, INNER).status, Status::Error);
    assert!(messages().iter().any(|line| line.contains("the simulation has ended")));
    assert_eq!(fmi3Terminate(instance), Status::Ok);
    fmi3FreeInstance(instance);
}

#[test]
fn property_instances_in_threads_do_not_meet() {
    let fmu = Fmu::preset("two_wheeled");
    let (inputs, signals) = references(&fmu, &model("two_wheeled"));
    let drive = |torque: f64| {
        let instance = fmu.running();
        for k in 0..50 {
            assert_eq!(set(instance, &inputs, &[torque, torque]), Status::Ok);
            assert_eq!(step(instance, f64::from(k) * 0.01, 0.01).status, Status::Ok);
        }
        let values = bits(&get(instance, &signals).unwrap());
        fmi3FreeInstance(instance);
        values
    };
    let alone: Vec<_> = (1..=4).map(|k| drive(0.2 * f64::from(k))).collect();
    let together: Vec<_> = std::thread::scope(|scope| {
        let threads: Vec<_> = (1..=4).map(|k| scope.spawn(move || drive(0.2 * f64::from(k)))).collect();
        threads.into_iter().map(|thread| thread.join().unwrap()).collect()
    });
    assert_eq!(alone, together);
}
