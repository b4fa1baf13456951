//! FMI 3.0 inside of a step: intermediate update and early return; event mode; dependencies.
#![allow(clippy::unwrap_used, reason = "a test may fail by panicking")]

mod host;

use bekker_fmu::fmi3::*;
use host::{Fmu, INNER, get, messages, set, step};
use std::ffi::c_void;
use std::ptr::null;

/// What a callback has seen, and how it answers.
struct Watcher {
    instance: Instance,
    x: u32,
    torque: u32,
    times: Vec<f64>,
    places: Vec<f64>,
    /// Time from which on it asks to return, and until when.
    stop: Option<(f64, f64)>,
    ramp: bool,
}

#[allow(clippy::too_many_arguments, reason = "the standard's")]
unsafe extern "C" fn watch(
    environment: *mut c_void,
    time: f64,
    set_requested: bool,
    get_allowed: bool,
    finished: bool,
    can_return: bool,
    early: *mut u8,
    until: *mut f64,
) {
    // SAFETY: the tests pass a Watcher, the library two places.
    let (watcher, early, until) = unsafe { (&mut *environment.cast::<Watcher>(), &mut *early, &mut *until) };
    assert!(set_requested && get_allowed && finished);
    watcher.times.push(time);
    watcher.places.push(get(watcher.instance, &[watcher.x]).unwrap()[0]);
    if watcher.ramp {
        assert_eq!(set(watcher.instance, &[watcher.torque], &[20.0 * time]), Status::Ok, "{:?}", messages());
    }
    // All else is refused in here, and does no harm.
    assert_eq!(step(watcher.instance, time, INNER).status, Status::Error);
    assert_eq!(fmi3Terminate(watcher.instance), Status::Error);
    if let Some((_, end)) = watcher.stop.filter(|(begin, _)| can_return && time >= *begin) {
        (*early, *until) = (1, end);
    }
}

/// An instance in step mode that calls `watcher` back.
fn watched(fmu: &Fmu, watcher: &mut Watcher, early_return: bool) -> Instance {
    let (token, resources) = (fmu.token(), fmu.resources());
    let place = std::ptr::from_mut(watcher).cast::<c_void>();
    let (name, early) = (c"a".as_ptr(), u8::from(early_return));
    // SAFETY: valid texts; the watcher outlives the instance.
    let instance = unsafe {
        fmi3InstantiateCoSimulation(
            name,
            token.as_ptr(),
            resources.as_ptr(),
            0,
            1,
            0,
            early,
            null(),
            0,
            place,
            None,
            Some(watch),
        )
    };
    watcher.instance = instance;
    assert_eq!(fmi3EnterInitializationMode(instance, 0, 0.0, 0.0, 0, 0.0), Status::Ok);
    assert_eq!(fmi3ExitInitializationMode(instance), Status::Ok);
    assert_eq!(set(instance, &[watcher.torque], &[1.0]), Status::Ok);
    instance
}

fn watcher(fmu: &Fmu) -> Watcher {
    let (x, torque) = (fmu.reference("x"), fmu.reference("wheel[1].torque_command"));
    Watcher { instance: std::ptr::null_mut(), x, torque, times: vec![], places: vec![], stop: None, ramp: false }
}

#[test]
fn property_callbacks_come_after_each_inner_step_and_change_nothing() {
    let fmu = Fmu::preset("two_wheeled");
    let mut seen = watcher(&fmu);
    let instance = watched(&fmu, &mut seen, false);
    let stepped = step(instance, 0.0, 0.01);
    assert_eq!((stepped.status, stepped.early), (Status::Ok, false));
    assert_eq!(seen.times.len(), 9, "not at the end, where the importer is anyway: {:?}", seen.times);
    for (k, time) in seen.times.iter().enumerate() {
        assert!((time - (k + 1) as f64 * INNER).abs() < 1e-12);
    }
    let plain = fmu.running();
    assert_eq!(set(plain, &[seen.torque], &[1.0]), Status::Ok);
    for place in &seen.places {
        let time = get(plain, &[0]).unwrap()[0];
        assert_eq!(step(plain, time, INNER).status, Status::Ok);
        assert_eq!(get(plain, &[seen.x]).unwrap()[0].to_bits(), place.to_bits());
    }
    fmi3FreeInstance(instance);
    fmi3FreeInstance(plain);
}

#[test]
fn agreement_of_inputs_set_in_callbacks_with_small_steps() {
    let fmu = Fmu::preset("two_wheeled");
    let mut seen = watcher(&fmu);
    seen.ramp = true;
    let instance = watched(&fmu, &mut seen, false);
    assert_eq!(step(instance, 0.0, 0.05).status, Status::Ok);
    let plain = fmu.running();
    assert_eq!(set(plain, &[seen.torque], &[1.0]), Status::Ok);
    for _ in 0..50 {
        let time = get(plain, &[0]).unwrap()[0];
        if time > 0.0 {
            assert_eq!(set(plain, &[seen.torque], &[20.0 * time]), Status::Ok);
        }
        assert_eq!(step(plain, time, INNER).status, Status::Ok);
    }
    let [here, there] = [instance, plain].map(|instance| get(instance, &[seen.x]).unwrap()[0].to_bits());
    assert_eq!(here, there);
    fmi3FreeInstance(instance);
    fmi3FreeInstance(plain);
}

#[test]
fn property_the_importer_may_return_early() {
    let fmu = Fmu::preset("two_wheeled");
    for (allowed, end, expected) in [(true, 0.005, 0.005), (true, 0.0, 0.003), (true, 9.0, 0.01), (false, 0.005, 0.01)]
    {
        let mut seen = watcher(&fmu);
        seen.stop = Some((0.003 - 1e-9, end));
        let instance = watched(&fmu, &mut seen, allowed);
        let stepped = step(instance, 0.0, 0.01);
        assert_eq!(stepped.status, Status::Ok);
        assert!((stepped.time - expected).abs() < 1e-12, "{stepped:?}");
        assert_eq!(stepped.early, expected < 0.01, "{stepped:?}");
        assert!((get(instance, &[0]).unwrap()[0] - expected).abs() < 1e-12);
        assert_eq!(step(instance, stepped.time, 0.002).status, Status::Ok, "and goes on from there");
        fmi3FreeInstance(instance);
    }
}

#[test]
fn property_event_mode_is_entered_where_it_is_used() {
    let fmu = Fmu::preset("two_wheeled");
    let (token, resources, name) = (fmu.token(), fmu.resources(), c"a".as_ptr());
    let null_place = std::ptr::null_mut();
    // SAFETY: valid texts.
    let instance = unsafe {
        let (token, resources) = (token.as_ptr(), resources.as_ptr());
        fmi3InstantiateCoSimulation(name, token, resources, 0, 1, 1, 0, null(), 0, null_place, Some(host::log), None)
    };
    assert_eq!(fmi3EnterInitializationMode(instance, 0, 0.0, 0.0, 0, 0.0), Status::Ok);
    assert_eq!(fmi3ExitInitializationMode(instance), Status::Ok);
    assert_eq!(step(instance, 0.0, INNER).status, Status::Error, "in event mode");
    let update = || {
        let (mut flags, mut time) = ([true; 5], f64::NAN);
        let [a, b, c, d, e] = flags.each_mut();
        // SAFETY: six places.
        assert_eq!(unsafe { fmi3UpdateDiscreteStates(instance, a, b, c, d, e, &mut time) }, Status::Ok);
        flags
    };
    assert_eq!(update(), [false; 5]);
    assert_eq!(fmi3EvaluateDiscreteStates(instance), Status::Ok);
    assert_eq!(fmi3EnterStepMode(instance), Status::Ok);
    assert_eq!(step(instance, 0.0, INNER).status, Status::Ok);
    assert_eq!(fmi3EnterEventMode(instance), Status::Ok);
    assert_eq!(set(instance, &[fmu.reference("wheel[1].torque_command")], &[1.0]), Status::Ok);
    assert_eq!(update(), [false; 5]);
    assert_eq!(fmi3EnterStepMode(instance), Status::Ok);
    assert_eq!(step(instance, INNER, INNER).status, Status::Ok, "{:?}", messages());
    assert_eq!(fmi3Terminate(instance), Status::Ok);
    fmi3FreeInstance(instance);
}

#[test]
fn property_only_drives_answer_to_torques_at_once() {
    let fmu = Fmu::preset("two_wheeled");
    let instance = fmu.running();
    let torques = ["wheel[1].torque_command", "wheel[2].torque_command"].map(|name| fmu.reference(name));
    let inputs_of = |name: &str| {
        let mut count = 0;
        // SAFETY: one place; then four lists of as many places as were counted.
        unsafe {
            assert_eq!(fmi3GetNumberOfVariableDependencies(instance, fmu.reference(name), &mut count), Status::Ok);
            let (mut own, mut theirs, mut elements, mut kinds) =
                (vec![9; count], vec![0; count], vec![9; count], vec![9; count]);
            let status = fmi3GetVariableDependencies(
                instance,
                fmu.reference(name),
                own.as_mut_ptr(),
                theirs.as_mut_ptr(),
                elements.as_mut_ptr(),
                kinds.as_mut_ptr(),
                count,
            );
            assert_eq!(status, Status::Ok, "{:?}", messages());
            assert!(theirs.contains(&fmu.reference("state.wheel[1].spin")), "{name} follows from the states");
            assert_eq!((own, elements), (vec![1; count], vec![1; count]));
            assert_eq!(kinds, vec![5; count], "fmi3Dependent");
            theirs.retain(|reference| torques.contains(reference));
            theirs
        }
    };
    for name in ["x", "pitch", "velocity", "wheel[1].slip", "wheel[1].normal_force", "event"] {
        assert_eq!(inputs_of(name), [0; 0], "{name}");
    }
    assert_eq!(inputs_of("wheel[2].torque"), [torques[1]]);
    assert_eq!(inputs_of("wheel[1].current"), [torques[0]]);
    assert_eq!(inputs_of("power"), torques);
    fmi3FreeInstance(instance);
}
