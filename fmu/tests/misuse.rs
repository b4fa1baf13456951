//! Calls that the standard forbids: each is answered with an error and a message, and the instance goes on.
#![allow(clippy::unwrap_used)]

mod host;

use bekker_fmu::fmi3::*;
use host::{Fmu, INNER, get, instantiate, messages, set, step};
use std::ffi::c_void;
use std::ptr::{null, null_mut};

/// Calls `call`, which must be refused with a message that has `words`.
fn refused(words: &str, call: impl FnOnce() -> Status) {
    messages();
    assert_eq!(call(), Status::Error, "{words}");
    let log = messages();
    assert!(log.iter().any(|line| line.contains(words)), "expected `{words}` in {log:?}");
}

#[test]
fn property_wrong_instantiation_gives_null_and_a_message() {
    let fmu = Fmu::preset("two_wheeled");
    let fmus_of_a_controller = Fmu::preset("gentle_velocity");
    let (token, resources) = (fmu.token(), fmu.resources());
    let null_with = |words: &str, instance: Instance| {
        assert!(instance.is_null(), "{words}");
        let log = messages();
        assert!(log.iter().any(|line| line.contains(words)), "expected `{words}` in {log:?}");
    };
    null_with("token", instantiate(c"a", Some(c"another"), Some(&resources)));
    null_with("instantiationToken is NULL", instantiate(c"a", None, Some(&resources)));
    null_with("instanceName", instantiate(c"", Some(&token), Some(&resources)));
    null_with("not a folder", instantiate(c"a", Some(&token), Some(c"/no/such/place/")));
    null_with("not a folder", instantiate(c"a", Some(&token), None));
    null_with("cannot read", instantiate(c"a", Some(&token), Some(c"/")));
    // SAFETY: NULL everywhere, as an importer in error might; the logger is valid.
    unsafe {
        null_with(
            "instanceName",
            fmi3InstantiateCoSimulation(
                null(),
                null(),
                null(),
                0,
                1,
                0,
                0,
                null(),
                0,
                null_mut(),
                Some(host::log),
                None,
            ),
        );
        null_with(
            "co-simulation only",
            fmi3InstantiateModelExchange(
                c"a".as_ptr(),
                fmus_of_a_controller.token().as_ptr(),
                fmus_of_a_controller.resources().as_ptr(),
                0,
                0,
                null_mut(),
                Some(host::log),
            ),
        );
        null_with(
            "no scheduled execution",
            fmi3InstantiateScheduledExecution(
                null(),
                null(),
                null(),
                0,
                0,
                null_mut(),
                Some(host::log),
                null(),
                null(),
                null(),
            ),
        );
        let silent = fmi3InstantiateCoSimulation(null(), null(), null(), 0, 1, 0, 0, null(), 0, null_mut(), None, None);
        assert!(silent.is_null(), "without a logger too");
    }
}

#[test]
fn property_a_changed_model_file_is_noticed() {
    let fmu = Fmu::preset("two_wheeled");
    let file = fmu.folder().join("model.toml");
    let text = std::fs::read_to_string(&file).unwrap();
    std::fs::write(&file, format!("{text}\n# changed\n")).unwrap();
    assert!(fmu.instantiate().is_null());
    assert!(messages().iter().any(|line| line.contains("does not belong to the model")));
    std::fs::write(&file, "not = [toml").unwrap();
    assert!(fmu.instantiate().is_null());
    assert!(messages().iter().any(|line| line.contains("model.toml")));
}

#[test]
fn property_unknown_instances_are_errors() {
    let fmu = Fmu::preset("two_wheeled");
    let freed = fmu.running();
    fmi3FreeInstance(freed);
    fmi3FreeInstance(freed);
    fmi3FreeInstance(null_mut());
    for instance in [null_mut(), freed, 8 as *mut c_void, usize::MAX as *mut c_void] {
        assert_eq!(fmi3EnterInitializationMode(instance, 0, 0.0, 0.0, 0, 0.0), Status::Error);
        assert_eq!(get(instance, &[0]), Err(Status::Error));
        assert_eq!(step(instance, 0.0, INNER).status, Status::Error);
        assert_eq!(fmi3Reset(instance), Status::Error);
        assert_eq!(fmi3EnterEventMode(instance), Status::Error);
    }
}

#[test]
fn property_wrong_order_is_refused() {
    let fmu = Fmu::preset("two_wheeled");
    let x = fmu.reference("x");
    let instance = fmu.instantiate();
    refused("expected `initialization mode`", || fmi3ExitInitializationMode(instance));
    refused("expected `step mode`", || step(instance, 0.0, INNER).status);
    refused("expected `step mode`", || fmi3Terminate(instance));
    refused("no value before initialization", || get(instance, &[x]).unwrap_err());
    refused("stop time", || fmi3EnterInitializationMode(instance, 0, 0.0, 1.0, 1, 0.5));
    refused("start time", || fmi3EnterInitializationMode(instance, 0, 0.0, f64::NAN, 0, 0.0));
    assert_eq!(fmi3EnterInitializationMode(instance, 1, 1e-6, 0.0, 1, 5.0), Status::Ok);
    refused("expected `instantiated`", || fmi3EnterInitializationMode(instance, 0, 0.0, 0.0, 0, 0.0));
    refused("expected `step mode`", || step(instance, 0.0, INNER).status);
    assert_eq!(fmi3ExitInitializationMode(instance), Status::Ok);
    refused("after the stop time", || step(instance, 0.0, 6.0).status);
    assert_eq!(step(instance, 0.0, INNER).status, Status::Ok);
    assert_eq!(fmi3Terminate(instance), Status::Ok);
    refused("expected `step mode`", || step(instance, INNER, INNER).status);
    assert!(get(instance, &[x]).is_ok(), "readable after the end");
    assert_eq!(fmi3Reset(instance), Status::Ok);
    fmi3FreeInstance(instance);
}

#[test]
fn property_wrong_values_and_references_are_refused() {
    let fmu = Fmu::preset("two_wheeled");
    let [torque, x, mass, event] =
        ["wheel[1].torque_command", "x", "wheel.radius", "event"].map(|name| fmu.reference(name));
    let instance = fmu.running();
    refused("no variable has the value reference 4294967295", || get(instance, &[u32::MAX]).unwrap_err());
    refused("`x` is `continuous output`", || set(instance, &[x], &[0.0]));
    refused("`time` is `continuous independent`", || set(instance, &[0], &[0.0]));
    refused("`wheel.radius` is `fixed parameter`", || set(instance, &[mass], &[0.1]));
    for value in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e300] {
        refused("expected a finite number in", || set(instance, &[torque], &[value]));
    }
    refused("is an enumeration", || get(instance, &[event]).unwrap_err());
    refused("stand for 1 values, but 0", || set(instance, &[torque], &[]));
    let mut integer = 7_i64;
    let mut word = null();
    // SAFETY: one reference, one place.
    unsafe {
        refused("is a 64 bit", || fmi3GetInt64(instance, &torque, 1, &mut integer, 1));
        refused("not a string", || fmi3GetString(instance, &torque, 1, &mut word, 1));
        refused("not a Boolean", || fmi3SetBoolean(instance, &torque, 1, &1, 1));
        refused("not a clock", || fmi3GetClock(instance, &torque, 1, null_mut()));
        assert_eq!(fmi3GetFloat32(instance, null(), 0, null_mut(), 0), Status::Ok, "an empty list asks for nothing");
        assert_eq!(fmi3GetInt64(instance, &event, 1, &mut integer, 1), Status::Ok);
    }
    assert_eq!(integer, 0);
    assert_eq!(step(instance, 0.0, INNER).status, Status::Ok, "{:?}", messages());
    fmi3FreeInstance(instance);
}

#[test]
fn property_wrong_steps_are_refused() {
    let fmu = Fmu::preset("two_wheeled");
    let instance = fmu.running();
    for size in [0.0, -INNER, f64::NAN, f64::INFINITY] {
        refused("expected a positive number", || step(instance, 0.0, size).status);
    }
    refused("this instance is at 0 s", || step(instance, 1.0, INNER).status);
    refused("this instance is at 0 s", || step(instance, f64::NAN, INNER).status);
    let stepped = step(instance, 0.0, 0.003);
    assert_eq!((stepped.status, stepped.event, stepped.terminate, stepped.early), (Status::Ok, false, false, false));
    fmi3FreeInstance(instance);
}

#[test]
fn property_null_pointers_are_refused() {
    let fmu = Fmu::preset("two_wheeled");
    let x = fmu.reference("x");
    let instance = fmu.running();
    let mut value = 0.0;
    let odd = (&raw const x).cast::<u8>().wrapping_add(1).cast::<u32>();
    let mut state = null_mut();
    let (mut flag, mut time) = (false, 0.0);
    // SAFETY: NULL and unaligned pointers are what is tested; the rest is valid.
    unsafe {
        refused("`valueReferences` is NULL", || fmi3GetFloat64(instance, null(), 1, &mut value, 1));
        refused("`values` is NULL", || fmi3GetFloat64(instance, &x, 1, null_mut(), 1));
        refused("`valueReferences` is NULL or not aligned", || fmi3GetFloat64(instance, odd, 1, &mut value, 1));
        refused("is NULL", || fmi3GetFloat64(instance, &x, usize::MAX, &mut value, usize::MAX));
        refused("`values` is NULL", || fmi3SetFloat64(instance, &x, 1, null(), 1));
        refused("is NULL", || fmi3DoStep(instance, 0.0, INNER, 1, null_mut(), &mut flag, &mut flag, &mut time));
        refused("is NULL", || fmi3DoStep(instance, 0.0, INNER, 1, &mut flag, &mut flag, &mut flag, null_mut()));
        refused("`FMUState` is NULL", || fmi3GetFMUState(instance, null_mut()));
        refused("not a state of this instance", || fmi3SetFMUState(instance, null_mut()));
        assert_eq!(fmi3FreeFMUState(instance, null_mut()), Status::Ok, "NULL is ignored");
        assert_eq!(fmi3FreeFMUState(instance, &mut state), Status::Ok, "NULL is ignored");
        refused("`categories` is NULL", || fmi3SetDebugLogging(instance, 1, 1, null()));
        refused("`categories[i]` is NULL", || fmi3SetDebugLogging(instance, 1, 1, &null()));
        refused("no log category", || fmi3SetDebugLogging(instance, 1, 1, &c"everything".as_ptr()));
    }
    assert_eq!(step(instance, 0.0, INNER).status, Status::Ok, "{:?}", messages());
    fmi3FreeInstance(instance);
}

#[test]
fn property_wrong_states_are_refused() {
    let fmu = Fmu::preset("two_wheeled");
    let [first, second] = [fmu.running(), fmu.running()];
    let mut state = null_mut();
    // SAFETY: valid places.
    unsafe {
        assert_eq!(fmi3GetFMUState(first, &mut state), Status::Ok);
        let mut copy = state;
        refused("not a state of this instance", || fmi3SetFMUState(second, state));
        assert_eq!(fmi3FreeFMUState(first, &mut state), Status::Ok);
        assert!(state.is_null());
        refused("freed", || fmi3FreeFMUState(first, &mut copy));
        refused("freed", || fmi3SetFMUState(first, copy));
        refused("freed", || fmi3GetFMUState(first, &mut copy));
    }
    fmi3FreeInstance(first);
    fmi3FreeInstance(second);
}

#[test]
fn property_what_is_not_offered_says_so() {
    let fmu = Fmu::preset("two_wheeled");
    let instance = fmu.running();
    refused("eventModeUsed = false", || fmi3EnterEventMode(instance));
    refused("eventModeUsed = true", || fmi3EnterStepMode(instance));
    refused("no structural parameters", || fmi3EnterConfigurationMode(instance));
    refused("for model exchange", || fmi3SetTime(instance, 1.0));
    refused("for scheduled execution", || fmi3ActivateModelPartition(instance, 0, 0.0));
    assert_eq!(step(instance, 0.0, INNER).status, Status::Ok);
    fmi3FreeInstance(instance);
}

/// A logger that calls back into the instance, which the standard forbids.
unsafe extern "C" fn nosy(environment: *mut c_void, _: Status, _: *const std::ffi::c_char, _: *const std::ffi::c_char) {
    // SAFETY: the test passes the place of the instance.
    let instance = unsafe { *environment.cast::<Instance>() };
    assert_eq!(fmi3Reset(instance), Status::Error, "refused, not waiting for ever");
}

#[test]
fn property_a_call_from_a_callback_is_refused() {
    let fmu = Fmu::preset("two_wheeled");
    let (token, resources) = (fmu.token(), fmu.resources());
    let mut place: Instance = null_mut();
    let environment = (&raw mut place).cast::<c_void>();
    // SAFETY: valid texts; the environment outlives the instance.
    unsafe {
        let instance = fmi3InstantiateCoSimulation(
            c"a".as_ptr(),
            token.as_ptr(),
            resources.as_ptr(),
            0,
            0,
            0,
            0,
            null(),
            0,
            environment,
            Some(nosy),
            None,
        );
        environment.cast::<Instance>().write(instance);
        assert_eq!(fmi3Terminate(instance), Status::Error);
        assert_eq!(fmi3EnterInitializationMode(instance, 0, 0.0, 0.0, 0, 0.0), Status::Ok);
        fmi3FreeInstance(instance);
    }
}
