//! Random calls on the C borders of both versions: right and wrong ones, in any order, with good and bad arguments.
//!
//! `cargo run -p bekker-fmu --example fuzz -- [CALLS] [SEED]`; `fmu/scripts/fuzz.sh` runs it under valgrind. It fails by
//! crashing, by a panic that the border reports, or by an instance that does not simulate as ever after a reset.
#![allow(clippy::unwrap_used, reason = "a test program may fail by panicking")]

use bekker::model::Model;
use bekker_fmu::fmi2::*;
use bekker_fmu::fmi3::*;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use std::ffi::{CStr, CString, c_char, c_void};
use std::path::PathBuf;
use std::ptr::{null, null_mut};
use std::sync::atomic::{AtomicU64, Ordering};

/// Most values that a call asks for.
const WIDTH: usize = 6;

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

static REFUSALS: AtomicU64 = AtomicU64::new(0);

unsafe extern "C" fn log(_: *mut c_void, _: Status, _: *const c_char, message: *const c_char) {
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
unsafe extern "C" fn update(
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
fn done(_: Status) {}

/// The FMU's files, and what the importer holds.
struct Fuzz {
    random: ChaCha8Rng,
    token: CString,
    path: CString,
    uri: CString,
    callbacks: Callbacks,
    variables: u32,
    two: Vec<Instance>,
    three: Vec<Instance>,
    states: Vec<*mut c_void>,
    bytes: Vec<u8>,
    /// Memory of the importer, read and written by all calls.
    references: [u32; WIDTH],
    values: [f64; WIDTH],
    integers: [i32; WIDTH],
    longs: [i64; WIDTH],
    texts: [*const c_char; WIDTH],
}

impl Fuzz {
    fn new(folder: &std::path::Path, model: &Model, seed: u64) -> Self {
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
        Self {
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

    fn below(&mut self, end: usize) -> usize {
        self.random.random_range(0..end)
    }

    fn number(&mut self) -> f64 {
        match self.below(3) {
            0 => NUMBERS[self.below(NUMBERS.len())],
            1 => self.random.random_range(-3.0..3.0),
            _ => self.random.random_range(0.0..0.01),
        }
    }

    /// Fills the arguments; the result is how many of them a call uses.
    fn draw(&mut self) -> usize {
        for k in 0..WIDTH {
            let any = self.random.random_range(0..u32::MAX);
            self.references[k] = if self.below(9) == 0 { any } else { any % self.variables };
            self.values[k] = self.number();
            self.integers[k] = self.random.random_range(-1..4);
        }
        self.below(WIDTH)
    }

    fn references(&mut self) -> *const u32 {
        if self.below(20) == 0 { null() } else { self.references.as_ptr() }
    }

    fn values(&mut self) -> *mut f64 {
        if self.below(20) == 0 { null_mut() } else { self.values.as_mut_ptr() }
    }

    fn state(&mut self) -> usize {
        self.below(self.states.len())
    }

    fn memory(&mut self) -> usize {
        if self.below(3) == 0 { self.below(self.bytes.len() + 1) } else { self.bytes.len() }
    }

    /// Damages the bytes of a saved state, sometimes.
    fn damage(&mut self) {
        if self.below(2) == 0 && !self.bytes.is_empty() {
            let place = self.below(self.bytes.len());
            self.bytes[place] ^= 1 << self.below(8);
        }
    }

    unsafe fn call2(&mut self) {
        let count = self.draw();
        let place = self.below(self.two.len());
        let c = self.two[place];
        let (r, v, s) = (self.references(), self.values(), self.state());
        let (x, y, yes) = (self.number(), self.number(), i32::from(self.below(2) == 0));
        let mut info = EventInfo::default();
        let mut status = Status::Ok;
        let mut size = 0;
        // SAFETY: pointers are NULL or valid for at least `count` values.
        unsafe {
            match self.below(46) {
                0 if self.two.len() < 6 => {
                    let token = if self.below(4) == 0 { null() } else { self.token.as_ptr() };
                    let kind = self.integers[0];
                    self.two.push(fmi2Instantiate(
                        c"a".as_ptr(),
                        kind,
                        token,
                        self.uri.as_ptr(),
                        &self.callbacks,
                        0,
                        yes,
                    ));
                }
                1 if self.below(4) == 0 => fmi2FreeInstance(c),
                2 => done(fmi2SetDebugLogging(c, yes, 1, &c"logEvents".as_ptr())),
                3 => done(fmi2SetupExperiment(c, 0, 0.0, x, yes, y)),
                4 | 5 => done(fmi2EnterInitializationMode(c)),
                6 | 7 => done(fmi2ExitInitializationMode(c)),
                8 if self.below(4) == 0 => done(fmi2Terminate(c)),
                9 if self.below(4) == 0 => done(fmi2Reset(c)),
                10 => done(fmi2GetReal(c, r, count, v)),
                11 => done(fmi2GetInteger(c, r, count, self.integers.as_mut_ptr())),
                12 => done(fmi2GetBoolean(c, r, count, self.integers.as_mut_ptr())),
                13 => done(fmi2GetString(c, r, count, self.texts.as_mut_ptr())),
                14 => done(fmi2SetReal(c, r, count, v)),
                15 => done(fmi2SetInteger(c, r, count, self.integers.as_ptr())),
                16 => done(fmi2SetBoolean(c, r, count, self.integers.as_ptr())),
                17 => done(fmi2SetString(c, r, count, self.texts.as_ptr())),
                18 => done(fmi2GetFMUstate(c, &mut self.states[s])),
                19 if self.states.len() < 6 => {
                    self.states.push(null_mut());
                    let last = self.states.len() - 1;
                    fmi2GetFMUstate(c, &mut self.states[last]);
                }
                20 => done(fmi2SetFMUstate(c, self.states[s])),
                21 => done(fmi2FreeFMUstate(c, &mut self.states[s])),
                22 => {
                    if fmi2SerializedFMUstateSize(c, self.states[s], &mut size) == Status::Ok {
                        self.bytes = vec![0; size];
                    }
                    let memory = self.memory();
                    fmi2SerializeFMUstate(c, self.states[s], self.bytes.as_mut_ptr(), memory);
                }
                23 => {
                    self.damage();
                    let memory = self.memory();
                    fmi2DeSerializeFMUstate(c, self.bytes.as_ptr(), memory, &mut self.states[s]);
                }
                24 => done(fmi2GetDirectionalDerivative(
                    c,
                    r,
                    count,
                    self.references.as_ptr(),
                    count,
                    v,
                    self.values.as_mut_ptr(),
                )),
                25 => done(fmi2EnterEventMode(c)),
                26 => done(fmi2NewDiscreteStates(c, &mut info)),
                27 => done(fmi2EnterContinuousTimeMode(c)),
                28 => done(fmi2CompletedIntegratorStep(c, yes, &mut self.integers[0], &mut self.integers[1])),
                29 => done(fmi2SetTime(c, x)),
                30 => done(fmi2SetContinuousStates(c, v, count)),
                31 => done(fmi2GetDerivatives(c, v, count)),
                32 => done(fmi2GetEventIndicators(c, v, count)),
                33 => done(fmi2GetContinuousStates(c, v, count)),
                34 => done(fmi2GetNominalsOfContinuousStates(c, v, count)),
                35 => done(fmi2SetRealInputDerivatives(c, r, count, self.integers.as_ptr(), v)),
                36 => done(fmi2GetRealOutputDerivatives(c, r, count, self.integers.as_ptr(), v)),
                37 => done(fmi2CancelStep(c)),
                38 => done(fmi2GetStatus(c, self.integers[0], &mut status)),
                39 => done(fmi2GetRealStatus(c, self.integers[0], &mut self.values[0])),
                40 => done(fmi2GetIntegerStatus(c, self.integers[0], &mut self.integers[1])),
                41 => done(fmi2GetBooleanStatus(c, self.integers[0], &mut self.integers[1])),
                42 => done(fmi2GetStringStatus(c, self.integers[0], &mut self.texts[0])),
                _ => {
                    let mut now = x;
                    if fmi2GetReal(c, &0, 1, &mut now) == Status::Ok && yes == 1 {
                        fmi2DoStep(c, now, y.abs().min(0.02), 1);
                    } else {
                        fmi2DoStep(c, x, y.min(0.02), 1);
                    }
                }
            }
        }
    }

    unsafe fn call3(&mut self) {
        let count = self.draw();
        let place = self.below(self.three.len());
        let c = self.three[place];
        let (r, v, s) = (self.references(), self.values(), self.state());
        let other = if self.below(5) == 0 { self.below(WIDTH) } else { count };
        let (x, y, yes) = (self.number(), self.number(), u8::from(self.below(2) == 0));
        let (mut a, mut b, mut d, mut e, mut f, mut time, mut size) = (false, false, false, false, false, 0.0, 0);
        // SAFETY: pointers are NULL or valid for at least `count` values.
        unsafe {
            match self.below(46) {
                0 if self.three.len() < 6 => {
                    let path = if self.below(4) == 0 { c"/nowhere".as_ptr() } else { self.path.as_ptr() };
                    let callback: IntermediateUpdate = if self.below(2) == 0 { Some(update) } else { None };
                    let (events, early) = (u8::from(self.below(3) == 0), u8::from(self.below(2) == 0));
                    self.three.push(fmi3InstantiateCoSimulation(
                        c"a".as_ptr(),
                        self.token.as_ptr(),
                        path,
                        0,
                        yes,
                        events,
                        early,
                        null(),
                        0,
                        null_mut(),
                        Some(log),
                        callback,
                    ));
                }
                1 if self.three.len() < 6 => {
                    let (token, path) = (self.token.as_ptr(), self.path.as_ptr());
                    let made = fmi3InstantiateModelExchange(c"a".as_ptr(), token, path, 0, yes, null_mut(), Some(log));
                    self.three.push(made);
                }
                2 if self.below(4) == 0 => fmi3FreeInstance(c),
                3 => done(fmi3SetDebugLogging(c, yes, 1, &c"logEvents".as_ptr())),
                4 | 5 => done(fmi3EnterInitializationMode(c, 0, 0.0, x, yes, y)),
                6 | 7 => done(fmi3ExitInitializationMode(c)),
                8 => done(fmi3EnterEventMode(c)),
                9 if self.below(4) == 0 => done(fmi3Terminate(c)),
                10 if self.below(4) == 0 => done(fmi3Reset(c)),
                11 => done(fmi3GetFloat64(c, r, count, v, other)),
                12 => done(fmi3GetInt64(c, r, count, self.longs.as_mut_ptr(), other)),
                13 => done(fmi3GetFloat32(c, r, count, null_mut(), other)),
                14 => done(fmi3GetString(c, r, count, self.texts.as_mut_ptr(), other)),
                15 => done(fmi3SetFloat64(c, r, count, v, other)),
                16 => done(fmi3SetInt64(c, r, count, self.longs.as_ptr(), other)),
                17 => done(fmi3GetClock(c, r, count, null_mut())),
                18 => done(fmi3GetNumberOfVariableDependencies(c, self.references[0], &mut size)),
                19 => done(fmi3GetVariableDependencies(
                    c,
                    self.references[0],
                    null_mut(),
                    null_mut(),
                    null_mut(),
                    null_mut(),
                    0,
                )),
                20 => done(fmi3GetFMUState(c, &mut self.states[s])),
                21 if self.states.len() < 6 => {
                    self.states.push(null_mut());
                    let last = self.states.len() - 1;
                    fmi3GetFMUState(c, &mut self.states[last]);
                }
                22 => done(fmi3SetFMUState(c, self.states[s])),
                23 => done(fmi3FreeFMUState(c, &mut self.states[s])),
                24 => {
                    if fmi3SerializedFMUStateSize(c, self.states[s], &mut size) == Status::Ok {
                        self.bytes = vec![0; size];
                    }
                    let memory = self.memory();
                    fmi3SerializeFMUState(c, self.states[s], self.bytes.as_mut_ptr(), memory);
                }
                25 => {
                    self.damage();
                    let memory = self.memory();
                    fmi3DeserializeFMUState(c, self.bytes.as_ptr(), memory, &mut self.states[s]);
                }
                26 => {
                    done(fmi3GetDirectionalDerivative(c, r, count, r, count, v, other, self.values.as_mut_ptr(), count))
                }
                27 => done(fmi3GetAdjointDerivative(c, r, count, r, count, v, count, self.values.as_mut_ptr(), other)),
                28 => done(fmi3EnterConfigurationMode(c)),
                29 => done(fmi3EvaluateDiscreteStates(c)),
                30 => done(fmi3UpdateDiscreteStates(c, &mut a, &mut b, &mut d, &mut e, &mut f, &mut time)),
                31 => done(fmi3EnterContinuousTimeMode(c)),
                32 => done(fmi3CompletedIntegratorStep(c, yes, &mut a, &mut b)),
                33 => done(fmi3SetTime(c, x)),
                34 => done(fmi3SetContinuousStates(c, v, count)),
                35 => done(fmi3GetContinuousStateDerivatives(c, v, count)),
                36 => done(fmi3GetEventIndicators(c, v, count)),
                37 => done(fmi3GetContinuousStates(c, v, count)),
                38 => done(fmi3GetNominalsOfContinuousStates(c, v, count)),
                39 => done(fmi3GetNumberOfContinuousStates(c, &mut size)),
                40 => done(fmi3EnterStepMode(c)),
                41 => done(fmi3GetOutputDerivatives(c, r, count, self.integers.as_ptr(), v, other)),
                42 => done(fmi3ActivateModelPartition(c, self.references[0], x)),
                _ => {
                    let mut now = x;
                    let size = if fmi3GetFloat64(c, &0, 1, &mut now, 1) == Status::Ok && yes == 1 {
                        y.abs().min(0.02)
                    } else {
                        y.min(0.02)
                    };
                    fmi3DoStep(c, now, size, 1, &mut a, &mut b, &mut d, &mut time);
                }
            }
        }
    }

    /// A new instance drives as ever: the bits after a few steps.
    fn drive(&self) -> Vec<u64> {
        let mut values = vec![0.0; self.variables as usize - 1];
        // All but the last, which is an enumeration.
        let references: Vec<u32> = (0..self.variables - 1).collect();
        // SAFETY: valid texts and places.
        unsafe {
            let c = fmi2Instantiate(c"b".as_ptr(), 1, self.token.as_ptr(), self.uri.as_ptr(), &self.callbacks, 0, 1);
            assert_eq!(fmi2EnterInitializationMode(c), Status::Ok);
            assert_eq!(fmi2ExitInitializationMode(c), Status::Ok);
            assert_eq!(fmi2DoStep(c, 0.0, 0.02, 1), Status::Ok);
            assert_eq!(fmi2GetReal(c, references.as_ptr(), references.len(), values.as_mut_ptr()), Status::Ok);
            fmi2FreeInstance(c);
        }
        values.iter().map(|value| value.to_bits()).collect()
    }
}

fn main() {
    let mut arguments = std::env::args().skip(1);
    let calls: u64 = arguments.next().map_or(20_000, |text| text.parse().unwrap());
    let seed: u64 = arguments.next().map_or(1, |text| text.parse().unwrap());
    let folder: PathBuf = std::env::temp_dir().join(format!("bekker-fuzz-{}", std::process::id()));
    let mut model = Model::preset("two_wheeled").unwrap();
    model.stepping.step_size = 0.001;
    let mut fuzz = Fuzz::new(&folder, &model, seed);
    let before = fuzz.drive();
    for call in 0..calls {
        // SAFETY: the calls' own arguments are in order; what is wrong is what the library promises to find out.
        unsafe { if call % 2 == 0 { fuzz.call2() } else { fuzz.call3() } }
        if call % 500 == 499 {
            fuzz.two.drain(2..).for_each(|c| fmi2FreeInstance(c));
            fuzz.three.drain(2..).for_each(|c| fmi3FreeInstance(c));
            fuzz.states.truncate(2);
        }
    }
    fuzz.two.drain(..).for_each(|c| fmi2FreeInstance(c));
    fuzz.three.drain(..).for_each(|c| fmi3FreeInstance(c));
    assert_eq!(before, fuzz.drive(), "a new instance simulates as before");
    std::fs::remove_dir_all(&folder).unwrap();
    println!("{calls} calls, {} messages, seed {seed}", REFUSALS.load(Ordering::Relaxed));
}
