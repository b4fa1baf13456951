//! FMI 3.0 with arrays: one variable for the same quantity of every wheel.
#![allow(clippy::unwrap_used)]

mod host;

use bekker_fmu::fmi3::*;
use bekker_fmu::{Kind, Offer};
use bekker_modeldescription::xml::Abilities;
use host::{Fmu, INNER, messages, model, set, step};

/// The values that `references` stand for.
fn get(instance: Instance, references: &[u32], places: usize) -> Result<Vec<f64>, Status> {
    let mut values = vec![f64::NAN; places];
    // SAFETY: as many references and places as are told.
    match unsafe { fmi3GetFloat64(instance, references.as_ptr(), references.len(), values.as_mut_ptr(), places) } {
        Status::Ok => Ok(values),
        status => Err(status),
    }
}

fn arrays(preset: &str) -> Fmu {
    Fmu::offering(&model(preset), Offer { kind: None, arrays: true })
}

#[test]
fn agreement_of_arrays_with_scalars() {
    let (one, other) = (Fmu::preset("rocker_bogie"), arrays("rocker_bogie"));
    let [scalar, array] = [&one, &other].map(Fmu::running);
    let torques: Vec<u32> = (1..=3).map(|k| one.reference(&format!("wheel[{k}].torque_command"))).collect();
    let slips: Vec<u32> = (1..=3).map(|k| one.reference(&format!("wheel[{k}].slip"))).collect();
    let x = one.reference("x");
    for k in 0..50 {
        let values = [0.4, 0.5, 0.3 + 0.01 * f64::from(k)];
        assert_eq!(set(scalar, &torques, &values), Status::Ok, "{:?}", messages());
        assert_eq!(set(array, &torques[..1], &values), Status::Ok, "{:?}", messages());
        for instance in [scalar, array] {
            let stepped = step(instance, f64::from(k) * 10.0 * INNER, 10.0 * INNER);
            assert_eq!((stepped.status, stepped.terminate), (Status::Ok, false), "{:?}", messages());
        }
        let expected = get(scalar, &[x, slips[0], slips[1], slips[2]], 4).unwrap();
        assert_eq!(get(array, &[x, slips[0]], 4).unwrap(), expected, "step {k}");
    }
    for instance in [scalar, array] {
        fmi3FreeInstance(instance);
    }
}

#[test]
fn agreement_of_derivatives_by_an_array() {
    let (one, other) = (Fmu::preset("two_wheeled"), arrays("two_wheeled"));
    let [scalar, array] = [&one, &other].map(Fmu::running);
    let (torque, slip) = (one.reference("wheel[1].torque_command"), one.reference("wheel[1].slip"));
    let (torque_2, slip_2) = (one.reference("wheel[2].torque_command"), one.reference("wheel[2].slip"));
    for (instance, list) in [(scalar, vec![torque, torque_2]), (array, vec![torque])] {
        assert_eq!(set(instance, &list, &[1.0, 1.2]), Status::Ok);
        assert_eq!(step(instance, 0.0, 0.5).status, Status::Ok);
    }
    let along = |instance, unknowns: &[u32], knowns: &[u32]| {
        let (seed, mut result) = ([0.3, 0.7], [f64::NAN; 2]);
        // SAFETY: lists and places with their lengths.
        let status = unsafe {
            let (u, k, place) = (unknowns.as_ptr(), knowns.as_ptr(), result.as_mut_ptr());
            fmi3GetDirectionalDerivative(instance, u, unknowns.len(), k, knowns.len(), seed.as_ptr(), 2, place, 2)
        };
        assert_eq!(status, Status::Ok, "{:?}", messages());
        result
    };
    assert_eq!(along(array, &[slip], &[torque]), along(scalar, &[slip, slip_2], &[torque, torque_2]));
    for instance in [scalar, array] {
        fmi3FreeInstance(instance);
    }
}

#[test]
fn property_elements_are_reached_by_their_array_alone() {
    let fmu = arrays("two_wheeled");
    let instance = fmu.running();
    let (first, second) = (fmu.reference("wheel[1].slip"), fmu.reference("wheel[2].slip"));
    assert!(get(instance, &[first], 2).is_ok());
    assert!(get(instance, &[first], 1).is_err(), "an array of two in one place");
    assert!(get(instance, &[second], 1).is_err(), "a later element has no reference");
    let torque = fmu.reference("wheel[1].torque_command");
    assert_ne!(set(instance, &[torque], &[1.0]), Status::Ok, "one value for an array of two");
    let mut count = 0;
    let torques = fmu.reference("wheel[1].torque");
    // SAFETY: one place.
    assert_eq!(unsafe { fmi3GetNumberOfVariableDependencies(instance, torques, &raw mut count) }, Status::Ok);
    let (mut element, mut other, mut place, mut kind) =
        (vec![0; count], vec![0; count], vec![0; count], vec![0; count]);
    // SAFETY: `count` places each.
    let status = unsafe {
        let (a, b, c, d) = (element.as_mut_ptr(), other.as_mut_ptr(), place.as_mut_ptr(), kind.as_mut_ptr());
        fmi3GetVariableDependencies(instance, torques, a, b, c, d, count)
    };
    assert_eq!(status, Status::Ok, "{:?}", messages());
    for k in [1, 2] {
        for input in [1, 2] {
            let found = (0..count).any(|i| (element[i], other[i], place[i]) == (k, torque, input));
            assert_eq!(found, k == input, "torque of wheel {k}, command of wheel {input}");
        }
    }
    fmi3FreeInstance(instance);
}

#[test]
fn property_the_description_tells_of_arrays() {
    let model = model("two_wheeled");
    let (text, description) = bekker_fmu::describe_as(&model, Offer { kind: Some(Kind::Rover), arrays: true }).unwrap();
    assert!(text.contains("arrays = true"), "the library finds it in the packed model");
    let xml = description.fmi3(&Abilities::default()).unwrap();
    assert!(xml.contains("name=\"wheels.slip\"") && xml.contains("<Dimension start=\"2\"/>"));
    assert!(!xml.contains("name=\"wheel[2].slip\""));
    assert!(description.terminals().unwrap().contains("variableName=\"wheels.torque_command\""));
}
