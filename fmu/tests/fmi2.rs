//! FMI 2.0 does what FMI 3.0 does, and what only FMI 2.0 has.
#![allow(clippy::unwrap_used, reason = "a test may fail by panicking")]

mod host;

use bekker_fmu::fmi2::*;
use bekker_modeldescription::{Lookup, Parameters};
use host::{Fmu, INNER, messages, model};
use std::ptr::null_mut;

fn get2(instance: Instance, references: &[u32]) -> Vec<f64> {
    let mut values = vec![f64::NAN; references.len()];
    // SAFETY: as many places as references.
    let status = unsafe { fmi2GetReal(instance, references.as_ptr(), references.len(), values.as_mut_ptr()) };
    assert_eq!(status, Status::Ok, "{:?}", messages());
    values
}

fn set2(instance: Instance, references: &[u32], values: &[f64]) -> Status {
    assert_eq!(references.len(), values.len());
    // SAFETY: as many values as references.
    unsafe { fmi2SetReal(instance, references.as_ptr(), references.len(), values.as_ptr()) }
}

fn bits(values: &[f64]) -> Vec<u64> {
    values.iter().map(|value| value.to_bits()).collect()
}

#[test]
fn agreement_of_fmi2_with_fmi3_and_the_core() {
    for preset in ["two_wheeled", "rocker_bogie"] {
        let model = model(preset);
        let fmu = Fmu::new(&model);
        let inputs: Vec<u32> = model.inputs().list().iter().map(|(v, _)| fmu.reference(&v.name)).collect();
        let mut run = model.start().unwrap();
        let signals: Vec<u32> = run.signals().clone().list().iter().map(|(v, _)| fmu.reference(&v.name)).collect();
        let (old, new) = (fmu.running2(), fmu.running());
        let rover = &model.rover;
        let load = rover.total_mass() * rover.environment.gravity / inputs.len() as f64;
        for k in 0..100 {
            let torques = vec![(0.2 + 0.001 * f64::from(k)) * load * rover.wheel.radius; inputs.len()];
            assert_eq!(set2(old, &inputs, &torques), Status::Ok, "{:?}", messages());
            assert_eq!(host::set(new, &inputs, &torques), Status::Ok);
            run.inputs_mut().set_all(&torques).unwrap();
            let time = f64::from(k) * 10.0 * INNER;
            assert_eq!(fmi2DoStep(old, time, 10.0 * INNER, 1), Status::Ok, "{:?}", messages());
            assert_eq!(host::step(new, time, 10.0 * INNER).status, Status::Ok);
            run.advance(10).unwrap();
            let mut expected = Vec::new();
            run.signals().values(&mut |value| expected.push(value));
            assert_eq!(bits(&get2(old, &signals)), bits(&expected), "{preset}, step {k}");
            assert_eq!(bits(&host::get(new, &signals).unwrap()), bits(&expected), "{preset}, step {k}");
        }
        assert!(run.signals().body.velocity.abs() > 1e-3, "{preset}: the rover has moved");
        fmi2FreeInstance(old);
        bekker_fmu::fmi3::fmi3FreeInstance(new);
    }
}

#[test]
fn property_the_status_functions_tell_how_a_simulation_ended() {
    let mut model = model("two_wheeled");
    model.set("soil.cohesion", 0.0).unwrap();
    model.set("soil.friction_angle", 0.2).unwrap();
    let fmu = Fmu::new(&model);
    let inputs: Vec<u32> = model.inputs().list().iter().map(|(v, _)| fmu.reference(&v.name)).collect();
    let instance = fmu.running2();
    let (mut status, mut time, mut ended) = (Status::Fatal, f64::NAN, 7);
    // SAFETY: one place for each answer.
    let mut ask = || unsafe {
        assert_eq!(fmi2GetStatus(instance, 0, &mut status), Status::Ok);
        assert_eq!(fmi2GetRealStatus(instance, 2, &mut time), Status::Ok);
        assert_eq!(fmi2GetBooleanStatus(instance, 3, &mut ended), Status::Ok);
        (status, time, ended)
    };
    assert_eq!(fmi2DoStep(instance, 0.0, INNER, 1), Status::Ok);
    assert_eq!(ask(), (Status::Ok, INNER, 0));
    assert_eq!(set2(instance, &inputs, &[20.0, 20.0]), Status::Ok);
    assert_eq!(fmi2DoStep(instance, INNER, 60.0, 1), Status::Discard, "{:?}", messages());
    let (status, time, ended) = ask();
    assert_eq!((status, ended), (Status::Discard, 1));
    assert!(time > INNER && time < 60.0, "{time}");
    assert!(messages().iter().any(|line| line.contains("the simulation ends at")));
    assert_eq!(fmi2DoStep(instance, time, INNER, 1), Status::Error);
    assert_eq!(fmi2Reset(instance), Status::Ok);
    fmi2FreeInstance(instance);
}

#[test]
fn property_inputs_follow_their_derivatives_to_the_same_end() {
    let fmu = Fmu::preset("two_wheeled");
    let inputs = ["wheel[1].torque_command", "wheel[2].torque_command"].map(|name| fmu.reference(name));
    let x = [fmu.reference("x")];
    // A ramp in ten communication steps with derivatives, in a hundred of one inner step with the middles, and held.
    let drive = |size: f64, count: i32, interpolated: bool, middle: f64| {
        let instance = fmu.running2();
        for k in 0..count {
            let time = f64::from(k) * size;
            let torque = 20.0 * (time + middle * size);
            assert_eq!(set2(instance, &inputs, &[torque; 2]), Status::Ok, "{:?}", messages());
            if interpolated {
                // SAFETY: two references, orders and values.
                let status = unsafe {
                    fmi2SetRealInputDerivatives(instance, inputs.as_ptr(), 2, [1, 1].as_ptr(), [20.0; 2].as_ptr())
                };
                assert_eq!(status, Status::Ok, "{:?}", messages());
            }
            assert_eq!(fmi2DoStep(instance, time, size, 1), Status::Ok, "{:?}", messages());
        }
        let found = get2(instance, &x)[0];
        fmi2FreeInstance(instance);
        found
    };
    let (coarse, fine, held) = (drive(0.01, 10, true, 0.0), drive(INNER, 100, false, 0.5), drive(0.01, 10, false, 0.0));
    // The same torques but for the rounding of their computation.
    assert!((coarse - fine).abs() < 1e-12, "{coarse} {fine}");
    assert!((held - fine).abs() > 1e-6, "{held} {fine}");
}

#[test]
fn property_output_derivatives_are_rates() {
    let fmu = Fmu::preset("two_wheeled");
    let inputs = ["wheel[1].torque_command", "wheel[2].torque_command"].map(|name| fmu.reference(name));
    let instance = fmu.running2();
    assert_eq!(set2(instance, &inputs, &[1.8; 2]), Status::Ok);
    assert_eq!(fmi2DoStep(instance, 0.0, 0.5, 1), Status::Ok);
    let (x, velocity) = (fmu.reference("x"), fmu.reference("velocity"));
    let mut rate = f64::NAN;
    // SAFETY: one reference, one order, one place.
    let status = unsafe { fmi2GetRealOutputDerivatives(instance, &x, 1, &1, &mut rate) };
    assert_eq!(status, Status::Ok, "{:?}", messages());
    let speed = get2(instance, &[velocity])[0];
    // The velocity changes by its acceleration times the inner step within the step: under 1 m/s2 here.
    assert!((rate - speed).abs() < INNER && speed > 0.01, "{rate} {speed}");
    fmi2FreeInstance(instance);
}

#[test]
fn property_a_second_instance_and_reset_start_afresh() {
    let fmu = Fmu::preset("two_wheeled");
    let inputs = ["wheel[1].torque_command", "wheel[2].torque_command"].map(|name| fmu.reference(name));
    let x = [fmu.reference("x"), fmu.reference("velocity")];
    let drive = |instance: Instance| {
        assert_eq!(set2(instance, &inputs, &[1.5; 2]), Status::Ok);
        assert_eq!(fmi2DoStep(instance, 0.0, 0.3, 1), Status::Ok, "{:?}", messages());
        bits(&get2(instance, &x))
    };
    let [one, two] = [fmu.running2(), fmu.running2()];
    let first = drive(one);
    assert_eq!(drive(two), first);
    assert_eq!(fmi2Reset(one), Status::Ok);
    assert_eq!(fmi2EnterInitializationMode(one), Status::Ok);
    assert_eq!(fmi2ExitInitializationMode(one), Status::Ok);
    assert_eq!(drive(one), first);
    fmi2FreeInstance(one);
    fmi2FreeInstance(two);
}

#[test]
fn property_a_percent_sign_reaches_the_log() {
    let fmu = Fmu::preset("two_wheeled");
    let instance = fmu.instantiate2();
    messages();
    // SAFETY: one text.
    let status = unsafe { fmi2SetDebugLogging(instance, 1, 1, &c"100 %s #r1#".as_ptr()) };
    assert_eq!(status, Status::Error);
    let log = messages();
    assert!(log[0].contains("100 %%s ##r1##"), "as a format of printf it is the text: {log:?}");
    // SAFETY: as above.
    let status = unsafe { fmi2SetDebugLogging(instance, 1, 1, &c"logAll".as_ptr()) };
    assert_eq!(status, Status::Ok);
    fmi2FreeInstance(instance);
    fmi2FreeInstance(null_mut());
}
