//! Derivatives by variables and by time, and what depends on what.

use super::instances::call;
use crate::border::Status;
use crate::border::arguments::{Places, list, list_mut};
use crate::border::instance::Instance;
use crate::lifecycle::{Direction, Refusal};

macro_rules! products {
    ($($(#[$doc:meta])* $function:ident = $direction:expr;)*) => {$(
        $(#[$doc])*
        #[unsafe(no_mangle)]
        #[allow(clippy::too_many_arguments)]
        pub unsafe extern "C" fn $function(
            instance: Instance,
            unknowns: *const u32,
            nUnknowns: usize,
            knowns: *const u32,
            nKnowns: usize,
            seed: *const f64,
            nSeed: usize,
            sensitivity: *mut f64,
            nSensitivity: usize,
        ) -> Status {
            call(instance, stringify!($function), |component| {
                // SAFETY: NULL or valid, by the promise of the border.
                let (unknowns, knowns, seed) = unsafe {
                    (list("unknowns", unknowns, nUnknowns)?, list("knowns", knowns, nKnowns)?, list("seed", seed, nSeed)?)
                };
                let mut result = vec![0.0; nSensitivity.min(unknowns.len().max(knowns.len()) + 1)];
                // SAFETY: as above.
                let places = unsafe { Places::new("sensitivity", sensitivity, nSensitivity) }?;
                component.lifecycle.partial($direction, unknowns, knowns, seed, &mut result)?;
                result.iter().enumerate().for_each(|(place, value)| places.put(place, *value));
                Ok(())
            })
        }
    )*};
}

products! {
    /// `fmi3GetDirectionalDerivative`.
    fmi3GetDirectionalDerivative = Direction::Forward;
    /// `fmi3GetAdjointDerivative`.
    fmi3GetAdjointDerivative = Direction::Adjoint;
}

/// `fmi3GetOutputDerivatives`, of order 1.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3GetOutputDerivatives(
    instance: Instance,
    valueReferences: *const u32,
    nValueReferences: usize,
    orders: *const i32,
    values: *mut f64,
    nValues: usize,
) -> Status {
    call(instance, "fmi3GetOutputDerivatives", |component| {
        if nValueReferences != nValues {
            return Err(Refusal::Length { references: nValueReferences, values: nValues });
        }
        // SAFETY: NULL or valid, by the promise of the border.
        let (references, orders, values) = unsafe {
            (
                list("valueReferences", valueReferences, nValueReferences)?,
                list("orders", orders, nValueReferences)?,
                Places::new("values", values, nValues)?,
            )
        };
        component.lifecycle.output_derivatives(references, orders, &mut |place, value| values.put(place, value))
    })
}

/// `fmi3GetNumberOfVariableDependencies`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3GetNumberOfVariableDependencies(
    instance: Instance,
    valueReference: u32,
    nDependencies: *mut usize,
) -> Status {
    call(instance, "fmi3GetNumberOfVariableDependencies", |component| {
        // SAFETY: NULL or valid, by the promise of the border.
        let place = unsafe { Places::new("nDependencies", nDependencies, 1) }?;
        place.put(0, component.lifecycle.dependencies(valueReference)?.len());
        Ok(())
    })
}

/// `fmi3DependencyKind`: `fmi3Dependent`, no particular structure.
const DEPENDENT: i32 = 5;

/// `fmi3GetVariableDependencies`: every variable is a scalar, whose one element has the index 1.
#[unsafe(no_mangle)]
#[allow(clippy::too_many_arguments)]
pub unsafe extern "C" fn fmi3GetVariableDependencies(
    instance: Instance,
    dependent: u32,
    elementIndicesOfDependent: *mut usize,
    independents: *mut u32,
    elementIndicesOfIndependents: *mut usize,
    dependencyKinds: *mut i32,
    nDependencies: usize,
) -> Status {
    call(instance, "fmi3GetVariableDependencies", |component| {
        let found = component.lifecycle.dependencies(dependent)?;
        if found.len() != nDependencies {
            return Err(Refusal::Count { what: "dependencies", given: nDependencies, expected: found.len() });
        }
        // SAFETY: NULL or valid, by the promise of the border; each array is the importer's own.
        unsafe {
            list_mut("elementIndicesOfDependent", elementIndicesOfDependent, nDependencies)?.fill(1);
            list_mut("independents", independents, nDependencies)?.copy_from_slice(&found);
            list_mut("elementIndicesOfIndependents", elementIndicesOfIndependents, nDependencies)?.fill(1);
            list_mut("dependencyKinds", dependencyKinds, nDependencies)?.fill(DEPENDENT);
        }
        Ok(())
    })
}
