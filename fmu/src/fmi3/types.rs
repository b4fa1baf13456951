//! The C types of FMI 3.0 (`fmi3PlatformTypes.h`, `fmi3FunctionTypes.h`).

use crate::border::Status;
use crate::border::logger::Sink;
use std::ffi::{CStr, c_char, c_void};

/// `fmi3InstanceEnvironment`: the importer's, handed back in callbacks and never followed.
pub type Environment = *mut c_void;

/// `fmi3Boolean` as an argument: a byte, since C may pass others than 0 and 1.
pub type Boolean = u8;

/// `fmi3LogMessageCallback`.
pub type LogMessage = Option<
    unsafe extern "C" fn(environment: Environment, status: Status, category: *const c_char, message: *const c_char),
>;

/// `fmi3IntermediateUpdateCallback`, not NULL.
pub type Callback = unsafe extern "C" fn(
    environment: Environment,
    time: f64,
    set_requested: bool,
    get_allowed: bool,
    step_finished: bool,
    can_return_early: bool,
    early_return_requested: *mut Boolean,
    early_return_time: *mut f64,
);

/// `fmi3IntermediateUpdateCallback`.
pub type IntermediateUpdate = Option<Callback>;

/// The importer's log function with its environment.
pub(super) struct Messages(pub LogMessage, pub Environment);

// SAFETY: the environment is only handed back to the importer's callback, on the thread of the
// importer's own call; the standard makes the importer responsible for what it is.
unsafe impl Send for Messages {}

impl Sink for Messages {
    fn send(&self, status: Status, category: &CStr, message: &CStr) {
        let Some(callback) = self.0 else { return };
        // SAFETY: the importer's function, called on the thread of its own call; the texts live until
        // it returns.
        unsafe { callback(self.1, status, category.as_ptr(), message.as_ptr()) };
    }
}

/// The intermediate updates that the importer requests during a step.
#[derive(Clone, Copy)]
pub(super) struct Updates {
    pub callback: IntermediateUpdate,
    pub environment: Environment,
    pub early_return: bool,
}

// SAFETY: as for `Messages`.
unsafe impl Send for Updates {}
