//! Model exchange and states as bytes through both C borders.
#![allow(clippy::unwrap_used, reason = "a test may fail by panicking")]

mod host;

use bekker::modeldescription::Lookup;
use bekker_fmu::Kind;
use bekker_fmu::fmi2::*;
use bekker_fmu::fmi3::*;
use host::{Fmu, INNER, callbacks, messages, model};
use std::ptr::null_mut;

/// Step of Euler's method and how many of them, s: half a second, fine enough for the stiff contact.
const STEP: f64 = 1e-4;
const STEPS: u32 = 5000;
/// Torque that drives the preset `two_wheeled` forward, N m.
const TORQUE: [f64; 2] = [1.8, 1.8];

fn torques(fmu: &Fmu) -> [u32; 2] {
    ["wheel[1].torque_command", "wheel[2].torque_command"].map(|name| fmu.reference(name))
}

fn ok(status: Status) {
    assert_eq!(status, Status::Ok, "{:?}", messages());
}

fn exchange2(fmu: &Fmu) -> Instance {
    let uri = std::ffi::CString::new(format!("file://{}", fmu.folder().display())).unwrap();
    // SAFETY: texts and callbacks that live through the call; two references and values.
    unsafe {
        let instance = fmi2Instantiate(c"a".as_ptr(), 0, fmu.token().as_ptr(), uri.as_ptr(), &callbacks(), 0, 1);
        assert!(!instance.is_null(), "{:?}", messages());
        ok(fmi2SetupExperiment(instance, 0, 0.0, 0.0, 0, 0.0));
        ok(fmi2EnterInitializationMode(instance));
        ok(fmi2ExitInitializationMode(instance));
        let mut event = EventInfo { new_discrete_states_needed: 1, ..EventInfo::default() };
        ok(fmi2NewDiscreteStates(instance, &mut event));
        assert_eq!((event.new_discrete_states_needed, event.terminate_simulation), (0, 0));
        ok(fmi2EnterContinuousTimeMode(instance));
        ok(fmi2SetReal(instance, torques(fmu).as_ptr(), 2, TORQUE.as_ptr()));
        instance
    }
}

fn exchange3(fmu: &Fmu) -> Instance {
    // SAFETY: as above.
    unsafe {
        let (token, path) = (fmu.token(), fmu.resources());
        let name = c"a".as_ptr();
        let instance =
            fmi3InstantiateModelExchange(name, token.as_ptr(), path.as_ptr(), 0, 1, null_mut(), Some(host::log));
        assert!(!instance.is_null(), "{:?}", messages());
        ok(fmi3EnterInitializationMode(instance, 0, 0.0, 0.0, 0, 0.0));
        ok(fmi3ExitInitializationMode(instance));
        let (mut flags, mut time) = ([true; 5], 0.0);
        let [a, b, c, d, e] = flags.each_mut();
        ok(fmi3UpdateDiscreteStates(instance, a, b, c, d, e, &mut time));
        assert_eq!(flags[..2], [false, false]);
        ok(fmi3EnterContinuousTimeMode(instance));
        ok(host::set(instance, &torques(fmu), &TORQUE));
        instance
    }
}

#[test]
fn agreement_of_model_exchange_in_both_versions_and_with_cosimulation() {
    let mut unlimited = model("two_wheeled");
    unlimited.set("motor.inverse_voltage", 0.0).unwrap(); // a limit that begins to bind is an event
    let fmu = Fmu::of_kind(&unlimited, Kind::Rover);
    let (old, new, steps) = (exchange2(&fmu), exchange3(&fmu), fmu.running());
    let (mut states, mut indicators) = (0, 0);
    // SAFETY: one place each; then as many places as there are states and indicators.
    unsafe {
        ok(fmi3GetNumberOfContinuousStates(new, &mut states));
        ok(fmi3GetNumberOfEventIndicators(new, &mut indicators));
        let [mut x, mut y, mut dx, mut dy] = [0.0; 4].map(|value| vec![value; states]);
        let [mut z, mut w] = [0.0; 2].map(|value| vec![value; indicators]);
        for k in 0..STEPS {
            ok(fmi2GetContinuousStates(old, x.as_mut_ptr(), states));
            ok(fmi3GetContinuousStates(new, y.as_mut_ptr(), states));
            ok(fmi2GetDerivatives(old, dx.as_mut_ptr(), states));
            ok(fmi3GetContinuousStateDerivatives(new, dy.as_mut_ptr(), states));
            assert_eq!((&x, &dx), (&y, &dy), "step {k}");
            x.iter_mut().zip(&dx).for_each(|(x, dx)| *x += STEP * dx);
            let time = f64::from(k + 1) * STEP;
            ok(fmi2SetTime(old, time));
            ok(fmi3SetTime(new, time));
            ok(fmi2SetContinuousStates(old, x.as_ptr(), states));
            ok(fmi3SetContinuousStates(new, x.as_ptr(), states));
            ok(fmi2GetEventIndicators(old, z.as_mut_ptr(), indicators));
            ok(fmi3GetEventIndicators(new, w.as_mut_ptr(), indicators));
            assert!(z == w && z.iter().all(|indicator| *indicator > 0.0), "no event on the way: {z:?}");
            let ((mut a, mut b), (mut c, mut d)) = ((1, 1), (true, true));
            ok(fmi2CompletedIntegratorStep(old, 1, &mut a, &mut b));
            ok(fmi3CompletedIntegratorStep(new, 1, &mut c, &mut d));
            assert_eq!((a, b, c, d), (0, 0, false, false));
        }
        let signals = ["x", "velocity", "pitch", "wheel[1].slip"].map(|name| fmu.reference(name));
        let mut values = [0.0; 4];
        ok(fmi2GetReal(old, signals.as_ptr(), 4, values.as_mut_ptr()));
        assert_eq!(host::get(new, &signals).unwrap(), values);
        // An indicator is a variable too, after those of the description.
        let first = fmu.description.entries.len() as u32;
        assert_eq!(host::get(new, &[first]).unwrap(), [w[0]]);
        ok(host::set(steps, &torques(&fmu), &TORQUE));
        ok(host::step(steps, 0.0, STEP * f64::from(STEPS)).status);
        let inside = host::get(steps, &signals).unwrap();
        assert!(inside[0] > 0.01, "{inside:?}");
        // Euler's error of order one over 0.1 ms against the inner method's of order two over 1 ms.
        for (value, inside) in values.iter().zip(&inside) {
            assert!((value - inside).abs() < 2e-3 * inside.abs().max(0.1), "{values:?} {inside:?}");
        }
        fmi2FreeInstance(old);
    }
    fmi3FreeInstance(new);
    fmi3FreeInstance(steps);
}

#[test]
fn property_effects_with_a_memory_are_refused_by_name() {
    let fmu = Fmu::of_kind(&model("two_wheeled"), Kind::Rover);
    // SAFETY: valid texts; one reference and value.
    unsafe {
        let (token, path) = (fmu.token(), fmu.resources());
        let (token, path) = (token.as_ptr(), path.as_ptr());
        let instance = fmi3InstantiateModelExchange(c"a".as_ptr(), token, path, 0, 1, null_mut(), Some(host::log));
        ok(host::set(instance, &[fmu.reference("multi_pass.growth")], &[0.2]));
        ok(fmi3EnterInitializationMode(instance, 0, 0.0, 0.0, 0, 0.0));
        messages();
        assert_eq!(fmi3ExitInitializationMode(instance), Status::Error);
        let log = messages();
        assert!(log.iter().any(|line| line.contains("multi_pass.growth")), "{log:?}");
        fmi3FreeInstance(instance);
    }
}

#[test]
fn agreement_of_a_state_that_went_through_bytes() {
    let fmu = Fmu::preset("two_wheeled");
    let signals = ["x", "velocity", "dissipated_energy", "wheel[2].sinkage"].map(|name| fmu.reference(name));
    let drive = |instance: Instance| {
        for k in 50..100 {
            let torque = 1.5 + 0.01 * f64::from(k);
            ok(host::set(instance, &torques(&fmu), &[torque, torque]));
            ok(host::step(instance, f64::from(k) * 10.0 * INNER, 10.0 * INNER).status);
        }
        host::get(instance, &signals).unwrap().iter().map(|value| value.to_bits()).collect::<Vec<_>>()
    };
    let [first, second] = [fmu.running(), fmu.running()];
    ok(host::set(first, &torques(&fmu), &TORQUE));
    ok(host::step(first, 0.0, 0.5).status);
    let (mut state, mut other, mut size) = (null_mut(), null_mut(), 0);
    // SAFETY: valid places, and memory of the size that was asked for.
    unsafe {
        ok(fmi3GetFMUState(first, &mut state));
        ok(fmi3SerializedFMUStateSize(first, state, &mut size));
        let mut bytes = vec![0; size];
        assert_eq!(fmi3SerializeFMUState(first, state, bytes.as_mut_ptr(), size - 1), Status::Error, "too small");
        ok(fmi3SerializeFMUState(first, state, bytes.as_mut_ptr(), size));
        ok(fmi3DeserializeFMUState(second, bytes.as_ptr(), size, &mut other));
        ok(fmi3SetFMUState(second, other));
        assert_eq!(drive(first), drive(second));
        for damage in [0, size / 2, size - 1] {
            let mut damaged = bytes.clone();
            damaged[damage] ^= 1;
            assert_eq!(fmi3DeserializeFMUState(second, damaged.as_ptr(), size, &mut other), Status::Error, "{damage}");
        }
        let rocker = Fmu::preset("rocker_bogie").running();
        let mut foreign = null_mut();
        assert_eq!(fmi3DeserializeFMUState(rocker, bytes.as_ptr(), size, &mut foreign), Status::Error);
        assert!(foreign.is_null());
        fmi3FreeInstance(rocker);
    }
    fmi3FreeInstance(first);
    fmi3FreeInstance(second);
}
