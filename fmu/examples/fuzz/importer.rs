//! The importer that makes the calls: its memory, and the arguments that it draws.

use bekker::model::Model;
use bekker_fmu::fmi2::*;
use bekker_fmu::fmi3::Status;
use bekker_modeldescription::xml::{Entry, Kind};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::ffi::{CStr, CString, c_char, c_void};
use std::ptr::{null, null_mut};
use std::sync::atomic::{AtomicU64, Ordering};

/// Most values that a call asks for.
pub const WIDTH: usize = 6;

/// Numbers that cause errors where they are not checked.
const NUMBERS: [f64; 14] = [
    0.0,
    -0.0,
    1.0,
    -1.0,
    0.001,
    0.002,
    0.0005,
    0.0137,
    1e300,
    -1e300,
    f64::NAN,
    f64::INFINITY,
    f64::NEG_INFINITY,
    f64::MIN_POSITIVE,
];

pub static REFUSALS: AtomicU64 = AtomicU64::new(0);

pub unsafe extern "C" fn log(_: *mut c_void, _: Status, _: *const c_char, message: *const c_char) {
    // SAFETY: the library passes a NUL-terminated text.
    let message = unsafe { CStr::from_ptr(message) }.to_string_lossy();
    assert!(!message.contains("defect in the FMU"), "{message}");
    REFUSALS.fetch_add(1, Ordering::Relaxed);
}

/// The logger of FMI 2.0 without its variadic end, which the messages do not use.
unsafe extern "C" fn log2(e: *mut c_void, _: *const c_char, s: Status, c: *const c_char, message: *const c_char) {
    // SAFETY: as for `log`.
    unsafe { log(e, s, c, message) }
}

#[allow(clippy::too_many_arguments, reason = "the standard's")]
pub unsafe extern "C" fn update(
    _: *mut c_void,
    time: f64,
    _: bool,
    _: bool,
    _: bool,
    _: bool,
    early: *mut u8,
    until: *mut f64,
) {
    // SAFETY: two places of the library's.
    unsafe {
        early.write(u8::from(((time * 1e4) as u64).is_multiple_of(7)));
        until.write(time);
    }
}

/// Any status will do.
pub fn done(_: Status) {}

/// The FMU's files, and what the importer holds.
pub struct Fuzz {
    pub random: ChaCha8Rng,
    pub token: CString,
    pub path: CString,
    pub uri: CString,
    pub callbacks: Callbacks,
    pub variables: u32,
    /// References of all variables but the enumerations.
    pub reals: Vec<u32>,
    pub two: Vec<Instance>,
    pub three: Vec<Instance>,
    pub states: Vec<*mut c_void>,
    pub bytes: Vec<u8>,
    /// Memory of the importer, read and written by all calls.
    pub references: [u32; WIDTH],
    pub values: [f64; WIDTH],
    pub integers: [i32; WIDTH],
    pub longs: [i64; WIDTH],
    pub texts: [*const c_char; WIDTH],
}

impl Fuzz {
    pub fn new(folder: &std::path::Path, model: &Model, seed: u64) -> Self {
        let (text, description) = bekker_fmu::describe(model).unwrap();
        std::fs::create_dir_all(folder).unwrap();
        std::fs::write(folder.join(bekker_fmu::MODEL_FILE), text).unwrap();
        let path = folder.to_str().unwrap();
        // SAFETY: the messages ask for no arguments, and all our targets pass the named ones alike.
        let logger = unsafe { std::mem::transmute::<*const c_void, Log>(log2 as *const c_void) };
        let callbacks = Callbacks {
            logger,
            allocate_memory: null(),
            free_memory: null(),
            step_finished: null(),
            environment: null_mut(),
        };
        let real = |entry: &Entry| !matches!(entry.kind, Kind::Enumeration { .. });
        let reals = (0..).zip(&description.entries).filter(|(_, entry)| real(entry)).map(|(k, _)| k).collect();
        Self {
            reals,
            random: ChaCha8Rng::seed_from_u64(seed),
            token: CString::new(description.token().unwrap()).unwrap(),
            path: CString::new(path).unwrap(),
            uri: CString::new(format!("file://{path}")).unwrap(),
            callbacks,
            variables: description.entries.len() as u32,
            two: vec![null_mut(), 16 as *mut c_void],
            three: vec![null_mut(), 16 as *mut c_void],
            states: vec![null_mut(), 24 as *mut c_void],
            bytes: vec![1; 8],
            references: [0; WIDTH],
            values: [0.0; WIDTH],
            integers: [0; WIDTH],
            longs: [0; WIDTH],
            texts: [null(); WIDTH],
        }
    }

    pub fn below(&mut self, end: usize) -> usize {
        self.random.random_range(0..end)
    }

    pub fn number(&mut self) -> f64 {
        match self.below(3) {
            0 => NUMBERS[self.below(NUMBERS.len())],
            1 => self.random.random_range(-3.0..3.0),
            _ => self.random.random_range(0.0..0.01),
        }
    }

    /// Fills the arguments; the result is how many of them a call uses.
    pub fn draw(&mut self) -> usize {
        for k in 0..WIDTH {
            let any = self.random.random_range(0..u32::MAX);
            self.references[k] = if self.below(9) == 0 { any } else { any % self.variables };
            self.values[k] = self.number();
            self.integers[k] = self.random.random_range(-1..4);
        }
        self.below(WIDTH)
    }

    pub fn references(&mut self) -> *const u32 {
        if self.below(20) == 0 { null() } else { self.references.as_ptr() }
    }

    pub fn values(&mut self) -> *mut f64 {
        if self.below(20) == 0 { null_mut() } else { self.values.as_mut_ptr() }
    }

    pub fn state(&mut self) -> usize {
        self.below(self.states.len())
    }

    pub fn memory(&mut self) -> usize {
        if self.below(3) == 0 { self.below(self.bytes.len() + 1) } else { self.bytes.len() }
    }

    /// Damages the bytes of a saved state, sometimes.
    pub fn damage(&mut self) {
        if self.below(2) == 0 && !self.bytes.is_empty() {
            let place = self.below(self.bytes.len());
            self.bytes[place] ^= 1 << self.below(8);
        }
    }

    /// A new instance drives as ever: the bits after a few steps.
    pub fn drive(&self) -> Vec<u64> {
        let mut values = vec![0.0; self.reals.len()];
        // SAFETY: valid texts and places.
        unsafe {
            let c = fmi2Instantiate(c"b".as_ptr(), 1, self.token.as_ptr(), self.uri.as_ptr(), &self.callbacks, 0, 1);
            assert_eq!(fmi2EnterInitializationMode(c), Status::Ok);
            assert_eq!(fmi2ExitInitializationMode(c), Status::Ok);
            assert_eq!(fmi2DoStep(c, 0.0, 0.02, 1), Status::Ok);
            assert_eq!(fmi2GetReal(c, self.reals.as_ptr(), self.reals.len(), values.as_mut_ptr()), Status::Ok);
            fmi2FreeInstance(c);
        }
        values.iter().map(|value| value.to_bits()).collect()
    }
}
