//! Calls that the standards forbid, dozens for each version, in a process of their own: it must live, refuse each of
//! them and then simulate as if nothing had been.
#![allow(clippy::unwrap_used, reason = "a test may fail by panicking")]

mod host;

use bekker_fmu::fmi2::*;
use bekker_fmu::fmi3::*;
use host::{Fmu, INNER, callbacks, messages};
use std::ffi::c_void;
use std::process::Command;
use std::ptr::{null, null_mut};

/// Fewest calls for each version.
const CALLS: u32 = 60;

/// Runs the test `name` of this file in a process of its own.
fn lives(name: &str) {
    let program = std::env::current_exe().unwrap();
    let run = Command::new(program).args(["--ignored", "--exact", name, "--nocapture"]).output().unwrap();
    let said = String::from_utf8_lossy(&run.stdout);
    assert!(run.status.success(), "{:?}\n{said}\n{}", run.status, String::from_utf8_lossy(&run.stderr));
    let count =
        said.lines().find_map(|line| line.split_once("refused calls: ")).and_then(|(_, n)| n.trim().parse().ok());
    let count: u32 = count.expect("the child has counted");
    assert!(count >= CALLS, "{count}");
}

#[test]
fn property_the_host_lives_through_abuse_of_fmi2() {
    lives("abuse_of_fmi2");
}

#[test]
fn property_the_host_lives_through_abuse_of_fmi3() {
    lives("abuse_of_fmi3");
}

/// Counts calls that must not succeed; those on a living instance must also say why.
macro_rules! refused {
    ($count:ident: $($call:expr;)*) => {$(
        messages();
        $count += 1;
        let status = $call;
        assert!(matches!(status, Status::Error | Status::Discard), "{} is {status:?}", stringify!($call));
        assert!(!messages().is_empty(), "{} says nothing", stringify!($call));
    )*};
}

/// Counts calls on instances that do not exist: an error without a message, since no logger is known.
macro_rules! unknown {
    ($count:ident: $($call:expr;)*) => {$(
        $count += 1;
        assert_eq!($call, Status::Error, stringify!($call));
    )*};
}

/// Counts instantiations that must give NULL.
macro_rules! none {
    ($count:ident: $($call:expr;)*) => {$(
        $count += 1;
        assert!($call.is_null(), stringify!($call));
    )*};
}

#[test]
#[ignore = "runs in a child process"]
fn abuse_of_fmi3() {
    let fmu = Fmu::preset("two_wheeled");
    let (token, resources) = (fmu.token(), fmu.resources());
    let [torque, x, radius, event] =
        ["wheel[1].torque_command", "x", "wheel.radius", "event"].map(|n| fmu.reference(n));
    let mut n = 0;
    let (mut value, mut integer, mut small, mut size) = (0.0_f64, 0_i64, [0_u8; 3], 0_usize);
    let (mut flag, mut time, mut state) = (false, 0.0, null_mut());
    let odd = 7 as *const u32;
    // SAFETY: what is wrong here is wrong in ways that the library promises to find out.
    unsafe {
        let make = |name, token, path| {
            fmi3InstantiateCoSimulation(name, token, path, 0, 1, 0, 0, null(), 0, null_mut(), Some(host::log), None)
        };
        none! { n:
            make(null(), token.as_ptr(), resources.as_ptr());
            make(c"a".as_ptr(), null(), resources.as_ptr());
            make(c"a".as_ptr(), c"wrong".as_ptr(), resources.as_ptr());
            make(c"a".as_ptr(), token.as_ptr(), null());
            make(c"a".as_ptr(), token.as_ptr(), c"/nowhere".as_ptr());
            make(c"a".as_ptr(), token.as_ptr(), c"\xff\xfe".as_ptr());
            fmi3InstantiateModelExchange(null(), null(), null(), 0, 0, null_mut(), None);
            fmi3InstantiateScheduledExecution(null(), null(), null(), 0, 0, null_mut(), None, null(), null(), null());
        }
        let instance = fmu.instantiate();
        refused! { n:
            fmi3ExitInitializationMode(instance);
            fmi3DoStep(instance, 0.0, INNER, 1, &mut flag, &mut flag, &mut flag, &mut time);
            fmi3Terminate(instance);
            fmi3EnterEventMode(instance);
            fmi3EnterStepMode(instance);
            fmi3EnterContinuousTimeMode(instance);
            fmi3EnterConfigurationMode(instance);
            fmi3ExitConfigurationMode(instance);
            fmi3GetFloat64(instance, &x, 1, &mut value, 1);
            fmi3EnterInitializationMode(instance, 0, 0.0, f64::NAN, 0, 0.0);
            fmi3EnterInitializationMode(instance, 0, 0.0, f64::INFINITY, 0, 0.0);
            fmi3EnterInitializationMode(instance, 0, 0.0, 1.0, 1, 1.0);
            fmi3SetFloat64(instance, &radius, 1, &-1.0, 1);
            fmi3SetFloat64(instance, &radius, 1, &f64::NAN, 1);
        }
        assert_eq!(fmi3EnterInitializationMode(instance, 0, 0.0, 0.0, 1, 10.0), Status::Ok);
        refused! { n:
            fmi3EnterInitializationMode(instance, 0, 0.0, 0.0, 0, 0.0);
            fmi3DoStep(instance, 0.0, INNER, 1, &mut flag, &mut flag, &mut flag, &mut time);
        }
        assert_eq!(fmi3ExitInitializationMode(instance), Status::Ok);
        let mut step = |at, size| fmi3DoStep(instance, at, size, 1, &mut flag, &mut flag, &mut flag, &mut time);
        refused! { n:
            step(0.0, 0.0);
            step(0.0, -INNER);
            step(0.0, f64::NAN);
            step(0.0, f64::INFINITY);
            step(0.0, 1e300);
            step(0.0, 11.0);
            step(5.0, INNER);
            step(-5.0, INNER);
            step(f64::NAN, INNER);
        }
        refused! { n:
            fmi3DoStep(instance, 0.0, INNER, 1, null_mut(), &mut flag, &mut flag, &mut time);
            fmi3DoStep(instance, 0.0, INNER, 1, &mut flag, null_mut(), &mut flag, &mut time);
            fmi3DoStep(instance, 0.0, INNER, 1, &mut flag, &mut flag, null_mut(), &mut time);
            fmi3DoStep(instance, 0.0, INNER, 1, &mut flag, &mut flag, &mut flag, null_mut());
            fmi3SetFloat64(instance, &x, 1, &1.0, 1);
            fmi3SetFloat64(instance, &0, 1, &1.0, 1);
            fmi3SetFloat64(instance, &radius, 1, &0.1, 1);
            fmi3SetFloat64(instance, &torque, 1, &f64::NAN, 1);
            fmi3SetFloat64(instance, &torque, 1, &f64::NEG_INFINITY, 1);
            fmi3SetFloat64(instance, &torque, 1, &1e300, 1);
            fmi3SetFloat64(instance, &torque, 1, null(), 1);
            fmi3SetFloat64(instance, null(), 1, &1.0, 1);
            fmi3SetFloat64(instance, odd, 1, &1.0, 1);
            fmi3SetFloat64(instance, &torque, 1, &1.0, 0);
            fmi3SetFloat64(instance, &torque, usize::MAX, &1.0, usize::MAX);
            fmi3GetFloat64(instance, &u32::MAX, 1, &mut value, 1);
            fmi3GetFloat64(instance, &event, 1, &mut value, 1);
            fmi3GetFloat64(instance, &x, 1, null_mut(), 1);
            fmi3GetFloat64(instance, &x, 1, &mut value, 0);
            fmi3GetInt64(instance, &x, 1, &mut integer, 1);
            fmi3SetInt64(instance, &event, 1, &1, 1);
            fmi3GetFloat32(instance, &x, 1, null_mut(), 1);
            fmi3GetString(instance, &x, 1, null_mut(), 1);
            fmi3SetString(instance, &x, 1, null(), 1);
            fmi3GetBinary(instance, &x, 1, null_mut(), null_mut(), 1);
            fmi3SetBinary(instance, &x, 1, null(), null(), 1);
            fmi3GetClock(instance, &x, 1, null_mut());
            fmi3SetClock(instance, &x, 1, null());
            fmi3GetIntervalDecimal(instance, &x, 1, null_mut(), null_mut());
            fmi3SetShiftDecimal(instance, &x, 1, null());
            fmi3GetFMUState(instance, null_mut());
            fmi3GetFMUState(instance, &mut (88 as *mut c_void));
            fmi3SetFMUState(instance, null_mut());
            fmi3SetFMUState(instance, 16 as *mut c_void);
            fmi3FreeFMUState(instance, &mut (24 as *mut c_void));
            fmi3SerializedFMUStateSize(instance, null_mut(), &mut size);
            fmi3SerializeFMUState(instance, null_mut(), small.as_mut_ptr(), 3);
            fmi3DeserializeFMUState(instance, null(), 8, &mut state);
            fmi3DeserializeFMUState(instance, small.as_ptr(), 3, &mut state);
            fmi3DeserializeFMUState(instance, [7_u8; 64].as_ptr(), 64, &mut state);
            fmi3GetDirectionalDerivative(instance, &x, 1, &u32::MAX, 1, &1.0, 1, &mut value, 1);
            fmi3GetDirectionalDerivative(instance, &x, 1, &torque, 1, &1.0, 0, &mut value, 1);
            fmi3GetDirectionalDerivative(instance, &x, 1, &torque, 1, &1.0, 1, &mut value, usize::MAX);
            fmi3GetAdjointDerivative(instance, &torque, 1, &x, 1, &1.0, 1, &mut value, 1);
            fmi3GetOutputDerivatives(instance, &torque, 1, &1, &mut value, 1);
            fmi3GetOutputDerivatives(instance, &x, 1, &2, &mut value, 1);
            fmi3GetOutputDerivatives(instance, &x, 1, null(), &mut value, 1);
            fmi3GetNumberOfVariableDependencies(instance, u32::MAX, &mut size);
            fmi3GetNumberOfVariableDependencies(instance, x, null_mut());
            fmi3GetVariableDependencies(instance, x, null_mut(), null_mut(), null_mut(), null_mut(), 1);
            fmi3SetTime(instance, 1.0);
            fmi3SetContinuousStates(instance, &1.0, 1);
            fmi3GetContinuousStates(instance, &mut value, 1);
            fmi3GetContinuousStateDerivatives(instance, &mut value, 1);
            fmi3GetEventIndicators(instance, null_mut(), 1);
            fmi3GetNominalsOfContinuousStates(instance, null_mut(), 1);
            fmi3GetNumberOfContinuousStates(instance, &mut size);
            fmi3GetNumberOfEventIndicators(instance, null_mut());
            fmi3CompletedIntegratorStep(instance, 1, null_mut(), null_mut());
            fmi3UpdateDiscreteStates(
                instance, null_mut(), null_mut(), null_mut(), null_mut(), null_mut(), null_mut()
            );
            fmi3EvaluateDiscreteStates(instance);
            fmi3ActivateModelPartition(instance, 1, 0.0);
            fmi3SetDebugLogging(instance, 1, 1, null());
            fmi3SetDebugLogging(instance, 1, 1, &null());
            fmi3SetDebugLogging(instance, 1, 1, &c"\xff".as_ptr());
        }
        assert_eq!(fmi3GetFMUState(instance, &mut state), Status::Ok);
        let freed = state;
        assert_eq!(fmi3FreeFMUState(instance, &mut state), Status::Ok);
        refused! { n:
            fmi3FreeFMUState(instance, &mut { freed });
            fmi3SetFMUState(instance, freed);
        }
        assert_eq!(host::step(instance, 0.0, 10.0 * INNER).status, Status::Ok, "the instance goes on");
        assert_eq!(fmi3Terminate(instance), Status::Ok);
        refused! { n:
            fmi3DoStep(instance, 0.01, INNER, 1, &mut flag, &mut flag, &mut flag, &mut time);
            fmi3SetFloat64(instance, &torque, 1, &1.0, 1);
            fmi3Terminate(instance);
        }
        fmi3FreeInstance(instance);
        fmi3FreeInstance(instance);
        fmi3FreeInstance(null_mut());
        fmi3FreeInstance(12345 as *mut c_void);
        unknown! { n:
            fmi3Reset(instance);
            fmi3Reset(null_mut());
            fmi3Terminate(16 as *mut c_void);
            fmi3GetFloat64(instance, &x, 1, &mut value, 1);
            fmi3SetFMUState(instance, freed);
        }
    }
    println!("refused calls: {n}");
}

#[test]
#[ignore = "runs in a child process"]
fn abuse_of_fmi2() {
    let fmu = Fmu::preset("two_wheeled");
    let token = fmu.token();
    let place = std::ffi::CString::new(format!("file://{}", fmu.folder().display())).unwrap();
    let [torque, x, radius, event] =
        ["wheel[1].torque_command", "x", "wheel.radius", "event"].map(|n| fmu.reference(n));
    let mut n = 0;
    let (mut value, mut integer, mut small, mut size) = (0.0_f64, 0_i32, [0_u8; 3], 0_usize);
    let (mut text, mut state, mut status) = (null(), null_mut(), Status::Ok);
    // SAFETY: what is wrong here is wrong in ways that the library promises to find out.
    unsafe {
        let functions = callbacks();
        let make = |name, kind, token, path| fmi2Instantiate(name, kind, token, path, &functions, 0, 1);
        none! { n:
            make(null(), 1, token.as_ptr(), place.as_ptr());
            make(c"".as_ptr(), 1, token.as_ptr(), place.as_ptr());
            make(c"a".as_ptr(), 1, null(), place.as_ptr());
            make(c"a".as_ptr(), 1, c"wrong".as_ptr(), place.as_ptr());
            make(c"a".as_ptr(), 1, token.as_ptr(), null());
            make(c"a".as_ptr(), 1, token.as_ptr(), c"file:///nowhere".as_ptr());
            make(c"a".as_ptr(), 1, token.as_ptr(), c"file:///a%zz".as_ptr());
            make(c"a".as_ptr(), 1, token.as_ptr(), c"http://nowhere".as_ptr());
            make(c"a".as_ptr(), 2, token.as_ptr(), place.as_ptr());
            make(c"a".as_ptr(), -1, token.as_ptr(), place.as_ptr());
            fmi2Instantiate(null(), 1, null(), null(), null(), 0, 1);
            fmi2Instantiate(null(), 0, null(), null(), std::ptr::without_provenance(7), 0, 1);
        }
        let instance = fmu.instantiate2();
        assert!(!instance.is_null(), "{:?}", messages());
        refused! { n:
            fmi2ExitInitializationMode(instance);
            fmi2DoStep(instance, 0.0, INNER, 1);
            fmi2Terminate(instance);
            fmi2EnterEventMode(instance);
            fmi2EnterContinuousTimeMode(instance);
            fmi2GetReal(instance, &x, 1, &mut value);
            fmi2SetupExperiment(instance, 0, 0.0, f64::NAN, 0, 0.0);
            fmi2SetupExperiment(instance, 0, 0.0, 1.0, 1, 0.0);
            fmi2SetupExperiment(instance, 0, 0.0, 1.0, 1, f64::NAN);
            fmi2SetReal(instance, &radius, 1, &-1.0);
        }
        assert_eq!(fmi2SetupExperiment(instance, 1, 1e-4, 0.0, 1, 10.0), Status::Ok);
        assert_eq!(fmi2EnterInitializationMode(instance), Status::Ok);
        refused! { n:
            fmi2EnterInitializationMode(instance);
            fmi2SetupExperiment(instance, 0, 0.0, 0.0, 0, 0.0);
            fmi2DoStep(instance, 0.0, INNER, 1);
        }
        assert_eq!(fmi2ExitInitializationMode(instance), Status::Ok);
        refused! { n:
            fmi2DoStep(instance, 0.0, 0.0, 1);
            fmi2DoStep(instance, 0.0, -INNER, 1);
            fmi2DoStep(instance, 0.0, f64::NAN, 1);
            fmi2DoStep(instance, 0.0, f64::INFINITY, 1);
            fmi2DoStep(instance, 0.0, 11.0, 1);
            fmi2DoStep(instance, 5.0, INNER, 1);
            fmi2DoStep(instance, f64::NAN, INNER, 1);
            fmi2CancelStep(instance);
            fmi2GetStatus(instance, 1, &mut status);
            fmi2GetStatus(instance, 99, &mut status);
            fmi2GetStatus(instance, 0, null_mut());
            fmi2GetRealStatus(instance, 0, &mut value);
            fmi2GetRealStatus(instance, 2, null_mut());
            fmi2GetBooleanStatus(instance, 2, &mut integer);
            fmi2GetBooleanStatus(instance, 3, null_mut());
            fmi2GetIntegerStatus(instance, 0, &mut integer);
            fmi2GetStringStatus(instance, 0, &mut text);
            fmi2GetStringStatus(instance, 1, null_mut());
            fmi2SetReal(instance, &x, 1, &1.0);
            fmi2SetReal(instance, &0, 1, &1.0);
            fmi2SetReal(instance, &radius, 1, &0.1);
            fmi2SetReal(instance, &torque, 1, &f64::NAN);
            fmi2SetReal(instance, &torque, 1, &1e300);
            fmi2SetReal(instance, &torque, 1, null());
            fmi2SetReal(instance, null(), 1, &1.0);
            fmi2SetReal(instance, 7 as *const u32, 1, &1.0);
            fmi2SetReal(instance, &torque, usize::MAX, &1.0);
            fmi2GetReal(instance, &u32::MAX, 1, &mut value);
            fmi2GetReal(instance, &event, 1, &mut value);
            fmi2GetReal(instance, &x, 1, null_mut());
            fmi2GetInteger(instance, &x, 1, &mut integer);
            fmi2SetInteger(instance, &event, 1, &1);
            fmi2GetBoolean(instance, &x, 1, &mut integer);
            fmi2SetBoolean(instance, &x, 1, &integer);
            fmi2GetString(instance, &x, 1, &mut text);
            fmi2SetString(instance, &x, 1, &text);
            fmi2GetFMUstate(instance, null_mut());
            fmi2GetFMUstate(instance, &mut (88 as *mut c_void));
            fmi2SetFMUstate(instance, null_mut());
            fmi2SetFMUstate(instance, 16 as *mut c_void);
            fmi2FreeFMUstate(instance, &mut (24 as *mut c_void));
            fmi2SerializedFMUstateSize(instance, null_mut(), &mut size);
            fmi2SerializeFMUstate(instance, null_mut(), small.as_mut_ptr(), 3);
            fmi2DeSerializeFMUstate(instance, null(), 8, &mut state);
            fmi2DeSerializeFMUstate(instance, small.as_ptr(), 3, &mut state);
            fmi2DeSerializeFMUstate(instance, [7_u8; 64].as_ptr(), 64, &mut state);
            fmi2GetDirectionalDerivative(instance, &x, 1, &u32::MAX, 1, &1.0, &mut value);
            fmi2GetDirectionalDerivative(instance, &torque, 1, &x, 1, &1.0, &mut value);
            fmi2GetDirectionalDerivative(instance, &x, 1, &torque, 1, null(), &mut value);
            fmi2GetDirectionalDerivative(instance, &x, 1, &torque, 1, &f64::NAN, &mut value);
            fmi2SetRealInputDerivatives(instance, &x, 1, &1, &1.0);
            fmi2SetRealInputDerivatives(instance, &torque, 1, &0, &1.0);
            fmi2SetRealInputDerivatives(instance, &torque, 1, &-1, &1.0);
            fmi2SetRealInputDerivatives(instance, &torque, 1, &1, &f64::NAN);
            fmi2SetRealInputDerivatives(instance, &torque, 1, null(), &1.0);
            fmi2GetRealOutputDerivatives(instance, &torque, 1, &1, &mut value);
            fmi2GetRealOutputDerivatives(instance, &x, 1, &2, &mut value);
            fmi2GetRealOutputDerivatives(instance, &x, 1, &1, null_mut());
            fmi2EnterEventMode(instance);
            fmi2NewDiscreteStates(instance, null_mut());
            fmi2CompletedIntegratorStep(instance, 1, null_mut(), null_mut());
            fmi2SetTime(instance, 1.0);
            fmi2SetContinuousStates(instance, &1.0, 1);
            fmi2GetDerivatives(instance, &mut value, 1);
            fmi2GetEventIndicators(instance, &mut value, 1);
            fmi2GetContinuousStates(instance, null_mut(), 1);
            fmi2GetNominalsOfContinuousStates(instance, &mut value, 1);
            fmi2SetDebugLogging(instance, 1, 1, null());
            fmi2SetDebugLogging(instance, 1, 1, &c"everything".as_ptr());
        }
        assert_eq!(fmi2GetFMUstate(instance, &mut state), Status::Ok);
        let freed = state;
        assert_eq!(fmi2FreeFMUstate(instance, &mut state), Status::Ok);
        refused! { n:
            fmi2FreeFMUstate(instance, &mut { freed });
            fmi2SetFMUstate(instance, freed);
        }
        assert_eq!(fmi2DoStep(instance, 0.0, 10.0 * INNER, 1), Status::Ok, "the instance goes on");
        assert_eq!(fmi2Terminate(instance), Status::Ok);
        refused! { n:
            fmi2DoStep(instance, 0.01, INNER, 1);
            fmi2SetReal(instance, &torque, 1, &1.0);
            fmi2Terminate(instance);
        }
        fmi2FreeInstance(instance);
        fmi2FreeInstance(instance);
        fmi2FreeInstance(null_mut());
        let other = fmu.instantiate();
        unknown! { n:
            fmi2Reset(instance);
            fmi2Reset(null_mut());
            fmi2Terminate(16 as *mut c_void);
            fmi2GetReal(instance, &x, 1, &mut value);
            fmi2Reset(other);
        }
        fmi3FreeInstance(other);
    }
    println!("refused calls: {n}");
}
