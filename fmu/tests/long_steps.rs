//! Communication steps that are too long for one call. A wheel on a carriage steps over hours at no cost.
#![allow(clippy::unwrap_used, reason = "a test may fail by panicking")]

mod host;

use bekker::model::Model;
use bekker_fmu::Kind;
use bekker_fmu::fmi2::{fmi2DoStep, fmi2FreeInstance, fmi2GetRealStatus, fmi2GetStatus};
use bekker_fmu::fmi3::*;
use host::{Fmu, log, messages, step};
use std::ptr::{null, null_mut};

/// The longest step in one call, s.
const LONGEST: f64 = 3600.0;

fn wheel() -> Fmu {
    let model = Model::from_toml("name = \"wheel\"\n[rig]\nkind = \"carriage\"\n", None).unwrap();
    Fmu::of_kind(&model, Kind::Carriage)
}

/// An instance of FMI 3.0 whose importer allows early return, in step mode.
fn with_early_return(fmu: &Fmu) -> Instance {
    let (token, resources) = (fmu.token(), fmu.resources());
    let (token, resources) = (token.as_ptr(), resources.as_ptr());
    // SAFETY: texts that live through the call, and NULL where the standard allows it.
    let instance = unsafe {
        let (name, none) = (c"wheel".as_ptr(), null_mut());
        fmi3InstantiateCoSimulation(name, token, resources, 0, 1, 0, 1, null(), 0, none, Some(log), None)
    };
    assert_eq!(fmi3EnterInitializationMode(instance, 0, 0.0, 0.0, 0, 0.0), Status::Ok, "{:?}", messages());
    assert_eq!(fmi3ExitInitializationMode(instance), Status::Ok, "{:?}", messages());
    instance
}

#[test]
fn property_a_long_step_returns_early_where_the_importer_allows_it() {
    let fmu = wheel();
    let instance = with_early_return(&fmu);
    let first = step(instance, 0.0, 10_000.0);
    assert_eq!((first.status, first.early, first.time), (Status::Ok, true, LONGEST), "{:?}", messages());
    let second = step(instance, LONGEST, 10_000.0 - LONGEST);
    assert_eq!((second.status, second.early, second.time), (Status::Ok, true, 2.0 * LONGEST));
    let last = step(instance, 2.0 * LONGEST, 10_000.0 - 2.0 * LONGEST);
    assert_eq!((last.status, last.early, last.time), (Status::Ok, false, 10_000.0));
    fmi3FreeInstance(instance);
}

#[test]
fn property_a_long_step_is_discarded_with_the_reason_elsewhere() {
    for fmu in [wheel(), Fmu::preset("two_wheeled"), Fmu::preset("gentle_velocity")] {
        let instance = fmu.running();
        messages();
        let stepped = step(instance, 0.0, 1e6);
        assert_eq!((stepped.status, stepped.time), (Status::Discard, 0.0));
        assert!(messages().iter().any(|line| line.contains("longer than 3600 s")));
        assert_eq!(step(instance, 0.0, 0.01).status, Status::Ok, "and nothing is lost");
        fmi3FreeInstance(instance);

        let old = fmu.running2();
        messages();
        assert_eq!(fmi2DoStep(old, 0.0, 3600.1, 1), Status::Discard);
        assert!(messages().iter().any(|line| line.contains("longer than 3600 s")));
        let (mut status, mut time) = (Status::Ok, f64::NAN);
        // SAFETY: one place for each answer.
        unsafe {
            assert_eq!(fmi2GetStatus(old, 0, &mut status), Status::Ok);
            assert_eq!(fmi2GetRealStatus(old, 2, &mut time), Status::Ok);
        }
        assert_eq!((status, time), (Status::Discard, 0.0));
        assert_eq!(fmi2DoStep(old, 0.0, 0.01, 1), Status::Ok);
        fmi2FreeInstance(old);
    }
    let fmu = wheel();
    let instance = fmu.running();
    assert_eq!(step(instance, 0.0, LONGEST).status, Status::Ok, "the longest itself is made");
    fmi3FreeInstance(instance);
}
