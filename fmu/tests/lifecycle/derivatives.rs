//! Derivatives: of inputs and outputs in time, of states, and of unknowns by knowns.

use crate::rail::{INDICATOR, RATE, ROUNDING, STATE, STEP, TIME, U, X, get, set};
use crate::running;
use bekker_fmu::lifecycle::{Direction, Refusal};

#[test]
fn analytic_inputs_follow_their_derivatives() {
    let mut life = running(0.0, None);
    set(&mut life, U, 0.0).unwrap();
    // u = 2 t + t^2 gives x = t^2 + t^3/3; the inputs of the middles of ten steps give the first exactly and the
    // second but for h^2/12 of its third derivative, 1/3 0.01/4.
    life.set_input_derivatives(&[U, U], &[1, 2], &[2.0, 2.0]).unwrap();
    life.step(0.0, 1.0).unwrap();
    let midpoint_rule = 1.0 + (1.0 / 3.0 - STEP * STEP / 12.0);
    assert!((get(&mut life, X).unwrap() - midpoint_rule).abs() < ROUNDING, "{}", get(&mut life, X).unwrap());
    assert!((get(&mut life, U).unwrap() - 3.0).abs() < ROUNDING, "the value reached remains");
    life.step(1.0, 0.1).unwrap();
    assert!((get(&mut life, X).unwrap() - midpoint_rule - 0.3).abs() < ROUNDING, "the derivatives are forgotten");
    for (reference, order, value) in [(X, 1, 1.0), (U, 0, 1.0), (U, -1, 1.0), (U, 1, f64::NAN)] {
        let refused = life.set_input_derivatives(&[reference], &[order], &[value]);
        assert!(matches!(refused, Err(Refusal::Derivative(_))), "{reference} {order} {value}");
    }
    life.set_input_derivatives(&[U], &[1], &[100.0]).unwrap();
    let refused = life.step(life.time(), 0.1);
    assert!(matches!(refused, Err(Refusal::Value { .. })), "an input that would leave its bounds: {refused:?}");
    let time = life.time();
    life.step(time, 0.1).expect("the refused derivatives are forgotten");
}

#[test]
fn analytic_output_derivatives() {
    let mut life = running(0.0, None);
    set(&mut life, U, 2.5).unwrap();
    life.step(0.0, 0.25).unwrap();
    let mut found = f64::NAN;
    life.output_derivatives(&[X], &[1], &mut |_, value| found = value).unwrap();
    assert!((found - 2.5).abs() < ROUNDING, "{found}");
    assert!((life.time() - 0.25).abs() < ROUNDING, "a copy has made the step");
    for (reference, order) in [(U, 1), (X, 2), (X, 0)] {
        let refused = life.output_derivatives(&[reference], &[order], &mut |_, _| {});
        assert!(matches!(refused, Err(Refusal::Derivative(_))), "{reference} {order}");
    }
}

#[test]
fn property_partial_derivatives_are_asked_for_rightly() {
    let mut life = running(0.0, None);
    let mut result = [0.0];
    life.partial(Direction::Forward, &[X], &[U], &[3.0], &mut result).unwrap();
    assert_eq!(result, [3.0]);
    for (unknowns, knowns) in [(&[U][..], &[U][..]), (&[X], &[X]), (&[TIME], &[U])] {
        let refused = life.partial(Direction::Forward, unknowns, knowns, &[1.0], &mut result);
        assert!(matches!(refused, Err(Refusal::Derivative(_))), "{unknowns:?} {knowns:?}");
    }
    let refused = life.partial(Direction::Forward, &[X], &[U], &[f64::NAN], &mut result);
    assert!(matches!(refused, Err(Refusal::Derivative(_))));
    let refused = life.partial(Direction::Forward, &[X], &[U], &[], &mut result);
    assert!(matches!(refused, Err(Refusal::Count { .. })));
    let refused = life.partial(Direction::Adjoint, &[X], &[U], &[1.0], &mut result);
    assert!(matches!(refused, Err(Refusal::Failed(_))), "this model has none");
    assert_eq!(life.dependencies(X).unwrap(), [U, STATE]);
    assert!(life.dependencies(U).is_err());
}

#[test]
fn analytic_states_and_rates_are_read_in_cosimulation_too() {
    let mut life = running(0.0, None);
    set(&mut life, U, 0.5).unwrap();
    life.step(0.0, 0.4).unwrap();
    let found = [STATE, RATE, INDICATOR].map(|reference| get(&mut life, reference).unwrap());
    assert!((found[0] - 0.2).abs() < ROUNDING && found[1] == 0.5 && (found[2] - 1.8).abs() < ROUNDING, "{found:?}");
}
