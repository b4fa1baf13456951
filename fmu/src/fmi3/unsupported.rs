//! Functions of capabilities that the model description does not claim: an error with the reason.

use super::instance::call;
use super::types::{FmuState, Instance, Status};
use crate::lifecycle::Refusal;

macro_rules! unsupported {
    ($($reason:literal: $($function:ident($($argument:ident: $type:ty),*);)*)*) => {$($(
        #[doc = concat!("`", stringify!($function), "`: refused, ", $reason, ".")]
        #[unsafe(no_mangle)]
        #[allow(clippy::too_many_arguments)]
        pub extern "C" fn $function(instance: Instance, $($argument: $type),*) -> Status {
            let _ = ($($argument,)*);
            call(instance, stringify!($function), |_| Err(Refusal::Unsupported($reason.into())))
        }
    )*)*};
}

unsupported! {
    "the FMU has no event mode (hasEventMode is false)":
        fmi3EnterEventMode();
        fmi3EnterStepMode();
        fmi3EvaluateDiscreteStates();
        fmi3UpdateDiscreteStates(
            discreteStatesNeedUpdate: *mut bool,
            terminateSimulation: *mut bool,
            nominalsOfContinuousStatesChanged: *mut bool,
            valuesOfContinuousStatesChanged: *mut bool,
            nextEventTimeDefined: *mut bool,
            nextEventTime: *mut f64
        );
    "the FMU has no structural parameters":
        fmi3EnterConfigurationMode();
        fmi3ExitConfigurationMode();
    "the FMU does not tell dependencies of single elements (providesPerElementDependencies is false)":
        fmi3GetNumberOfVariableDependencies(valueReference: u32, nDependencies: *mut usize);
        fmi3GetVariableDependencies(
            dependent: u32,
            elementIndicesOfDependent: *mut usize,
            independents: *mut u32,
            elementIndicesOfIndependents: *mut usize,
            dependencyKinds: *mut i32,
            nDependencies: usize
        );
    "the FMU cannot serialize its state (canSerializeFMUState is false)":
        fmi3SerializedFMUStateSize(FMUState: FmuState, size: *mut usize);
        fmi3SerializeFMUState(FMUState: FmuState, serializedState: *mut u8, size: usize);
        fmi3DeserializeFMUState(serializedState: *const u8, size: usize, FMUState: *mut FmuState);
    "the FMU has no directional derivatives (providesDirectionalDerivatives is false)":
        fmi3GetDirectionalDerivative(
            unknowns: *const u32,
            nUnknowns: usize,
            knowns: *const u32,
            nKnowns: usize,
            seed: *const f64,
            nSeed: usize,
            sensitivity: *mut f64,
            nSensitivity: usize
        );
    "the FMU has no adjoint derivatives (providesAdjointDerivatives is false)":
        fmi3GetAdjointDerivative(
            unknowns: *const u32,
            nUnknowns: usize,
            knowns: *const u32,
            nKnowns: usize,
            seed: *const f64,
            nSeed: usize,
            sensitivity: *mut f64,
            nSensitivity: usize
        );
    "the FMU has no output derivatives (maxOutputDerivativeOrder is 0)":
        fmi3GetOutputDerivatives(
            valueReferences: *const u32,
            nValueReferences: usize,
            orders: *const i32,
            values: *mut f64,
            nValues: usize
        );
    "the function is for model exchange, the FMU for co-simulation":
        fmi3EnterContinuousTimeMode();
        fmi3CompletedIntegratorStep(
            noSetFMUStatePriorToCurrentPoint: u8,
            enterEventMode: *mut bool,
            terminateSimulation: *mut bool
        );
        fmi3SetTime(time: f64);
        fmi3SetContinuousStates(continuousStates: *const f64, nContinuousStates: usize);
        fmi3GetContinuousStateDerivatives(derivatives: *mut f64, nContinuousStates: usize);
        fmi3GetEventIndicators(eventIndicators: *mut f64, nEventIndicators: usize);
        fmi3GetContinuousStates(continuousStates: *mut f64, nContinuousStates: usize);
        fmi3GetNominalsOfContinuousStates(nominals: *mut f64, nContinuousStates: usize);
        fmi3GetNumberOfEventIndicators(nEventIndicators: *mut usize);
        fmi3GetNumberOfContinuousStates(nContinuousStates: *mut usize);
    "the function is for scheduled execution, the FMU for co-simulation":
        fmi3ActivateModelPartition(clockReference: u32, activationTime: f64);
}
