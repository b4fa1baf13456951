//! What is packed, and that the packed library computes what the core computes.
#![allow(clippy::unwrap_used)]

use bekker::model::Model;
use bekker_fmu::fmi3::{Instance, LogMessage, Status};
use bekker_fmu_package::{ExportError, Kind, LIBRARY, Options, RIGID_LIBRARY, Version, export};
use bekker_modeldescription::{Lookup, Parameters};
use libloading::Library;
use std::ffi::{CStr, CString, c_char, c_void};
use std::io::{Cursor, Read};
use std::path::{Path, PathBuf};
use std::ptr::{null, null_mut};
use zip::ZipArchive;

/// The libraries travel in the Python wheel, and one of them in every FMU. Of this one the equations far from the motion, the
/// check whether an integrator follows them, integers and dependencies take about 20 kB; RTC with wheel-speed loops, with the stress
/// integrals solved for sinkage and slip, and the filter of the ground about 100 kB; a wheel that flattens under its own normal force and
/// the stops of joints a few kB; then come rocks on random ground, with the sampler of their number, and the slip to which the ground
/// under a wheel is dug, a state more with its law and its derivatives, 2 to 3 kB; other laws of slip-sinkage and arcs of
/// the flexible wheel, four parameters, 8 kB; and the part of rolling resistance that grows with the root of the load, one
/// parameter in every form of the contact, 5.5 kB.
const LARGEST_LIBRARY: usize = 2_307_000;
/// Rapier, 4.4 MB, and wheels on a carriage with exact slopes through all effects, 0.45 MB.
const LARGEST_RIGID_LIBRARY: usize = 5_000_000;

/// The FMU of a model in FMI 3.0.
fn pack(model: &Model) -> Result<Vec<u8>, ExportError> {
    bekker_fmu_package::pack(model, &Options::default())
}

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

/// All functions of the header `fmi2Functions.h`, without the prefix.
const FUNCTIONS_2: &str = "GetTypesPlatform GetVersion SetDebugLogging Instantiate FreeInstance SetupExperiment \
    EnterInitializationMode ExitInitializationMode Terminate Reset GetReal GetInteger GetBoolean GetString SetReal \
    SetInteger SetBoolean SetString GetFMUstate SetFMUstate FreeFMUstate SerializedFMUstateSize SerializeFMUstate \
    DeSerializeFMUstate GetDirectionalDerivative EnterEventMode NewDiscreteStates EnterContinuousTimeMode \
    CompletedIntegratorStep SetTime SetContinuousStates GetDerivatives GetEventIndicators GetContinuousStates \
    GetNominalsOfContinuousStates SetRealInputDerivatives GetRealOutputDerivatives DoStep CancelStep GetStatus \
    GetRealStatus GetIntegerStatus GetBooleanStatus GetStringStatus";

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
        let folder = self.0.join("binaries").join(Version::Fmi3.platform());
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

fn names(fmu: &[u8]) -> Vec<String> {
    let mut archive = open(fmu);
    (0..archive.len()).map(|i| String::from_utf8(archive.by_index(i).unwrap().name_raw().to_vec()).unwrap()).collect()
}

#[test]
fn property_the_archive_has_what_tools_expect() {
    let fmu = pack(&preset()).unwrap();
    let (platform, extension) = (Version::Fmi3.platform(), std::env::consts::DLL_EXTENSION);
    let library = format!("binaries/{platform}/two_wheeled.{extension}");
    let common =
        ["documentation/index.html", "documentation/licenses/license.txt", "documentation/licenses/third-party.txt"];
    let own = ["terminalsAndIcons.xml", "icon.png", "icon.svg"].map(|name| format!("terminalsAndIcons/{name}"));
    let mut expected = vec!["modelDescription.xml", &library];
    expected.extend(common);
    expected.extend(own.iter().map(String::as_str));
    expected.push("resources/model.toml");
    assert_eq!(names(&fmu), expected);
    assert!(text(&fmu, "documentation/index.html").contains("<code>wheel[2].slip</code>"));
    assert!(text(&fmu, "terminalsAndIcons/terminalsAndIcons.xml").contains("<Terminal name=\"wheel[2]\""));
    assert!(text(&fmu, "documentation/licenses/license.txt").contains("Apache License"));

    let fmu =
        bekker_fmu_package::pack(&preset(), &Options { version: Some(Version::Fmi2), ..Options::default() }).unwrap();
    let library = format!("binaries/{}/two_wheeled.{extension}", Version::Fmi2.platform());
    let mut expected = vec!["modelDescription.xml", &library];
    expected.extend(common);
    expected.extend(["model.png", "resources/model.toml"]);
    assert_eq!(names(&fmu), expected);
    assert!(text(&fmu, "modelDescription.xml").contains("fmiVersion=\"2.0\""));
}

/// A file with the header of a library of this kind and the name of a function of an FMU; no library for all that.
fn library_file(name: &str, header: &[u8]) -> std::path::PathBuf {
    let file = std::env::temp_dir().join(format!("bekker-package-{}-{name}", std::process::id()));
    let mut content = header.to_vec();
    content.resize(256, 0);
    content.extend_from_slice(b"fmi3InstantiateCoSimulation");
    std::fs::write(&file, content).unwrap();
    file
}

#[test]
fn property_libraries_for_other_platforms_are_packed_at_their_places() {
    let mut windows = vec![0; 0x86];
    windows[..2].copy_from_slice(b"MZ");
    windows[0x3c] = 0x80;
    windows[0x80..].copy_from_slice(b"PE\0\0\x64\x86");
    let windows = library_file("a.dll", &windows);
    let mac = library_file("a.dylib", b"\xcf\xfa\xed\xfe\x0c\0\0\x01");
    for (version, places) in [
        (Version::Fmi2, ["win64/two_wheeled.dll", "aarch64-darwin/two_wheeled.dylib"]),
        (Version::Fmi3, ["x86_64-windows/two_wheeled.dll", "aarch64-darwin/two_wheeled.dylib"]),
    ] {
        let libraries = vec![windows.clone(), mac.clone()];
        let options = Options { version: Some(version), libraries, ..Options::default() };
        let fmu = bekker_fmu_package::pack(&preset(), &options).unwrap();
        for (place, file) in places.into_iter().zip([&windows, &mac]) {
            let mut packed = Vec::new();
            open(&fmu).by_name(&format!("binaries/{place}")).unwrap().read_to_end(&mut packed).unwrap();
            assert_eq!(packed, std::fs::read(file).unwrap());
        }
        let extension = std::env::consts::DLL_EXTENSION;
        assert!(names(&fmu).contains(&format!("binaries/{}/two_wheeled.{extension}", version.platform())));
    }
    let refused = |libraries: Vec<std::path::PathBuf>| {
        bekker_fmu_package::pack(&preset(), &Options { libraries, ..Options::default() }).unwrap_err().to_string()
    };
    let twice = refused(vec![windows.clone(), windows.clone()]);
    assert!(twice.contains("a library for x86_64 windows already"), "{twice}");
    let other = std::env::temp_dir().join(format!("bekker-package-{}.txt", std::process::id()));
    std::fs::write(&other, b"a text").unwrap();
    assert!(refused(vec![other.clone()]).contains("expected a library of FMUs"));
    for file in [&windows, &mac, &other] {
        std::fs::remove_file(file).unwrap();
    }
    let options = Options { libraries: vec![windows], ..Options::default() };
    let error = bekker_fmu_package::pack(&preset(), &options).unwrap_err();
    assert!(matches!(error, ExportError::Read { .. }), "{error}");
}

#[test]
fn property_a_system_is_honoured_or_refused_with_a_reason() {
    let pack = |preset: &str, options: &Options| {
        let model = preset_named(preset);
        bekker_fmu_package::pack_system(&model, options).map_err(|error| error.to_string())
    };
    let package = pack("gentle_rtc", &Options::default()).unwrap();
    let expected = ["SystemStructure.ssd", "resources/controller.fmu", "resources/rover.fmu", "resources/soil.ssv"];
    assert_eq!(names(&package), expected);
    let structure = text(&package, "SystemStructure.ssd");
    assert_eq!(structure.matches("resources/soil.ssv").count(), 2, "both FMUs have one soil");
    assert!(!structure.contains("<ssd:Connection startConnector"));
    assert!(text(&package, "resources/soil.ssv").contains("soil.cohesion"));
    let with_inputs = pack("gentle_rtc", &Options { system_inputs: true, ..Options::default() }).unwrap();
    assert!(text(&with_inputs, "SystemStructure.ssd").contains("<ssd:Connection startConnector=\"velocity_command\""));
    for (preset, options, reason) in [
        ("gentle_rtc", Options { version: Some(Version::Fmi3), ..Options::default() }, "FMI 2.0"),
        ("gentle_rtc", Options { kind: Some(Kind::Rover), ..Options::default() }, "asks for one FMU"),
        ("gentle_rtc", Options { arrays: true, ..Options::default() }, "no arrays"),
        ("two_wheeled", Options::default(), "no controller"),
        ("two_wheeled_speed", Options::default(), "no controller"),
    ] {
        let refused = pack(preset, &options).unwrap_err();
        assert!(refused.contains(reason), "{refused}");
    }
    for preset in ["two_wheeled", "two_wheeled_speed"] {
        let options = Options { kind: Some(Kind::Controller), ..Options::default() };
        let refused = bekker_fmu_package::pack(&preset_named(preset), &options).unwrap_err().to_string();
        assert!(refused.contains("no controller that an FMU of its own can be"), "{refused}");
    }
    let refused =
        bekker_fmu_package::pack(&preset_named("gentle_rtc"), &Options { system_inputs: true, ..Options::default() });
    assert!(refused.unwrap_err().to_string().contains("system"));
}

fn preset_named(name: &str) -> Model {
    Model::preset(name).unwrap()
}

#[test]
fn property_the_icon_is_a_picture() {
    let fmu = pack(&preset()).unwrap();
    let mut bytes = Vec::new();
    open(&fmu).by_name("terminalsAndIcons/icon.png").unwrap().read_to_end(&mut bytes).unwrap();
    assert_eq!(&bytes[..16], b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR");
    // Every chunk's checksum (ISO 15948, 5.3) covers its name and content.
    let mut rest = &bytes[8..];
    let mut names = Vec::new();
    while let Some((length, after)) = rest.split_first_chunk::<4>() {
        let (body, after) = after.split_at(4 + u32::from_be_bytes(*length) as usize);
        let (sum, after) = after.split_first_chunk::<4>().unwrap();
        let mut crc = flate2::Crc::new();
        crc.update(body);
        assert_eq!(u32::from_be_bytes(*sum), crc.sum());
        names.push(String::from_utf8_lossy(&body[..4]).into_owned());
        rest = after;
    }
    assert_eq!(names, ["IHDR", "IDAT", "IEND"]);
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
    let error = export(&preset(), &Options::default(), Path::new("/no/such/folder/rover.fmu")).unwrap_err().to_string();
    assert!(error.contains("/no/such/folder/rover.fmu"), "{error}");
}

#[test]
fn property_the_libraries_name_no_folder_of_this_machine() {
    let holds = |library: &[u8], words: &[u8]| library.windows(words.len()).any(|window| window == words);
    for library in [Some(LIBRARY), RIGID_LIBRARY].into_iter().flatten() {
        assert!(holds(library, b"clarabel-"), "messages of panics name the sources of crates");
        assert!(
            !holds(library, b"registry/src"),
            "messages of panics name folders of the machine that built the library"
        );
    }
}

#[test]
fn property_the_library_is_small_and_whole() {
    assert!(LIBRARY.len() < LARGEST_LIBRARY, "{} bytes", LIBRARY.len());
    assert!(RIGID_LIBRARY.is_none_or(|library| library.len() < LARGEST_RIGID_LIBRARY), "too large");
    let unpacked = Unpacked::new("whole", &pack(&preset()).unwrap());
    let library = unpacked.library();
    let names: Vec<&str> = FUNCTIONS.split_whitespace().collect();
    assert_eq!(names.len(), 75);
    for name in names {
        // SAFETY: only looked up.
        unsafe { library.get::<*const c_void>(format!("fmi3{name}\0").as_bytes()) }.expect(name);
    }
    let names: Vec<&str> = FUNCTIONS_2.split_whitespace().collect();
    assert_eq!(names.len(), 44);
    for name in names {
        // SAFETY: only looked up.
        unsafe { library.get::<*const c_void>(format!("fmi2{name}\0").as_bytes()) }.expect(name);
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
    let token = CString::new(description.token().unwrap()).unwrap();
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

#[cfg(target_os = "linux")]
mod linux {
    use super::*;

    /// What every Linux has, all parts of glibc: before 2.34 it kept threads and the dynamic loader apart.
    const SYSTEM: [&str; 5] = ["libc.so.6", "libm.so.6", "libpthread.so.0", "libdl.so.2", "ld-linux-x86-64.so.2"];

    /// Names of the libraries that an ELF library (64 bit, little-endian) needs: the entries DT_NEEDED (1) of its
    /// dynamic section, whose texts lie in the table DT_STRTAB (5).
    fn needed(library: &[u8]) -> Vec<String> {
        let number = |at: usize| u64::from_le_bytes(library[at..at + 8].try_into().unwrap()) as usize;
        let half = |at: usize| usize::from(u16::from_le_bytes(library[at..at + 2].try_into().unwrap()));
        let headers: Vec<usize> = (0..half(56)).map(|k| number(32) + k * half(54)).collect();
        let kind = |at: usize| u32::from_le_bytes(library[at..at + 4].try_into().unwrap());
        let dynamic = headers.iter().find(|at| kind(**at) == 2).map(|at| (number(at + 8), number(at + 32))).unwrap();
        let entries: Vec<(usize, usize)> =
            (0..dynamic.1 / 16).map(|k| (number(dynamic.0 + 16 * k), number(dynamic.0 + 16 * k + 8))).collect();
        let address = entries.iter().find(|(tag, _)| *tag == 5).unwrap().1;
        let segment = headers
            .iter()
            .find(|at| kind(**at) == 1 && (number(*at + 16)..number(*at + 16) + number(*at + 32)).contains(&address));
        let texts = segment.map(|at| address - number(at + 16) + number(at + 8)).unwrap();
        let text = |at: usize| CStr::from_bytes_until_nul(&library[texts + at..]).unwrap().to_str().unwrap().to_owned();
        entries.iter().filter(|(tag, _)| *tag == 1).map(|(_, at)| text(*at)).collect()
    }

    #[test]
    fn property_the_libraries_need_nothing_but_the_system() {
        for library in [Some(LIBRARY), RIGID_LIBRARY].into_iter().flatten() {
            let needed = needed(library);
            assert!(needed.contains(&"libc.so.6".to_owned()), "{needed:?}");
            for name in &needed {
                assert!(SYSTEM.contains(&name.as_str()), "{needed:?}");
            }
        }
    }
}
