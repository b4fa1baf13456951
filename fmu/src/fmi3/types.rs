//! The C types of FMI 3.0 (`fmi3PlatformTypes.h`, `fmi3FunctionTypes.h`).

use std::ffi::{c_char, c_void};

/// `fmi3Instance`: a handle.
pub type Instance = *mut c_void;

/// `fmi3FMUState`: a handle.
pub type FmuState = *mut c_void;

/// `fmi3InstanceEnvironment`: the importer's, handed back in callbacks and never followed.
pub type Environment = *mut c_void;

/// `fmi3Boolean` as an argument: a byte, since C may pass others than 0 and 1.
pub type Boolean = u8;

/// `fmi3Status`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(C)]
pub enum Status {
    /// All well.
    Ok,
    /// Carried out with a reservation; see the log.
    Warning,
    /// Not carried out; the importer may try otherwise.
    Discard,
    /// Not carried out; see the log.
    Error,
    /// The library is unusable.
    Fatal,
}

/// `fmi3LogMessageCallback`.
pub type LogMessage = Option<
    unsafe extern "C" fn(environment: Environment, status: Status, category: *const c_char, message: *const c_char),
>;

/// `fmi3IntermediateUpdateCallback`; never called, the FMU does not offer intermediate updates.
pub type IntermediateUpdate = Option<unsafe extern "C" fn()>;
