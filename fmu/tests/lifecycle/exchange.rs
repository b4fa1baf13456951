//! The order of calls in model exchange.

use crate::rail::{INDICATOR, ROUNDING, STATE, U, X, X0, get, rail, set};
use crate::running;
use bekker_fmu::lifecycle::{Lifecycle, Phase, Refusal};
use bekker_fmu::model::{EventOutcome, Failure};

/// An instance for model exchange at its first event.
fn exchange(x0: f64) -> Lifecycle {
    let mut life = Lifecycle::exchange(Box::new(rail())).unwrap();
    set(&mut life, X0, x0).unwrap();
    life.enter_initialization(5.0, None).unwrap();
    life.exit_initialization().unwrap();
    life
}

#[test]
fn analytic_model_exchange_from_start_to_event() {
    let mut life = exchange(0.5);
    assert_eq!((life.phase(), life.sizes().unwrap()), (Phase::Event, (1, 1)));
    let outcome = life.update_discrete_states().unwrap();
    assert_eq!((outcome.states_changed, outcome.next_time), (false, Some(6.0)), "times are the host's");
    life.enter_continuous_time().unwrap();
    set(&mut life, U, 1.5).unwrap();
    let mut state = [0.0];
    life.states(&mut state).unwrap();
    for k in 0..11 {
        let mut rate = [0.0];
        life.state_derivatives(&mut rate).unwrap();
        assert_eq!(rate, [1.5]);
        state[0] += 0.1 * rate[0];
        life.set_time(5.0 + 0.1 * f64::from(k + 1)).unwrap();
        life.set_states(&state).unwrap();
        assert_eq!(get(&mut life, X).unwrap(), state[0]);
        assert_eq!(life.completed_step().unwrap(), EventOutcome::default());
    }
    let mut indicator = [0.0];
    life.event_indicators(&mut indicator).unwrap();
    assert!((indicator[0] - (2.0 - 0.5 - 1.65)).abs() < ROUNDING);
    assert_eq!(get(&mut life, INDICATOR).unwrap(), indicator[0], "also by its reference");
    life.enter_event_mode().unwrap();
    assert!(life.update_discrete_states().unwrap().states_changed);
    life.states(&mut state).unwrap();
    assert_eq!((state, get(&mut life, STATE).unwrap()), ([0.0], 0.0));
    life.enter_continuous_time().unwrap();
    life.set_states(&[-3.0]).unwrap();
    assert_eq!(life.completed_step().unwrap().terminate.as_deref(), Some("fell off"));
    life.terminate().unwrap();
}

#[test]
fn property_the_order_of_model_exchange_is_kept() {
    let mut life = exchange(0.0);
    let order = |result: Result<(), Refusal>| assert!(matches!(result, Err(Refusal::Order { .. })), "{result:?}");
    let unsupported =
        |result: Result<(), Refusal>| assert!(matches!(result, Err(Refusal::Unsupported(_))), "{result:?}");
    order(life.step(5.0, 0.1).map(|_| ()));
    order(life.completed_step().map(|_| ()));
    order(life.enter_event_mode());
    unsupported(life.enter_step_mode());
    assert!(matches!(life.set_states(&[]), Err(Refusal::Count { .. })));
    assert!(matches!(life.set_time(4.0), Err(Refusal::Time(_))));
    assert!(matches!(life.set_time(f64::NAN), Err(Refusal::Time(_))));
    life.enter_continuous_time().unwrap();
    order(life.update_discrete_states().map(|_| ()));
    life.set_states(&[101.0]).unwrap();
    let mut rate = [0.0];
    assert!(matches!(life.state_derivatives(&mut rate), Err(Refusal::Discarded(_))), "the host may try another");
    life.set_states(&[1.0]).unwrap();
    life.state_derivatives(&mut rate).unwrap();
    let mut other = running(0.0, None);
    unsupported(other.set_time(1.0));
    unsupported(other.states(&mut [0.0]));
    unsupported(other.enter_event_mode());
    unsupported(other.enter_continuous_time());
}

#[test]
fn property_memory_that_is_no_state_is_named() {
    let mut life = Lifecycle::exchange(Box::new(rail())).unwrap();
    life.enter_initialization(0.0, None).unwrap();
    set(&mut life, X0, -1.0).unwrap();
    let refused = life.exit_initialization().unwrap_err();
    assert_eq!(refused, Refusal::Failed(Failure("the dead time of the drive is a memory".into())));
    set(&mut life, X0, 0.0).unwrap();
    life.exit_initialization().expect("corrected");
}
