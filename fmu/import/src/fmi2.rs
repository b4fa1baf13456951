//! The functions of FMI 2.0.

use crate::ImportError;
use crate::archive::Fmu;
use crate::slave::{Functions, Progress, checked, keep, logged, symbol};
use libloading::Library;
use std::ffi::{CString, c_char, c_int, c_uint, c_void};
use std::ptr::null_mut;

type Component = *mut c_void;
type Simple = unsafe extern "C" fn(Component) -> c_int;

/// `fmi2CallbackFunctions`.
#[repr(C)]
struct Callbacks {
    logger: *const c_void,
    allocate_memory: unsafe extern "C" fn(usize, usize) -> *mut c_void,
    free_memory: unsafe extern "C" fn(*mut c_void),
    step_finished: *const c_void,
    environment: *mut c_void,
}

// The memory functions of the C library, which FMI 2.0 has importers provide.
unsafe extern "C" {
    fn calloc(count: usize, size: usize) -> *mut c_void;
    fn free(pointer: *mut c_void);
}

/// Its C type is variadic, which a Rust function cannot be: the message is kept as its format. The calling conventions of
/// all systems that this builds for pass the named arguments alike.
unsafe extern "C" fn log(_: *mut c_void, _: *const c_char, status: c_int, _: *const c_char, message: *const c_char) {
    if status > 1 {
        keep(message);
    }
}

/// `fmi2LastSuccessfulTime` and `fmi2Terminated` of `fmi2StatusKind`.
const LAST_SUCCESSFUL_TIME: c_int = 2;
const TERMINATED: c_int = 3;
const DISCARD: c_int = 2;

pub struct Instance {
    component: Component,
    // FMUs keep the pointer that they are given.
    _callbacks: Box<Callbacks>,
    setup: unsafe extern "C" fn(Component, c_int, f64, f64, c_int, f64) -> c_int,
    enter: Simple,
    exit: Simple,
    reset: Simple,
    free: unsafe extern "C" fn(Component),
    set_real: unsafe extern "C" fn(Component, *const c_uint, usize, *const f64) -> c_int,
    get_real: unsafe extern "C" fn(Component, *const c_uint, usize, *mut f64) -> c_int,
    get_integer: unsafe extern "C" fn(Component, *const c_uint, usize, *mut c_int) -> c_int,
    step: unsafe extern "C" fn(Component, f64, f64, c_int) -> c_int,
    real_status: unsafe extern "C" fn(Component, c_int, *mut f64) -> c_int,
    boolean_status: unsafe extern "C" fn(Component, c_int, *mut c_int) -> c_int,
}

type Instantiate = unsafe extern "C" fn(
    *const c_char,
    c_int,
    *const c_char,
    *const c_char,
    *const Callbacks,
    c_int,
    c_int,
) -> Component;

impl Instance {
    pub fn new(library: &Library, fmu: &Fmu) -> Result<Self, ImportError> {
        let text = |text: String| CString::new(text).map_err(|_| ImportError::Description("a text has a NUL".into()));
        let token = text(fmu.description.token.clone())?;
        let location = text(uri(&fmu.resources().to_string_lossy()))?;
        let callbacks = Box::new(Callbacks {
            logger: log as *const c_void,
            allocate_memory: calloc,
            free_memory: free,
            step_finished: std::ptr::null(),
            environment: null_mut(),
        });
        // SAFETY: the types are those of the standard's header; texts and callbacks live through the call.
        unsafe {
            let instantiate: Instantiate = symbol(library, "fmi2Instantiate")?;
            let cosimulation = 1;
            let component = instantiate(
                c"bekker".as_ptr(),
                cosimulation,
                token.as_ptr(),
                location.as_ptr(),
                &raw const *callbacks,
                0,
                0,
            );
            if component.is_null() {
                return Err(ImportError::Call { function: "fmi2Instantiate", status: "no instance", log: logged() });
            }
            Ok(Self {
                component,
                _callbacks: callbacks,
                setup: symbol(library, "fmi2SetupExperiment")?,
                enter: symbol(library, "fmi2EnterInitializationMode")?,
                exit: symbol(library, "fmi2ExitInitializationMode")?,
                reset: symbol(library, "fmi2Reset")?,
                free: symbol(library, "fmi2FreeInstance")?,
                set_real: symbol(library, "fmi2SetReal")?,
                get_real: symbol(library, "fmi2GetReal")?,
                get_integer: symbol(library, "fmi2GetInteger")?,
                step: symbol(library, "fmi2DoStep")?,
                real_status: symbol(library, "fmi2GetRealStatus")?,
                boolean_status: symbol(library, "fmi2GetBooleanStatus")?,
            })
        }
    }
}

/// A path as a URI, with escapes for what a URI may not hold.
fn uri(path: &str) -> String {
    let mut text = String::from(if path.starts_with('/') { "file://" } else { "file:///" });
    for byte in path.bytes() {
        match byte {
            b'\\' => text.push('/'),
            b'a'..=b'z' | b'A'..=b'Z' | b'0'..=b'9' | b'/' | b':' | b'.' | b'-' | b'_' | b'~' => {
                text.push(char::from(byte));
            }
            other => text.push_str(&format!("%{other:02X}")),
        }
    }
    text
}

// SAFETY of all calls below: the component is alive until `drop`; lists are as long as their count says.
impl Functions for Instance {
    fn enter_initialization(&self, start: f64) -> Result<(), ImportError> {
        checked("fmi2SetupExperiment", unsafe { (self.setup)(self.component, 0, 0.0, start, 0, 0.0) })?;
        checked("fmi2EnterInitializationMode", unsafe { (self.enter)(self.component) })
    }

    fn exit_initialization(&self) -> Result<(), ImportError> {
        checked("fmi2ExitInitializationMode", unsafe { (self.exit)(self.component) })
    }

    fn set_reals(&self, references: &[u32], values: &[f64]) -> Result<(), ImportError> {
        let count = references.len().min(values.len());
        checked("fmi2SetReal", unsafe { (self.set_real)(self.component, references.as_ptr(), count, values.as_ptr()) })
    }

    fn get_reals(&self, references: &[u32], values: &mut [f64]) -> Result<(), ImportError> {
        let count = references.len().min(values.len());
        let places = values.as_mut_ptr();
        checked("fmi2GetReal", unsafe { (self.get_real)(self.component, references.as_ptr(), count, places) })
    }

    fn get_integer(&self, reference: u32) -> Result<i64, ImportError> {
        let mut value = 0;
        let status = unsafe { (self.get_integer)(self.component, &raw const reference, 1, &raw mut value) };
        checked("fmi2GetInteger", status).map(|()| i64::from(value))
    }

    fn step(&self, time: f64, size: f64) -> Result<Progress, ImportError> {
        let status = unsafe { (self.step)(self.component, time, size, 1) };
        let mut ended = 0;
        if status == DISCARD {
            let asked = unsafe { (self.boolean_status)(self.component, TERMINATED, &raw mut ended) };
            checked("fmi2GetBooleanStatus", asked)?;
        }
        if ended == 0 {
            return checked("fmi2DoStep", status).map(|()| Progress { time: time + size, ended: false });
        }
        let mut time = f64::NAN;
        let asked = unsafe { (self.real_status)(self.component, LAST_SUCCESSFUL_TIME, &raw mut time) };
        checked("fmi2GetRealStatus", asked).map(|()| Progress { time, ended: true })
    }

    fn reset(&self) -> Result<(), ImportError> {
        checked("fmi2Reset", unsafe { (self.reset)(self.component) })
    }
}

impl Drop for Instance {
    fn drop(&mut self) {
        // SAFETY: the component is alive, and nothing uses it afterwards.
        unsafe { (self.free)(self.component) }
    }
}

#[cfg(test)]
mod tests {
    use super::uri;

    #[test]
    fn published_form_of_a_file_uri() {
        // RFC 8089, appendices B and E.2; percent-encoding by RFC 3986, 2.1.
        assert_eq!(uri("/tmp/a b/resources"), "file:///tmp/a%20b/resources");
        assert_eq!(uri("C:\\fmu\\resources"), "file:///C:/fmu/resources");
    }
}
