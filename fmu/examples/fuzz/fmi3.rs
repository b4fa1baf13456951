//! A random call of FMI 3.0.

use crate::importer::{Fuzz, WIDTH, done, log, update};
use bekker_fmu::fmi3::*;
use std::ptr::{null, null_mut};

impl Fuzz {
    pub unsafe fn call3(&mut self) {
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
}
