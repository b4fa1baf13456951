//! A rover in motion: where the simulation of a recorded drive begins.

use super::SettleError;
use crate::contact::Hold;
use crate::effects::Digging;
use crate::linear::{Factors, Vector, zeros};
use crate::rover::dynamics::{DynamicsError, Evaluation};
use crate::rover::{Rover, State, Track};
use crate::scalar::{Dual, Mask, Scalar};
use crate::signals::Command;
use crate::vehicle::MAX_COORDINATES;

/// Acceleration below which the balance across the ground is met, m/s^2 and rad/s^2.
const BALANCED: f64 = 1e-8;
/// Newton iterations; from the first guess it takes four to eight.
const ITERATIONS: usize = 25;
/// Largest step of one of them, m and rad.
const LARGEST: f64 = 0.02;
/// Steps that carry derivatives to a balance found in plain numbers.
const DERIVATIVE_STEPS: usize = 2;

impl<S: Scalar> Rover<S> {
    /// The state in steady motion with the reference point above `x` (m), moving along the ground at `velocity` (m/s) with the
    /// wheels turning at `speeds` (rad/s, relative to the carrying body, rear to front), every contact as if it had always moved
    /// so, on ground that the wheels have `passed` before (none where that is empty). It stands as deep in the soil as its slip demands;
    /// along the ground it need not be in balance, since it may be speeding up.
    ///
    /// Where no balance is found, it stands as deep as at [rest](Self::settled_at), and what differs passes within tenths of a second.
    ///
    /// # Errors
    /// [`SettleError`] as for [`settled_at`](Self::settled_at).
    pub fn moving_at(&self, x: S, velocity: S, speeds: &[S], passed: &[Track]) -> Result<State<S>, SettleError> {
        let radius = self.true_wheel().radius;
        let holds: Vec<Hold<S>> = speeds.iter().map(|speed| held(velocity, radius * *speed)).collect();
        let mut state = match self.balanced(x, &holds, passed)? {
            Some(state) => state,
            None => self.settled_at(x)?,
        };
        let tracks = passed.iter().map(|track| track.map(&S::from));
        state.wheels.iter_mut().zip(tracks).for_each(|(wheel, track)| wheel.track = track);
        let (sin, cos) = state.position[2].sine_cosine();
        (state.rate[0], state.rate[1]) = (velocity * cos, velocity * sin);
        for ((wheel, speed), hold) in state.wheels.iter_mut().zip(speeds).zip(holds) {
            wheel.spin = *speed;
            if let Some(hold) = hold.moves() {
                (wheel.hold, wheel.dug_slip) = (hold, hold.dug_slip(self));
            }
        }
        Ok(state)
    }

    /// The balance across the ground under contacts that slip as `holds` say; `None` where Newton's method does not find it.
    /// Derivatives follow by the implicit function theorem, as at rest.
    fn balanced(&self, x: S, holds: &[Hold<S>], passed: &[Track]) -> Result<Option<State<S>>, SettleError> {
        let fail = |source| SettleError::Dynamics { x: x.value(), source };
        if holds.len() != self.wheels.len() || holds.iter().any(|hold| hold.moves().is_none()) {
            return Ok(None);
        }
        let plain = self.map(&|s| s.value());
        let plain_holds: Vec<Hold> =
            holds.iter().map(|hold| Hold { travel: hold.travel.value(), turn: hold.turn.value() }).collect();
        let mut guess = plain.placed_at(x.value()).map_err(fail)?;
        guess.wheels.iter_mut().zip(passed).for_each(|(wheel, track)| wheel.track = *track);
        let Some((rest, factors)) = newton(&plain, guess, &plain_holds) else { return Ok(None) };
        let mut state = rest.map(&S::from);
        (state.position[0], state.start_x) = (x, x);
        if S::NDERIV > 0 {
            carry(self, &mut state, &factors, holds).map_err(fail)?;
        }
        Ok(Some(state))
    }
}

impl<S: Scalar> Hold<S> {
    /// The same where there is any motion.
    fn moves(self) -> Option<Self> {
        (self.travel.value() != 0.0 || self.turn.value() != 0.0).then_some(self)
    }

    /// The steady value of `dug_slip` for this direction of motion; 0 where no effect of the rover keeps it.
    fn dug_slip(self, rover: &Rover<S>) -> S {
        let touches = S::Mask::from_lanes(|_| true);
        rover.effects.digging_length().map_or(S::from(0.0), |_| Digging::new(self.travel, self.turn, touches).steady())
    }
}

/// The memory of a contact that moves at `velocity` with this speed of the rim.
fn held<S: Scalar>(velocity: S, rim: S) -> Hold<S> {
    let size = velocity * velocity + rim * rim;
    if size.value() > 0.0 {
        let size = size.sqrt();
        Hold { travel: velocity / size, turn: rim / size }
    } else {
        Hold::default()
    }
}

/// Accelerations of a rover whose contacts remember `holds`, as a function of z, pitch and joints.
struct Across<'h, S> {
    evaluation: Evaluation<S>,
    command: Command,
    holds: &'h [Hold<S>],
}

impl<'h, S: Scalar> Across<'h, S> {
    fn new(rover: &Rover<S>, holds: &'h [Hold<S>]) -> Self {
        Self { evaluation: Evaluation::new(rover), command: Command::speed(vec![0.0; rover.wheels.len()]), holds }
    }

    /// All but the one along x, which is not asked for.
    fn accelerations(
        &mut self,
        rover: &Rover<S>,
        state: &mut State<S>,
        unknowns: &Vector<S>,
    ) -> Result<Vector<S>, DynamicsError> {
        let n = rover.coordinates();
        for (wheel, hold) in state.wheels.iter_mut().zip(self.holds) {
            (wheel.hold, wheel.dug_slip) = (*hold, hold.dug_slip(rover));
        }
        state.position[1..].copy_from_slice(&unknowns[..n - 1]);
        self.evaluation.update(rover, state, &self.command)?;
        let mut across = zeros();
        across[..n - 1].copy_from_slice(&self.evaluation.acceleration[1..n]);
        Ok(across)
    }
}

/// Newton's method; with the factors of the slopes where it ended. `None` where it fails.
fn newton(rover: &Rover, mut state: State, holds: &[Hold]) -> Option<(State, Factors<f64>)> {
    let n = rover.coordinates();
    let mut across = Across::new(rover, holds);
    let lifted = rover.map(&Dual::<1>::from);
    let lifted_holds: Vec<Hold<Dual<1>>> =
        holds.iter().map(|hold| Hold { travel: hold.travel.into(), turn: hold.turn.into() }).collect();
    let mut slopes = Across::new(&lifted, &lifted_holds);
    let mut unknowns = zeros();
    unknowns[..n - 1].copy_from_slice(&state.position[1..]);
    for _ in 0..ITERATIONS {
        let left = across.accelerations(rover, &mut state, &unknowns).ok()?;
        let mut lifted_state = state.map(&Dual::<1>::from);
        let mut jacobian = [zeros(); MAX_COORDINATES];
        for j in 0..n - 1 {
            let mut seeded = unknowns.map(Dual::<1>::from);
            seeded[j] = seeded[j].derivative(0);
            let there = slopes.accelerations(&lifted, &mut lifted_state, &seeded).ok()?;
            (0..n - 1).for_each(|i| jacobian[i][j] = there[i].eps.0.map_or(0.0, |eps| eps[0]));
        }
        let factors = Factors::new(&jacobian, n - 1)?;
        if left[..n - 1].iter().all(|a| a.abs() < BALANCED) {
            return Some((state, factors));
        }
        let change = factors.solve(&left);
        let scale = change[..n - 1].iter().fold(LARGEST, |most, step| most.max(step.abs())) / LARGEST;
        (0..n - 1).for_each(|i| unknowns[i] -= change[i] / scale);
    }
    None
}

/// Carries derivatives to a balance found in plain numbers.
fn carry<S: Scalar>(
    rover: &Rover<S>,
    state: &mut State<S>,
    factors: &Factors<f64>,
    holds: &[Hold<S>],
) -> Result<(), DynamicsError> {
    let n = rover.coordinates();
    let mut across = Across::new(rover, holds);
    let mut unknowns = zeros();
    unknowns[..n - 1].copy_from_slice(&state.position[1..]);
    for _ in 0..DERIVATIVE_STEPS {
        let left = across.accelerations(rover, state, &unknowns)?;
        let change = factors.solve(&left);
        // The real part is settled; what it would still move is rounding.
        (0..n - 1).for_each(|i| unknowns[i] -= change[i] - change[i].value());
    }
    state.position[1..].copy_from_slice(&unknowns[..n - 1]);
    Ok(())
}
