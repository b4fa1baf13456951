//! Derivatives by variables and by time, and what depends on what.

use super::instances::call;
use crate::border::Status;
use crate::border::arguments::{Places, list, list_mut};
use crate::border::instance::Instance;
use crate::lifecycle::{Direction, Lifecycle, Refusal};

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
                // SAFETY: NULL or valid, by the importer's obligations in `fmi3`.
                let (unknowns, knowns, seed) = unsafe {
                    (list("unknowns", unknowns, nUnknowns)?, list("knowns", knowns, nKnowns)?, list("seed", seed, nSeed)?)
                };
                let (unknowns, knowns) = (component.lifecycle.elements(unknowns)?, component.lifecycle.elements(knowns)?);
                let mut result = vec![0.0; nSensitivity.min(unknowns.len().max(knowns.len()) + 1)];
                // SAFETY: as above.
                let places = unsafe { Places::new("sensitivity", sensitivity, nSensitivity) }?;
                component.lifecycle.partial($direction, &unknowns, &knowns, seed, &mut result)?;
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
        // SAFETY: NULL or valid, by the importer's obligations in `fmi3`.
        let (references, orders) = unsafe {
            (list("valueReferences", valueReferences, nValueReferences)?, list("orders", orders, nValueReferences)?)
        };
        let (mut elements, mut element_orders) = (Vec::new(), Vec::new());
        for (reference, order) in references.iter().zip(orders) {
            elements.extend_from_slice(&component.lifecycle.elements(std::slice::from_ref(reference))?);
            element_orders.resize(elements.len(), *order);
        }
        if elements.len() != nValues {
            return Err(Refusal::Length { references: elements.len(), values: nValues });
        }
        // SAFETY: as above.
        let values = unsafe { Places::new("values", values, nValues) }?;
        let put = &mut |place, value| values.put(place, value);
        component.lifecycle.output_derivatives(&elements, &element_orders, put)
    })
}

/// What the elements of a variable depend on: the element, and reference and element of another; elements from 1 on.
fn dependencies(lifecycle: &Lifecycle, dependent: u32) -> Result<Vec<(usize, u32, usize)>, Refusal> {
    let elements = lifecycle.elements(std::slice::from_ref(&dependent))?;
    let arrays = &lifecycle.description().arrays;
    let mut found = Vec::new();
    for (k, element) in elements.iter().enumerate() {
        found.extend(lifecycle.dependencies(*element)?.into_iter().map(|reference| {
            let (shown, place) = arrays.shown(reference as usize);
            (k + 1, shown as u32, place + 1)
        }));
    }
    Ok(found)
}

/// `fmi3GetNumberOfVariableDependencies`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fmi3GetNumberOfVariableDependencies(
    instance: Instance,
    valueReference: u32,
    nDependencies: *mut usize,
) -> Status {
    call(instance, "fmi3GetNumberOfVariableDependencies", |component| {
        // SAFETY: NULL or valid, by the importer's obligations in `fmi3`.
        let place = unsafe { Places::new("nDependencies", nDependencies, 1) }?;
        place.put(0, dependencies(&component.lifecycle, valueReference)?.len());
        Ok(())
    })
}

/// `fmi3DependencyKind`: `fmi3Dependent`, no particular structure.
const DEPENDENT: i32 = 5;

/// `fmi3GetVariableDependencies`.
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
        let found = dependencies(&component.lifecycle, dependent)?;
        if found.len() != nDependencies {
            return Err(Refusal::Count { what: "dependencies", given: nDependencies, expected: found.len() });
        }
        // SAFETY: NULL or valid, by the importer's obligations in `fmi3`; each array is the importer's own.
        let (elements, references, places) = unsafe {
            list_mut("dependencyKinds", dependencyKinds, nDependencies)?.fill(DEPENDENT);
            (
                list_mut("elementIndicesOfDependent", elementIndicesOfDependent, nDependencies)?,
                list_mut("independents", independents, nDependencies)?,
                list_mut("elementIndicesOfIndependents", elementIndicesOfIndependents, nDependencies)?,
            )
        };
        for (k, (element, reference, place)) in found.into_iter().enumerate() {
            (elements[k], references[k], places[k]) = (element, reference, place);
        }
        Ok(())
    })
}
