//! A cart on a rail, a model that can be computed by hand: x' = u, h = 0.1. As differential equations, the same cart has the
//! state x; at the end of the rail, x = 2, it is put back to 0.

use bekker_fmu::lifecycle::{Lifecycle, Refusal, Type};
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

pub const TIME: u32 = 0;
pub const X0: u32 = 1;
pub const U: u32 = 2;
pub const X: u32 = 3;
pub const STATE: u32 = 4;
pub const RATE: u32 = 5;
pub const INDICATOR: u32 = 6;
pub const STEP: f64 = 0.1;
/// Rounding of a few dozen additions of order one.
pub const ROUNDING: f64 = 1e-12;

/// The rail ends at x = 2; the cart cannot start at x0 = 1, and fails for u = -5.
#[derive(Clone)]
pub struct Rail {
    description: Description,
    cart: Cart,
    steps: u64,
    /// Place at the last inner step and the one before, and the time that is shown.
    places: [f64; 2],
    shown: f64,
    rate: f64,
}

pub fn rail() -> Rail {
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
        author: String::new(),
        copyright: String::new(),
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

    fn states_set_at_event(&mut self) {}

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

pub fn get(life: &mut Lifecycle, reference: u32) -> Result<f64, Refusal> {
    let mut found = f64::NAN;
    life.get(&[reference], Type::Real, &mut |_, value| found = value).map(|()| found)
}

pub fn set(life: &mut Lifecycle, reference: u32, value: f64) -> Result<(), Refusal> {
    life.set(&[reference], Type::Real, &[value])
}
