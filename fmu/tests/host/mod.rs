//! A simulation tool in miniature: it calls the C functions and keeps what they log.
#![allow(dead_code, clippy::unwrap_used)]

use bekker::model::Model;
use bekker_fmu::fmi2::{
    self, fmi2EnterInitializationMode, fmi2ExitInitializationMode, fmi2Instantiate, fmi2SetupExperiment,
};
use bekker_fmu::fmi3::*;
use bekker_fmu::{Kind, Offer};
use bekker_modeldescription::xml::Description;
use std::cell::RefCell;
use std::ffi::{CStr, CString, c_char, c_void};
use std::path::{Path, PathBuf};
use std::ptr::{null, null_mut};
use std::sync::atomic::{AtomicU32, Ordering};

thread_local! {
    static LOG: RefCell<Vec<String>> = const { RefCell::new(Vec::new()) };
}

/// What has been logged on this thread since the last call.
pub fn messages() -> Vec<String> {
    LOG.with_borrow_mut(std::mem::take)
}

pub unsafe extern "C" fn log(_: *mut c_void, status: Status, category: *const c_char, message: *const c_char) {
    // SAFETY: the library passes NUL-terminated texts.
    let [category, message] = [category, message].map(|text| unsafe { CStr::from_ptr(text) }.to_string_lossy());
    LOG.with_borrow_mut(|log| log.push(format!("{status:?} {category}: {message}")));
}

/// The logger of FMI 2.0. Its C type is variadic, which a Rust function cannot be; the messages ask for no arguments,
/// and the calling conventions of all our targets pass the named ones alike.
unsafe extern "C" fn log2(
    environment: *mut c_void,
    _: *const c_char,
    status: Status,
    category: *const c_char,
    message: *const c_char,
) {
    // SAFETY: the library passes NUL-terminated texts.
    unsafe { log(environment, status, category, message) }
}

/// The callbacks of FMI 2.0.
pub fn callbacks() -> fmi2::Callbacks {
    // SAFETY: see `log2`.
    let logger = unsafe { std::mem::transmute::<*const c_void, fmi2::Log>(log2 as *const c_void) };
    fmi2::Callbacks {
        logger,
        allocate_memory: null(),
        free_memory: null(),
        step_finished: null(),
        environment: null_mut(),
    }
}

/// Inner step of all models here, s.
pub const INNER: f64 = 0.001;

/// A built-in model with the inner step [`INNER`].
pub fn model(preset: &str) -> Model {
    let mut model = Model::preset(preset).unwrap();
    model.stepping.step_size = INNER;
    model
}

/// An unpacked FMU.
pub struct Fmu {
    folder: PathBuf,
    pub description: Description,
}

impl Fmu {
    pub fn new(model: &Model) -> Self {
        Self::of_kind(model, Kind::usual(model))
    }

    /// What `kind` says of a model.
    pub fn of_kind(model: &Model, kind: Kind) -> Self {
        Self::offering(model, kind)
    }

    /// What an FMU with this offer has.
    pub fn offering(model: &Model, offer: impl Into<Offer>) -> Self {
        static COUNT: AtomicU32 = AtomicU32::new(0);
        let number = COUNT.fetch_add(1, Ordering::Relaxed);
        let folder = std::env::temp_dir().join(format!("bekker-fmu-{}-{number}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        let (text, description) = bekker_fmu::describe_as(model, offer).unwrap();
        std::fs::write(folder.join("model.toml"), text).unwrap();
        Self { folder, description }
    }

    pub fn preset(name: &str) -> Self {
        Self::new(&model(name))
    }

    pub fn folder(&self) -> &Path {
        &self.folder
    }

    pub fn resources(&self) -> CString {
        CString::new(self.folder.to_str().unwrap()).unwrap()
    }

    pub fn token(&self) -> CString {
        CString::new(self.description.token().unwrap()).unwrap()
    }

    pub fn reference(&self, name: &str) -> u32 {
        let place = self.description.entries.iter().position(|entry| entry.variable.name == name);
        u32::try_from(place.unwrap_or_else(|| panic!("no variable {name}"))).unwrap()
    }

    /// A new instance, or NULL.
    pub fn instantiate(&self) -> Instance {
        instantiate(c"rover", Some(&self.token()), Some(&self.resources()))
    }

    /// A new instance of FMI 2.0 for co-simulation, or NULL.
    pub fn instantiate2(&self) -> Instance {
        let uri = CString::new(format!("file://{}", self.folder.to_str().unwrap())).unwrap();
        // SAFETY: texts and callbacks that live through the call.
        unsafe { fmi2Instantiate(c"rover".as_ptr(), 1, self.token().as_ptr(), uri.as_ptr(), &callbacks(), 0, 1) }
    }

    /// A new instance of FMI 2.0 in step mode at time 0.
    pub fn running2(&self) -> Instance {
        let instance = self.instantiate2();
        assert_eq!(fmi2SetupExperiment(instance, 0, 0.0, 0.0, 0, 0.0), Status::Ok, "{:?}", messages());
        assert_eq!(fmi2EnterInitializationMode(instance), Status::Ok, "{:?}", messages());
        assert_eq!(fmi2ExitInitializationMode(instance), Status::Ok, "{:?}", messages());
        instance
    }

    /// A new instance in step mode at time 0.
    pub fn running(&self) -> Instance {
        let instance = self.instantiate();
        assert_eq!(fmi3EnterInitializationMode(instance, 0, 0.0, 0.0, 0, 0.0), Status::Ok, "{:?}", messages());
        assert_eq!(fmi3ExitInitializationMode(instance), Status::Ok, "{:?}", messages());
        instance
    }
}

impl Drop for Fmu {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.folder);
    }
}

/// `fmi3InstantiateCoSimulation` with the usual arguments.
pub fn instantiate(name: &CStr, token: Option<&CStr>, resources: Option<&CStr>) -> Instance {
    let pointer = |text: Option<&CStr>| text.map_or(null(), CStr::as_ptr);
    // SAFETY: texts that live through the call, and NULL where the standard allows it.
    unsafe {
        fmi3InstantiateCoSimulation(
            name.as_ptr(),
            pointer(token),
            pointer(resources),
            0,
            1,
            0,
            0,
            null(),
            0,
            null_mut(),
            Some(log),
            None,
        )
    }
}

pub fn get(instance: Instance, references: &[u32]) -> Result<Vec<f64>, Status> {
    let mut values = vec![f64::NAN; references.len()];
    let (n, place) = (references.len(), values.as_mut_ptr());
    // SAFETY: `n` references and `n` places.
    match unsafe { fmi3GetFloat64(instance, references.as_ptr(), n, place, n) } {
        Status::Ok => Ok(values),
        status => Err(status),
    }
}

pub fn set(instance: Instance, references: &[u32], values: &[f64]) -> Status {
    // SAFETY: pointers and lengths of slices.
    unsafe { fmi3SetFloat64(instance, references.as_ptr(), references.len(), values.as_ptr(), values.len()) }
}

/// What `fmi3DoStep` returns.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stepped {
    pub status: Status,
    pub event: bool,
    pub terminate: bool,
    pub early: bool,
    pub time: f64,
}

pub fn step(instance: Instance, current: f64, size: f64) -> Stepped {
    let (mut event, mut terminate, mut early, mut time) = (true, true, true, f64::NAN);
    // SAFETY: four valid places.
    let status = unsafe { fmi3DoStep(instance, current, size, 1, &mut event, &mut terminate, &mut early, &mut time) };
    Stepped { status, event, terminate, early, time }
}
