//! The C types of FMI 2.0 (`fmi2TypesPlatform.h`, `fmi2FunctionTypes.h`), and the instances.

use crate::border::Status;
use crate::border::instance::{self, Component, Instance};
use crate::border::logger::Sink;
use crate::handles::Registry;
use crate::lifecycle::Refusal;
use std::ffi::{CStr, CString, c_char, c_int, c_void};

/// `fmi2Boolean`: any number but 0 is true.
pub type Boolean = c_int;

/// `fmi2CallbackLogger`: variadic, as its message is a format of `printf`.
pub type Log = Option<
    unsafe extern "C" fn(
        environment: *mut c_void,
        instance: *const c_char,
        status: Status,
        category: *const c_char,
        message: *const c_char,
        ...
    ),
>;

/// `fmi2CallbackFunctions`.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct Callbacks {
    /// Takes messages; may be NULL.
    pub logger: Log,
    /// Not used, memory is the library's own.
    pub allocate_memory: *const c_void,
    /// Not used.
    pub free_memory: *const c_void,
    /// Not used, steps are not asynchronous.
    pub step_finished: *const c_void,
    /// Handed back to the logger and never followed.
    pub environment: *mut c_void,
}

/// `fmi2EventInfo`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct EventInfo {
    /// Whether the event needs another round.
    pub new_discrete_states_needed: Boolean,
    /// Whether the simulation has to end.
    pub terminate_simulation: Boolean,
    /// Whether nominal values of states have changed.
    pub nominals_of_continuous_states_changed: Boolean,
    /// Whether states have changed.
    pub values_of_continuous_states_changed: Boolean,
    /// Whether `next_event_time` is one.
    pub next_event_time_defined: Boolean,
    /// When the next event of time comes, s.
    pub next_event_time: f64,
}

/// The importer's log function with its environment and the name of the instance.
pub(super) struct Messages {
    pub log: Log,
    pub environment: *mut c_void,
    pub name: CString,
}

// SAFETY: the environment is only handed back to the importer's callback, on the thread of the
// importer's own call; the standard makes the importer responsible for what it is.
unsafe impl Send for Messages {}

impl Sink for Messages {
    fn send(&self, status: Status, category: &CStr, message: &CStr) {
        let Some(log) = self.log else { return };
        // The message is a format: a percent sign would ask for an argument. `#` begins and ends value references.
        let plain = message.to_string_lossy().replace('%', "%%").replace('#', "##");
        let plain = CString::new(plain).unwrap_or_default();
        // SAFETY: the importer's function, called on the thread of its own call; the texts live until it returns,
        // and the format asks for no arguments.
        unsafe { log(self.environment, self.name.as_ptr(), status, category.as_ptr(), plain.as_ptr()) };
    }
}

/// How the last communication step went, for the status functions.
#[derive(Clone, Copy)]
pub(super) struct Last {
    pub status: Status,
}

/// All instances of this process.
pub(super) static INSTANCES: Registry<Component<Last>> = Registry::new();

/// A call on an instance, see [`instance::call`].
pub(super) fn call<R: Into<Status>>(
    instance: Instance,
    function: &str,
    body: impl FnOnce(&mut Component<Last>) -> Result<R, Refusal>,
) -> Status {
    instance::call(&INSTANCES, instance, function, body)
}
