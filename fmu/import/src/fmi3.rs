//! The functions of FMI 3.0.

use crate::ImportError;
use crate::archive::Fmu;
use crate::slave::{Functions, Progress, checked, keep, logged, symbol};
use libloading::Library;
use std::ffi::{CString, c_char, c_int, c_void};
use std::path::MAIN_SEPARATOR;
use std::ptr::{null, null_mut};

type Component = *mut c_void;
type Simple = unsafe extern "C" fn(Component) -> c_int;
type Log = unsafe extern "C" fn(*mut c_void, c_int, *const c_char, *const c_char);

unsafe extern "C" fn log(_: *mut c_void, status: c_int, _: *const c_char, message: *const c_char) {
    if status > 1 {
        keep(message);
    }
}

pub struct Instance {
    component: Component,
    enter: unsafe extern "C" fn(Component, bool, f64, f64, bool, f64) -> c_int,
    exit: Simple,
    reset: Simple,
    free: unsafe extern "C" fn(Component),
    set_float: unsafe extern "C" fn(Component, *const u32, usize, *const f64, usize) -> c_int,
    get_float: unsafe extern "C" fn(Component, *const u32, usize, *mut f64, usize) -> c_int,
    get_int: unsafe extern "C" fn(Component, *const u32, usize, *mut i64, usize) -> c_int,
    step: DoStep,
}

type DoStep = unsafe extern "C" fn(Component, f64, f64, bool, *mut bool, *mut bool, *mut bool, *mut f64) -> c_int;

type Instantiate = unsafe extern "C" fn(
    *const c_char,
    *const c_char,
    *const c_char,
    bool,
    bool,
    bool,
    bool,
    *const u32,
    usize,
    *mut c_void,
    Option<Log>,
    *const c_void,
) -> Component;

impl Instance {
    pub fn new(library: &Library, fmu: &Fmu) -> Result<Self, ImportError> {
        let text = |text: String| CString::new(text).map_err(|_| ImportError::Description("a text has a NUL".into()));
        let token = text(fmu.description.token.clone())?;
        // A path that ends with the system's separator (FMI 3.0.2, 2.3.1).
        let resources = text(format!("{}{MAIN_SEPARATOR}", fmu.resources().display()))?;
        // SAFETY: the types are those of the standard's header; texts live through the call.
        unsafe {
            let instantiate: Instantiate = symbol(library, "fmi3InstantiateCoSimulation")?;
            let component = instantiate(
                c"bekker".as_ptr(),
                token.as_ptr(),
                resources.as_ptr(),
                false,
                false,
                false,
                false,
                null(),
                0,
                null_mut(),
                Some(log),
                null(),
            );
            if component.is_null() {
                let function = "fmi3InstantiateCoSimulation";
                return Err(ImportError::Call { function, status: "no instance", log: logged() });
            }
            Ok(Self {
                component,
                enter: symbol(library, "fmi3EnterInitializationMode")?,
                exit: symbol(library, "fmi3ExitInitializationMode")?,
                reset: symbol(library, "fmi3Reset")?,
                free: symbol(library, "fmi3FreeInstance")?,
                set_float: symbol(library, "fmi3SetFloat64")?,
                get_float: symbol(library, "fmi3GetFloat64")?,
                get_int: symbol(library, "fmi3GetInt64")?,
                step: symbol(library, "fmi3DoStep")?,
            })
        }
    }
}

// SAFETY of all calls below: the component is alive until `drop`; lists are as long as their count says.
impl Functions for Instance {
    fn enter_initialization(&self, start: f64) -> Result<(), ImportError> {
        let status = unsafe { (self.enter)(self.component, false, 0.0, start, false, 0.0) };
        checked("fmi3EnterInitializationMode", status)
    }

    fn exit_initialization(&self) -> Result<(), ImportError> {
        checked("fmi3ExitInitializationMode", unsafe { (self.exit)(self.component) })
    }

    fn set_reals(&self, references: &[u32], values: &[f64]) -> Result<(), ImportError> {
        let n = references.len().min(values.len());
        let status = unsafe { (self.set_float)(self.component, references.as_ptr(), n, values.as_ptr(), n) };
        checked("fmi3SetFloat64", status)
    }

    fn get_reals(&self, references: &[u32], values: &mut [f64]) -> Result<(), ImportError> {
        let n = references.len().min(values.len());
        let status = unsafe { (self.get_float)(self.component, references.as_ptr(), n, values.as_mut_ptr(), n) };
        checked("fmi3GetFloat64", status)
    }

    fn get_integer(&self, reference: u32) -> Result<i64, ImportError> {
        let mut value = 0;
        let status = unsafe { (self.get_int)(self.component, &raw const reference, 1, &raw mut value, 1) };
        checked("fmi3GetInt64", status).map(|()| value)
    }

    fn step(&self, time: f64, size: f64) -> Result<Progress, ImportError> {
        let (mut event, mut ended, mut early, mut reached) = (false, false, false, time + size);
        let status = unsafe {
            (self.step)(
                self.component,
                time,
                size,
                true,
                &raw mut event,
                &raw mut ended,
                &raw mut early,
                &raw mut reached,
            )
        };
        checked("fmi3DoStep", status).map(|()| Progress { time: if ended { reached } else { time + size }, ended })
    }

    fn reset(&self) -> Result<(), ImportError> {
        checked("fmi3Reset", unsafe { (self.reset)(self.component) })
    }
}

impl Drop for Instance {
    fn drop(&mut self) {
        // SAFETY: the component is alive, and nothing uses it afterwards.
        unsafe { (self.free)(self.component) }
    }
}
