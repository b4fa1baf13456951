//! A random call of FMI 2.0.

use crate::importer::{Fuzz, done};
use bekker_fmu::fmi2::*;
use bekker_fmu::fmi3::Status;
use std::ptr::{null, null_mut};

impl Fuzz {
    pub unsafe fn call2(&mut self) {
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
}
