//! What is packed, and that the packed library computes what the core computes.
#![allow(clippy::unwrap_used)]

use bekker::model::Model;
use bekker_fmu::fmi3::{Instance, LogMessage, Status};
use bekker_fmu_package::{LIBRARY, PLATFORM, export, pack};
use bekker_modeldescription::{Lookup, Parameters};
use libloading::Library;
use std::ffi::{CStr, CString, c_char, c_void};
use std::io::{Cursor, Read};
use std::path::{Path, PathBuf};
use std::ptr::{null, null_mut};
use zip::ZipArchive;

/// The library travels in every FMU and in the Python wheel. It is 1.9 MB, and 3.6 MB with the plant of rigid bodies.
const LARGEST_LIBRARY: usize = 4_000_000;

/// All functions of the standard's header `fmi3Functions.h`, without the prefix.
const FUNCTIONS: &str = "GetVersion SetDebugLogging InstantiateModelExchange InstantiateCoSimulation \
    InstantiateScheduledExecution FreeInstance EnterInitializationMode ExitInitializationMode EnterEventMode \
    Terminate Reset GetFloat32 GetFloat64 GetInt8 GetUInt8 GetInt16 GetUInt16 GetInt32 GetUInt32 GetInt64 \
    GetUInt64 GetBoolean GetString GetBinary GetClock SetFloat32 SetFloat64 SetInt8 SetUInt8 SetInt16 SetUInt16 \
    SetInt32 SetUInt32 SetInt64 SetUInt64 SetBoolean SetString SetBinary SetClock GetNumberOfVariableDependencies \
    GetVariableDependencies GetFMUState SetFMUState FreeFMUState SerializedFMUStateSize SerializeFMUState \
    DeserializeFMUState GetDirectionalDerivative GetAdjointDerivative EnterConfigurationMode ExitConfigurationMode \
    GetIntervalDecimal GetIntervalFraction GetShiftDecimal GetShiftFraction SetIntervalDecimal SetIntervalFraction \
    SetShiftDecimal SetShiftFraction EvaluateDiscreteStates UpdateDiscreteStates EnterContinuousTimeMode \
    CompletedIntegratorStep SetTime SetContinuousStates GetContinuousStateDerivatives GetEventIndicators \
    GetContinuousStates GetNominalsOfContinuousStates GetNumberOfEventIndicators GetNumberOfContinuousStates \
    EnterStepMode GetOutputDerivatives DoStep ActivateModelPartition";

fn preset() -> Model {
    let mut model = Model::preset("two_wheeled").unwrap();
    model.stepping.step_size = 0.001;
    model
}

fn open(fmu: &[u8]) -> ZipArchive<Cursor<&[u8]>> {
    ZipArchive::new(Cursor::new(fmu)).unwrap()
}

fn text(fmu: &[u8], name: &str) -> String {
    let mut text = String::new();
    open(fmu).by_name(name).unwrap().read_to_string(&mut text).unwrap();
    text
}

/// An FMU, unpacked until dropped.
struct Unpacked(PathBuf);

impl Unpacked {
    fn new(test: &str, fmu: &[u8]) -> Self {
        let folder = std::env::temp_dir().join(format!("bekker-package-{}-{test}", std::process::id()));
        open(fmu).extract(&folder).unwrap();
        Self(folder)
    }

    fn library(&self) -> Library {
        let folder = self.0.join("binaries").join(PLATFORM);
        let file = std::fs::read_dir(folder).unwrap().next().unwrap().unwrap().path();
        // SAFETY: our own library; it has no initialisers.
        unsafe { Library::new(file).unwrap() }
    }
}

impl Drop for Unpacked {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

#[test]
fn property_the_same_model_gives_the_same_bytes() {
    let fmu = pack(&preset()).unwrap();
    assert!(fmu == pack(&preset()).unwrap());
    let mut other = preset();
    other.set("soil.cohesion", 1001.0).unwrap();
    assert!(fmu != pack(&other).unwrap());
}

#[test]
fn property_the_archive_has_what_tools_expect() {
    let fmu = pack(&preset()).unwrap();
    let mut archive = open(&fmu);
    let mut raw = |i| String::from_utf8(archive.by_index(i).unwrap().name_raw().to_vec()).unwrap();
    let names: Vec<String> = (0..4).map(&mut raw).collect();
    let library = format!("binaries/{PLATFORM}/two_wheeled.{}", std::env::consts::DLL_EXTENSION);
    let expected = ["modelDescription.xml", &library, "documentation/index.html", "resources/model.toml"];
    assert_eq!((archive.len(), names.as_slice()), (4, expected.map(str::to_owned).as_slice()));
    assert!(text(&fmu, "documentation/index.html").contains("<code>wheel[2].slip</code>"));
}

#[test]
fn property_the_packed_model_is_the_model() {
    let mut model = preset();
    model.set("soil.cohesion", 1234.5).unwrap();
    let fmu = pack(&model).unwrap();
    let mut packed = Model::from_toml(&text(&fmu, "resources/model.toml"), None).unwrap();
    assert_eq!(packed.list(), model.list());
    assert!(text(&fmu, "modelDescription.xml").contains("start=\"1234.5\""));
}

#[test]
fn property_a_file_that_cannot_be_written_is_an_error() {
    let error = export(&preset(), Path::new("/no/such/folder/rover.fmu")).unwrap_err().to_string();
    assert!(error.contains("/no/such/folder/rover.fmu"), "{error}");
}

#[test]
fn property_the_library_is_small_and_whole() {
    assert!(LIBRARY.len() < LARGEST_LIBRARY, "{} bytes", LIBRARY.len());
    let unpacked = Unpacked::new("whole", &pack(&preset()).unwrap());
    let library = unpacked.library();
    let names: Vec<&str> = FUNCTIONS.split_whitespace().collect();
    assert_eq!(names.len(), 75);
    for name in names {
        // SAFETY: only looked up.
        unsafe { library.get::<*const c_void>(format!("fmi3{name}\0").as_bytes()) }.expect(name);
    }
}

type Instantiate = unsafe extern "C" fn(
    *const c_char,
    *const c_char,
    *const c_char,
    u8,
    u8,
    u8,
    u8,
    *const u32,
    usize,
    *mut c_void,
    LogMessage,
    *const c_void,
) -> Instance;
type Enter = unsafe extern "C" fn(Instance, u8, f64, f64, u8, f64) -> Status;
type Plain = unsafe extern "C" fn(Instance) -> Status;
type Get = unsafe extern "C" fn(Instance, *const u32, usize, *mut f64, usize) -> Status;
type Set = unsafe extern "C" fn(Instance, *const u32, usize, *const f64, usize) -> Status;
type DoStep = unsafe extern "C" fn(Instance, f64, f64, u8, *mut bool, *mut bool, *mut bool, *mut f64) -> Status;

unsafe extern "C" fn log(_: *mut c_void, status: Status, _: *const c_char, message: *const c_char) {
    // SAFETY: the library passes a NUL-terminated text.
    println!("{status:?}: {}", unsafe { CStr::from_ptr(message) }.to_string_lossy());
}

/// The packed library is optimised and linked otherwise than this test, and it finds its resources from
/// its own place, as no path is given; yet it computes the same bits.
#[test]
fn agreement_of_the_packed_library_with_the_core() {
    let model = preset();
    let unpacked = Unpacked::new("agreement", &pack(&model).unwrap());
    let library = unpacked.library();
    let (_, description) = bekker_fmu::describe(&model).unwrap();
    let token = CString::new(description.fmi3_token().unwrap()).unwrap();
    let place = |name: &str| description.entries.iter().position(|entry| entry.variable.name == name).unwrap() as u32;
    let inputs = [place("wheel[1].torque_command"), place("wheel[2].torque_command")];
    let mut run = model.start().unwrap();
    let mut signals = run.signals().clone();
    let outputs: Vec<u32> = signals.list().iter().map(|(variable, _)| place(&variable.name)).collect();
    // SAFETY: the types above are those of the standard's header; pointers come from slices and locals.
    unsafe {
        let instantiate = library.get::<Instantiate>(b"fmi3InstantiateCoSimulation\0").unwrap();
        let (name, token) = (c"rover".as_ptr(), token.as_ptr());
        let instance = instantiate(name, token, null(), 0, 1, 0, 0, null(), 0, null_mut(), Some(log), null());
        assert!(!instance.is_null());
        let enter = library.get::<Enter>(b"fmi3EnterInitializationMode\0").unwrap();
        assert_eq!(enter(instance, 0, 0.0, 0.0, 0, 0.0), Status::Ok);
        assert_eq!(library.get::<Plain>(b"fmi3ExitInitializationMode\0").unwrap()(instance), Status::Ok);
        let set = library.get::<Set>(b"fmi3SetFloat64\0").unwrap();
        let step = library.get::<DoStep>(b"fmi3DoStep\0").unwrap();
        let get = library.get::<Get>(b"fmi3GetFloat64\0").unwrap();
        for k in 0..100 {
            let torques = [1.2 + 0.01 * f64::from(k), 2.0 - 0.005 * f64::from(k)];
            assert_eq!(set(instance, inputs.as_ptr(), 2, torques.as_ptr(), 2), Status::Ok);
            run.inputs_mut().set_all(&torques).unwrap();
            let (mut a, mut b, mut c, mut time) = (false, false, false, 0.0);
            let status = step(instance, f64::from(k) * 0.01, 0.01, 1, &mut a, &mut b, &mut c, &mut time);
            assert_eq!(status, Status::Ok);
            run.advance(10).unwrap();
            let mut expected = Vec::new();
            run.signals().values(&mut |value| expected.push(value.to_bits()));
            let mut values = vec![0.0; outputs.len()];
            assert_eq!(get(instance, outputs.as_ptr(), outputs.len(), values.as_mut_ptr(), outputs.len()), Status::Ok);
            let found: Vec<u64> = values.iter().map(|value| value.to_bits()).collect();
            assert_eq!(found, expected, "step {k}");
        }
        library.get::<unsafe extern "C" fn(Instance)>(b"fmi3FreeInstance\0").unwrap()(instance);
    }
    assert!(run.signals().body.velocity > 1e-3, "the rover has moved");
}
