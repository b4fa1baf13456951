//! The order of calls, without a C border, on a model that can be computed by hand: x' = u, h = 0.1.
#![allow(clippy::unwrap_used)]

use bekker_fmu::lifecycle::{Lifecycle, Phase, Refusal, Type};
use bekker_fmu::model::{Failure, Model, Outcome};
use bekker_modeldescription::xml::{Description, Entry, Experiment};
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
const STEP: f64 = 0.1;
/// Rounding of a few dozen additions of order one.
const ROUNDING: f64 = 1e-12;

/// The rail ends at x = 2; the cart cannot start at x0 = 1, and fails for u = -5.
#[derive(Clone)]
struct Rail {
    description: Description,
    cart: Cart,
    steps: u64,
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
    let description = Description {
        name: "cart".into(),
        identifier: "cart".into(),
        description: String::new(),
        version: String::new(),
        license: String::new(),
        generation_tool: String::new(),
        experiment: Experiment { start: 0.0, stop: 1.0, step: STEP },
        inner_step: STEP,
        log_categories: &[],
        content: String::new(),
        entries,
    };
    Rail { description, cart, steps: 0 }
}

impl Model for Rail {
    fn description(&self) -> &Description {
        &self.description
    }

    fn get(&self, reference: usize) -> f64 {
        [f64::NAN, self.cart.x0, self.cart.u, self.cart.x][reference]
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
        (self.cart.x, self.steps) = (self.cart.x0, 0);
        Ok(())
    }

    fn inner_step(&self) -> f64 {
        STEP
    }

    fn elapsed(&self) -> f64 {
        self.steps as f64 * STEP
    }

    fn advance(&mut self, steps: u64) -> Result<Outcome, Failure> {
        for _ in 0..steps {
            if self.cart.u == -5.0 {
                return Err(Failure("too fast".into()));
            }
            self.cart.x += self.cart.u * STEP;
            self.steps += 1;
            if self.cart.x > 2.0 {
                return Ok(Outcome::Ended { reason: "end of the rail".into() });
            }
        }
        Ok(Outcome::Running)
    }

    fn reset(&mut self) {
        self.cart = Cart::default();
    }

    fn duplicate(&self) -> Box<dyn Model> {
        Box::new(self.clone())
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
    assert!(matches!(get(&mut life, 4), Err(Refusal::Reference { reference: 4, largest: 3 })));
    assert!(matches!(life.set(&[U], Type::Real, &[]), Err(Refusal::Length { .. })));
    assert!(matches!(life.expect(&[X], Type::Other("a string")), Err(Refusal::Type { .. })));
}

#[test]
fn property_times_and_steps_are_checked() {
    let mut life = running(0.0, Some(1.0));
    let steps =
        [(0.0, 0.0), (0.0, -STEP), (0.0, f64::NAN), (0.0, 0.05), (0.0, 0.15), (0.0, 1.1), (0.1, STEP), (0.0, 1e300)];
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
