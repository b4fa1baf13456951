//! One instance of an FMU, whatever the version of its standard.

use crate::archive::Fmu;
use crate::description::{Kind, Version};
use crate::{ImportError, fmi2, fmi3};
use libloading::Library;
use std::cell::RefCell;
use std::ffi::{CStr, c_char, c_int};

/// Where a communication step arrived.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Progress {
    /// Time reached, s.
    pub time: f64,
    /// Whether the FMU requests the end of the simulation.
    pub ended: bool,
}

/// The functions of one version, on one instance.
pub(crate) trait Functions {
    fn enter_initialization(&self, start: f64) -> Result<(), ImportError>;
    fn exit_initialization(&self) -> Result<(), ImportError>;
    fn set_reals(&self, references: &[u32], values: &[f64]) -> Result<(), ImportError>;
    fn get_reals(&self, references: &[u32], values: &mut [f64]) -> Result<(), ImportError>;
    fn get_integer(&self, reference: u32) -> Result<i64, ImportError>;
    fn step(&self, time: f64, size: f64) -> Result<Progress, ImportError>;
    fn reset(&self) -> Result<(), ImportError>;
}

/// An instance for co-simulation, driven call by call.
pub struct Slave<'a> {
    // Freed before the library behind its functions is unloaded: fields are dropped in order.
    functions: Box<dyn Functions>,
    _library: Library,
    fmu: &'a Fmu,
}

impl<'a> Slave<'a> {
    /// Loads the library and makes an instance, which waits to be started.
    ///
    /// # Errors
    /// [`ImportError`] where the FMU has no library for this system, or gives no instance.
    pub fn new(fmu: &'a Fmu) -> Result<Self, ImportError> {
        let file = fmu.library()?;
        // SAFETY: loading runs the initialisers of a library that the user has chosen to run.
        let library = unsafe { Library::new(&file) }
            .map_err(|error| ImportError::Library(format!("it does not load: {error}")))?;
        let functions: Box<dyn Functions> = match fmu.description.version {
            Version::Fmi2 => Box::new(fmi2::Instance::new(&library, fmu)?),
            Version::Fmi3 => Box::new(fmi3::Instance::new(&library, fmu)?),
        };
        Ok(Self { functions, _library: library, fmu })
    }

    /// Value reference of a variable of that type.
    ///
    /// # Errors
    /// [`ImportError::Unknown`], [`ImportError::Type`].
    pub fn reference(&self, name: &str, kind: Kind) -> Result<u32, ImportError> {
        let variables = &self.fmu.description.variables;
        let found = variables.get(name).ok_or_else(|| ImportError::Unknown(name.to_owned()))?;
        if found.kind == kind {
            Ok(found.reference)
        } else {
            Err(ImportError::Type { name: name.to_owned(), found: found.kind.word(), expected: kind.word() })
        }
    }

    /// Initialises the instance at time 0, s.
    ///
    /// # Errors
    /// [`ImportError::Call`].
    pub fn start(&mut self) -> Result<(), ImportError> {
        self.functions.enter_initialization(0.0)?;
        self.functions.exit_initialization()
    }

    /// Sets real numbers.
    ///
    /// # Errors
    /// [`ImportError::Call`].
    pub fn set(&mut self, references: &[u32], values: &[f64]) -> Result<(), ImportError> {
        if references.is_empty() { Ok(()) } else { self.functions.set_reals(references, values) }
    }

    /// Reads real numbers.
    ///
    /// # Errors
    /// [`ImportError::Call`].
    pub fn get(&mut self, references: &[u32], values: &mut [f64]) -> Result<(), ImportError> {
        if references.is_empty() { Ok(()) } else { self.functions.get_reals(references, values) }
    }

    /// Reads an integer or enumeration.
    ///
    /// # Errors
    /// [`ImportError::Call`].
    pub fn integer(&mut self, reference: u32) -> Result<i64, ImportError> {
        self.functions.get_integer(reference)
    }

    /// A communication step of `size` from `time`, s.
    ///
    /// # Errors
    /// [`ImportError::Call`].
    pub fn step(&mut self, time: f64, size: f64) -> Result<Progress, ImportError> {
        self.functions.step(time, size)
    }

    /// Puts the instance where it was when it was made.
    ///
    /// # Errors
    /// [`ImportError::Call`].
    pub fn reset(&mut self) -> Result<(), ImportError> {
        self.functions.reset()
    }
}

thread_local! {
    static LOG: RefCell<Vec<String>> = const { RefCell::new(Vec::new()) };
}

/// What the FMU has logged on this thread since the last call, after a colon.
pub(crate) fn logged() -> String {
    LOG.with_borrow_mut(|log| log.drain(..).map(|line| format!(": {line}")).collect())
}

/// Keeps a message; only errors are asked for.
pub(crate) fn keep(message: *const c_char) {
    if !message.is_null() {
        // SAFETY: the standard has FMUs pass NUL-terminated texts.
        let text = unsafe { CStr::from_ptr(message) }.to_string_lossy().into_owned();
        LOG.with_borrow_mut(|log| log.push(text));
    }
}

/// What a function returned: 0 fine, 1 fine with a warning.
pub(crate) fn checked(function: &'static str, status: c_int) -> Result<(), ImportError> {
    let word = match status {
        0 | 1 => {
            logged();
            return Ok(());
        }
        2 => "discarded",
        3 => "error",
        4 => "fatal error",
        _ => "pending, or a status that does not exist",
    };
    Err(ImportError::Call { function, status: word, log: logged() })
}

/// A function of the library.
///
/// # Safety
/// `F` must be the type of the function of that name.
pub(crate) unsafe fn symbol<F: Copy>(library: &Library, name: &'static str) -> Result<F, ImportError> {
    // SAFETY: by the caller's promise.
    let found = unsafe { library.get::<F>(name.as_bytes()) };
    found.map(|symbol| *symbol).map_err(|_| ImportError::Library(format!("the library has no function {name}")))
}
