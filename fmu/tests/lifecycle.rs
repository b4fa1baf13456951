//! The order of calls, without a C border, on a model that can be computed by hand: x' = u, h = 0.1.
//! As differential equations, the same cart has the state x; at the end of the rail, x = 2, it is put back to 0.
#![allow(clippy::unwrap_used)]

use bekker_fmu::lifecycle::{Direction, Lifecycle, Phase, Refusal, Type};
use bekker_fmu::model::{Continuous, EventOutcome, Failure, FmuModel, Outcome};
use bekker_modeldescription::xml::{Arrays, Description, Entry, Experiment};
use bekker_modeldescription::{Lookup, Unit, parameters};

parameters! {
    /// A cart on a rail.
    struct Cart {
        /// Start.
        x0: [Unit::METRE] = 0.0, -1.0..=1.0, Fixed, "";
        /// Speed.
        u: [Unit::METRE_PER_SECOND] = 1.0, -5.0..=5.0, Signal, "";
        /// Place.
        x: [Unit::METRE] = 0.0, f64::NEG_INFINITY..=f64::INFINITY, Signal, "";
    }
}

const TIME: u32 = 0;
const X0: u32 = 1;
const U: u32 = 2;
const X: u32 = 3;
const STATE: u32 = 4;
const RATE: u32 = 5;
const INDICATOR: u32 = 6;
const STEP: f64 = 0.1;
/// Rounding of a few dozen additions of order one.
const ROUNDING: f64 = 1e-12;

/// The rail ends at x = 2; the cart cannot start at x0 = 1, and fails for u = -5.
#[derive(Clone)]
struct Rail {
    description: Description,
    cart: Cart,
    steps: u64,
    /// Place at the last inner step and the one before, and the time that is shown.
    places: [f64; 2],
    shown: f64,
    rate: f64,
}

fn rail() -> Rail {
    let mut cart = Cart::default();
    let mut entries = vec![Entry::time()];
    for (variable, value) in cart.list() {
        entries.push(match variable.name.as_str() {
            "x0" => Entry::parameter(variable, value),
            "u" => Entry::input(variable, value),
            _ => Entry::output(variable),
        });
    }
    let (_, x) = cart.list().pop().map(|(variable, value)| (value, variable)).unwrap();
    let named = |name: &str| bekker_modeldescription::Variable { name: name.into(), ..x.clone() };
    entries.push(Entry::state(named("state"), 1.0));
    entries.push(Entry::derivative(named("rate"), STATE as usize));
    let description = Description {
        name: "cart".into(),
        identifier: "cart".into(),
        description: String::new(),
        version: String::new(),
        license: String::new(),
        generation_tool: String::new(),
        date: None,
        experiment: Experiment { start: 0.0, stop: 1.0, step: STEP },
        inner_step: STEP,
        log_categories: &[],
        content: String::new(),
        entries,
        arrays: Arrays::default(),
    };
    Rail { description, cart, steps: 0, places: [0.0; 2], shown: 0.0, rate: f64::NAN }
}

impl FmuModel for Rail {
    fn description(&self) -> &Description {
        &self.description
    }

    fn get(&self, reference: usize) -> f64 {
        [f64::NAN, self.cart.x0, self.cart.u, self.cart.x, self.cart.x, self.rate][reference]
    }

    fn set(&mut self, reference: usize, value: f64) {
        match reference {
            1 => self.cart.x0 = value,
            _ => self.cart.u = value,
        }
    }

    fn start(&mut self) -> Result<(), Failure> {
        if self.cart.x0 == 1.0 {
            return Err(Failure("the cart does not stand at 1 m".into()));
        }
        (self.cart.x, self.steps, self.shown) = (self.cart.x0, 0, 0.0);
        self.places = [self.cart.x0; 2];
        Ok(())
    }

    fn inner_step(&self) -> f64 {
        STEP
    }

    fn elapsed(&self) -> f64 {
        self.shown
    }

    fn advance(&mut self, steps: u64) -> Result<Outcome, Failure> {
        for _ in 0..steps {
            if self.cart.u == -5.0 {
                return Err(Failure("too fast".into()));
            }
            self.places = [self.places[1], self.places[1] + self.cart.u * STEP];
            self.steps += 1;
            (self.cart.x, self.shown) = (self.places[1], self.steps as f64 * STEP);
            if self.cart.x > 2.0 {
                return Ok(Outcome::Ended { reason: "end of the rail".into() });
            }
        }
        Ok(Outcome::Running)
    }

    fn advance_to(&mut self, time: f64) -> Result<Outcome, Failure> {
        while self.steps as f64 * STEP < time - ROUNDING {
            if let Outcome::Ended { reason } = self.advance(1)? {
                return Ok(Outcome::Ended { reason });
            }
        }
        let share = 1.0 - (self.steps as f64 * STEP - time) / STEP;
        self.cart.x = self.places[0] + share * (self.places[1] - self.places[0]);
        self.shown = time;
        Ok(Outcome::Running)
    }

    fn reset(&mut self) {
        self.cart = Cart::default();
    }

    fn duplicate(&self) -> Box<dyn FmuModel> {
        Box::new(self.clone())
    }

    fn serialise(&self) -> Result<Vec<u8>, Failure> {
        let values = [self.cart.x0, self.cart.u, self.cart.x, self.places[0], self.places[1], self.shown];
        let values = values.iter().flat_map(|value| value.to_le_bytes());
        Ok(values.chain(self.steps.to_le_bytes()).collect())
    }

    fn deserialise(&mut self, bytes: &[u8]) -> Result<(), Failure> {
        let (values, steps) =
            bytes.split_last_chunk::<8>().filter(|(rest, _)| rest.len() == 48).ok_or(Failure("?".into()))?;
        let values: Vec<f64> = values.chunks(8).map(|chunk| f64::from_le_bytes(chunk.try_into().unwrap())).collect();
        (self.cart.x0, self.cart.u, self.cart.x) = (values[0], values[1], values[2]);
        (self.places, self.shown, self.steps) = ([values[3], values[4]], values[5], u64::from_le_bytes(*steps));
        Ok(())
    }

    /// Of x by x0: one.
    fn directional(&mut self, _: &[usize], _: &[usize], seed: &[f64], out: &mut [f64]) -> Result<(), Failure> {
        out.fill(seed.iter().sum());
        Ok(())
    }

    fn continuous(&mut self) -> Option<&mut dyn Continuous> {
        Some(self)
    }
}

impl Continuous for Rail {
    fn check(&self) -> Result<(), Failure> {
        if self.cart.x0 == -1.0 { Err(Failure("the dead time of the drive is a memory".into())) } else { Ok(()) }
    }

    fn follow(&mut self) -> Result<(), Failure> {
        self.rate = self.cart.u;
        Ok(())
    }

    fn states(&self) -> &[usize] {
        &[STATE as usize]
    }

    fn derivatives(&self) -> &[usize] {
        &[RATE as usize]
    }

    fn set_time(&mut self, time: f64) {
        self.shown = time;
    }

    fn set_states(&mut self, x: &[f64]) -> Result<(), Failure> {
        self.cart.x = x[0];
        Ok(())
    }

    fn get_states(&self, x: &mut [f64]) {
        x[0] = self.cart.x;
    }

    fn nominals(&self, x: &mut [f64]) {
        x[0] = 1.0;
    }

    fn rates(&mut self, dx: &mut [f64]) -> Result<(), Failure> {
        if self.cart.x > 100.0 {
            return Err(Failure("beyond the world".into()));
        }
        self.rate = self.cart.u;
        dx[0] = self.rate;
        Ok(())
    }

    fn indicators(&self) -> usize {
        1
    }

    fn event_indicators(&mut self, z: &mut [f64]) -> Result<(), Failure> {
        z[0] = 2.0 - self.cart.x;
        Ok(())
    }

    fn handle_event(&mut self) -> Result<EventOutcome, Failure> {
        let states_changed = self.cart.x >= 2.0;
        if states_changed {
            self.cart.x = 0.0;
        }
        Ok(EventOutcome { states_changed, terminate: None, next_time: Some(self.shown + 1.0) })
    }

    fn completed_step(&mut self) -> Result<EventOutcome, Failure> {
        let terminate = (self.cart.x < -2.0).then(|| "fell off".to_owned());
        Ok(EventOutcome { terminate, ..EventOutcome::default() })
    }
}

fn get(life: &mut Lifecycle, reference: u32) -> Result<f64, Refusal> {
    let mut found = f64::NAN;
    life.get(&[reference], Type::Real, &mut |_, value| found = value).map(|()| found)
}

fn set(life: &mut Lifecycle, reference: u32, value: f64) -> Result<(), Refusal> {
    life.set(&[reference], Type::Real, &[value])
}

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
    assert!(matches!(endless.step(0.0, 1e300), Err(Refusal::Time(_))), "would not come back");
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
fn analytic_states_and_rates_are_read_in_cosimulation_too() {
    let mut life = running(0.0, None);
    set(&mut life, U, 0.5).unwrap();
    life.step(0.0, 0.4).unwrap();
    let found = [STATE, RATE, INDICATOR].map(|reference| get(&mut life, reference).unwrap());
    assert!((found[0] - 0.2).abs() < ROUNDING && found[1] == 0.5 && (found[2] - 1.8).abs() < ROUNDING, "{found:?}");
}

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
