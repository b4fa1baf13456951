//! The order of calls, without a C border, on a model that can be computed by hand ([`rail`]).
#![allow(clippy::unwrap_used)]

mod derivatives;
mod exchange;
mod rail;

use bekker_fmu::lifecycle::{Lifecycle, Phase, Refusal, Type};
use bekker_fmu::model::EventOutcome;
use rail::{ROUNDING, STEP, TIME, U, X, X0, get, rail, set};

/// An instance in step mode at time `start`.
fn running(start: f64, stop: Option<f64>) -> Lifecycle {
    let mut life = Lifecycle::new(Box::new(rail()));
    life.enter_initialization(start, stop).unwrap();
    life.exit_initialization().unwrap();
    life
}

#[test]
fn analytic_a_whole_life() {
    let mut life = Lifecycle::new(Box::new(rail()));
    assert!(matches!(get(&mut life, X), Err(Refusal::NotComputed(_))));
    set(&mut life, X0, 0.5).unwrap();
    life.enter_initialization(10.0, Some(20.0)).unwrap();
    assert_eq!(get(&mut life, X).unwrap(), 0.5);
    set(&mut life, X0, -0.5).unwrap();
    assert_eq!(get(&mut life, X).unwrap(), -0.5, "outputs follow the start values in initialization");
    life.exit_initialization().unwrap();
    set(&mut life, U, 2.0).unwrap();
    let progress = life.step(10.0, 0.3).unwrap();
    assert!((progress.time - 10.3).abs() < ROUNDING && progress.ended.is_none());
    assert!((get(&mut life, X).unwrap() - 0.1).abs() < ROUNDING);
    assert!((get(&mut life, TIME).unwrap() - 10.3).abs() < ROUNDING);
    life.terminate().unwrap();
    assert!((get(&mut life, X).unwrap() - 0.1).abs() < ROUNDING, "readable after the end");
    life.reset();
    assert_eq!(life.phase(), Phase::Instantiated);
    assert_eq!(get(&mut life, X0).unwrap(), 0.0, "reset brings the start values back");
}

#[test]
fn property_order_is_kept() {
    let mut life = Lifecycle::new(Box::new(rail()));
    let refused = |result: Result<(), Refusal>| assert!(matches!(result, Err(Refusal::Order { .. })), "{result:?}");
    refused(life.exit_initialization());
    refused(life.step(0.0, STEP).map(|_| ()));
    refused(life.terminate());
    life.enter_initialization(0.0, None).unwrap();
    refused(life.enter_initialization(0.0, None));
    refused(life.step(0.0, STEP).map(|_| ()));
    life.exit_initialization().unwrap();
    refused(life.exit_initialization());
    life.terminate().unwrap();
    refused(life.step(0.0, STEP).map(|_| ()));
    refused(life.terminate());
}

#[test]
fn property_causality_and_bounds_are_kept() {
    let mut life = running(0.0, None);
    for reference in [TIME, X, X0] {
        assert!(matches!(set(&mut life, reference, 0.0), Err(Refusal::ReadOnly { .. })), "{reference}");
    }
    for value in [f64::NAN, f64::INFINITY, 5.1] {
        assert!(matches!(set(&mut life, U, value), Err(Refusal::Value { .. })), "{value}");
    }
    let half = life.set(&[U, X], Type::Real, &[3.0, 0.0]);
    assert!(matches!(half, Err(Refusal::ReadOnly { .. })));
    assert_eq!(get(&mut life, U).unwrap(), 1.0, "a refused list sets nothing");
    assert!(matches!(get(&mut life, 7), Err(Refusal::Reference { reference: 7, largest: 6 })));
    assert!(matches!(life.set(&[U], Type::Real, &[]), Err(Refusal::Length { .. })));
    assert!(matches!(life.expect(&[X], Type::Other("a string")), Err(Refusal::Type { .. })));
}

#[test]
fn property_times_and_steps_are_checked() {
    let mut life = running(0.0, Some(1.0));
    let steps = [(0.0, 0.0), (0.0, -STEP), (0.0, f64::NAN), (0.0, 1.1), (0.1, STEP), (0.0, 1e300)];
    for (current, size) in steps.into_iter().chain([(f64::NAN, STEP), (f64::INFINITY, STEP)]) {
        assert!(matches!(life.step(current, size), Err(Refusal::Time(_))), "{current}, {size}");
    }
    assert_eq!(life.time(), 0.0, "a refused step does nothing");
    for (start, stop) in [(f64::NAN, None), (f64::INFINITY, None), (0.0, Some(0.0)), (1.0, Some(f64::NAN))] {
        let mut life = Lifecycle::new(Box::new(rail()));
        assert!(matches!(life.enter_initialization(start, stop), Err(Refusal::Time(_))), "{start}, {stop:?}");
    }
    let mut endless = running(0.0, None);
    for size in [3600.1, 1e300] {
        assert!(matches!(endless.step(0.0, size), Err(Refusal::Long { .. })), "would not come back for long");
    }
    set(&mut endless, U, 0.0).unwrap();
    let longest = endless.step(0.0, 3600.0).unwrap().time;
    assert!((longest - 3600.0).abs() < 3600.0 * ROUNDING, "the longest in one call");
}

#[test]
fn property_a_host_may_add_up_its_time() {
    let mut life = running(0.0, None);
    set(&mut life, U, 0.0).unwrap();
    let mut time = 0.0;
    for _ in 0..100_000 {
        life.step(time, STEP).unwrap();
        time += STEP;
    }
    assert_ne!(life.time(), time, "the sum has rounded, the model has counted");
}

#[test]
fn analytic_an_end_is_no_error() {
    let mut life = running(0.0, None);
    let progress = life.step(0.0, 10.0).unwrap();
    assert_eq!(progress.ended.as_deref(), Some("end of the rail"));
    assert!(progress.time > 2.0 - ROUNDING && progress.time < 2.2 + ROUNDING, "{}", progress.time);
    assert!(matches!(life.step(progress.time, STEP), Err(Refusal::Ended(_))));
    life.terminate().unwrap();
}

#[test]
fn property_a_failure_leaves_reset_and_restore() {
    let mut life = running(0.0, None);
    let saved = life.clone();
    set(&mut life, U, -5.0).unwrap();
    assert!(matches!(life.step(0.0, STEP), Err(Refusal::Failed(_))));
    assert_eq!(life.phase(), Phase::Failed);
    assert!(matches!(life.step(0.0, STEP), Err(Refusal::Order { .. })));
    assert!(matches!(set(&mut life, U, 1.0), Err(Refusal::ReadOnly { .. })));
    life = saved;
    life.step(0.0, STEP).unwrap();
    life.fail();
    life.reset();
    life.enter_initialization(0.0, None).unwrap();
    set(&mut life, X0, 1.0).unwrap();
    assert!(matches!(life.exit_initialization(), Err(Refusal::Failed(_))));
    set(&mut life, X0, 0.9).unwrap();
    life.exit_initialization().expect("corrected start values are taken");
}

#[test]
fn property_a_clone_is_a_saved_state() {
    let mut life = running(0.0, None);
    life.step(0.0, STEP).unwrap();
    let mut saved = life.clone();
    for _ in 0..3 {
        let time = life.time();
        life.step(time, STEP).unwrap();
        saved.step(time, STEP).unwrap();
    }
    assert_eq!(get(&mut life, X).unwrap().to_bits(), get(&mut saved, X).unwrap().to_bits());
}

#[test]
fn analytic_points_between_inner_steps_do_not_change_the_simulation() {
    let (mut coarse, mut fine) = (running(0.0, None), running(0.0, None));
    let mut time = 0.0;
    for size in [0.03, 0.07, 0.05, 0.05, 0.15, 0.25, 0.4] {
        fine.step(time, size).unwrap();
        time += size;
        assert!((get(&mut fine, X).unwrap() - time).abs() < ROUNDING, "between two places it is on the line");
    }
    coarse.step(0.0, 1.0).unwrap();
    assert_eq!(get(&mut fine, X).unwrap().to_bits(), get(&mut coarse, X).unwrap().to_bits());
    assert!((fine.time() - 1.0).abs() < ROUNDING);
}

#[test]
fn property_a_state_survives_as_bytes() {
    let mut life = running(3.0, Some(10.0));
    set(&mut life, U, 0.7).unwrap();
    life.step(3.0, 0.45).unwrap();
    life.set_input_derivatives(&[U], &[1], &[0.5]).unwrap();
    let bytes = life.to_bytes().unwrap();
    let mut other = Lifecycle::new(Box::new(rail())).from_bytes(&bytes).unwrap();
    assert_eq!((other.phase(), other.time()), (life.phase(), life.time()));
    for life in [&mut life, &mut other] {
        let time = life.time();
        life.step(time, 0.6).unwrap();
        assert!(matches!(life.step(4.05, 6.0), Err(Refusal::Time(_))), "the stop time is kept");
    }
    assert_eq!(get(&mut life, X).unwrap().to_bits(), get(&mut other, X).unwrap().to_bits());
    for end in 0..bytes.len() {
        assert!(matches!(life.from_bytes(&bytes[..end]), Err(Refusal::Bytes(_))), "truncated at {end}");
    }
    for place in 0..bytes.len() {
        let mut damaged = bytes.clone();
        damaged[place] ^= 0x10;
        assert!(matches!(life.from_bytes(&damaged), Err(Refusal::Bytes(_))), "damaged at {place}");
    }
    let exchange = Lifecycle::exchange(Box::new(rail())).unwrap();
    assert!(matches!(exchange.from_bytes(&bytes), Err(Refusal::Bytes(_))), "of the other interface");
}

#[test]
fn property_event_mode_of_cosimulation() {
    let mut life = Lifecycle::cosimulation(Box::new(rail()), true);
    life.enter_initialization(0.0, None).unwrap();
    life.exit_initialization().unwrap();
    assert_eq!(life.phase(), Phase::Event);
    assert!(matches!(life.step(0.0, STEP), Err(Refusal::Order { .. })));
    assert_eq!(life.update_discrete_states().unwrap(), EventOutcome::default());
    life.enter_step_mode().unwrap();
    life.step(0.0, STEP).unwrap();
    life.enter_event_mode().unwrap();
    set(&mut life, U, 2.0).unwrap();
    life.enter_step_mode().unwrap();
    life.step(STEP, 10.0).unwrap();
    life.enter_event_mode().unwrap();
    assert_eq!(life.update_discrete_states().unwrap().terminate.as_deref(), Some("end of the rail"));
    life.terminate().unwrap();
}
