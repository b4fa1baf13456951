//! The time step: ROS2, a linearly implicit Runge-Kutta method of order 2 (Verwer et al. 1999).
//!
//! Two solves a step with one matrix I - gamma h A:
//! (I - gamma h A) k1 = f(y), (I - gamma h A) k2 = f(y + h k1) - 2 k1, y' = y + h (3 k1 + k2)/2.
//! It is a W-method: order 2 holds for any A, so A need hold only what is stiff: the contact forces in
//! the velocities, in the spin (whose rate grows as 1/V) and in the standing contact's memory, and the
//! soil's normal stiffness. With gamma = 1 - 1/sqrt 2 and A the Jacobian it is L-stable: the step stays
//! stable from standstill to full slip without iterations, with a fixed cost, and the same bits every time.
//!
//! The wheels and their memories are eliminated by hand, which leaves a system in the generalised
//! coordinates alone.

mod condensed;
mod increment;

pub(crate) use increment::Increment;

use crate::linear::{Factors, add_outer, add_scaled, zeros};
use crate::rover::dynamics::{DynamicsError, Evaluation};
use crate::rover::{Rover, State};
use crate::scalar::{LaneAccess, Scalar, lanes};
use crate::signals::{Command, Drive};
use crate::snapshot::Moving;
use condensed::{Condensed, add_contact};

/// gamma = 1 - 1/sqrt 2.
pub(crate) const GAMMA: f64 = 1.0 - std::f64::consts::FRAC_1_SQRT_2;

/// Share of a joint's dry friction over its rate that A holds. The slope of dry friction says nothing of its reversal,
/// and with friction over rate itself the first stage overshoots to 1 - 1/gamma of a rate that a step would stop, where
/// friction does not grow along: the joint would chatter. Twice 1/gamma of it ends that stage at half the rate, and
/// the step between 0 and an eighth of it.
pub(crate) const DRY_FRICTION: f64 = 2.0 / GAMMA;

/// Memory of the integrator: evaluations and increments, allocated once.
#[derive(Clone, Debug, Moving, LaneAccess)]
pub(crate) struct Integrator<S = f64> {
    /// Right-hand side at the present state.
    pub now: Evaluation<S>,
    /// The same at the second stage, once a step's [`Integrator::stages`] are made.
    #[not_moving]
    pub ahead: Evaluation<S>,
    #[not_moving]
    predicted: State<S>,
    /// Solutions k1 and k2 of the stages.
    #[not_moving]
    pub first: Increment<S>,
    #[not_moving]
    pub second: Increment<S>,
    #[not_moving]
    condensed: Vec<Condensed<S>>,
}

impl<S: Scalar> Integrator<S> {
    pub fn new(rover: &Rover<S>, state: &State<S>) -> Self {
        let wheels = rover.wheels.len();
        let zero = S::from(0.0);
        let increment = Increment { position: zeros(), rate: zeros(), wheels: vec![[zero; 3]; wheels] };
        Self {
            now: Evaluation::new(rover),
            ahead: Evaluation::new(rover),
            predicted: state.clone(),
            first: increment.clone(),
            second: increment,
            condensed: vec![Condensed::zero(); wheels],
        }
    }

    /// Evaluates the right-hand side at `state`: needed before the first step and after a new command.
    pub fn evaluate<C: Copy + Into<S>>(
        &mut self,
        rover: &Rover<S>,
        state: &mut State<S>,
        command: &Command<C>,
    ) -> Result<(), DynamicsError> {
        self.ahead.update(rover, state, command)?;
        std::mem::swap(&mut self.now, &mut self.ahead);
        // Where the speed is imposed the spin is no free state; keep it in step with the body.
        for (wheel, evaluation) in state.wheels.iter_mut().zip(&self.now.wheels) {
            wheel.spin = evaluation.spin;
        }
        Ok(())
    }

    /// Takes a new command over, where the mask says so: [`Integrator::impose`] and [`Integrator::evaluate`].
    ///
    /// # Errors
    /// [`DynamicsError`]; nothing has changed then.
    pub fn change<C: Copy + Into<S>>(
        &mut self,
        rover: &Rover<S>,
        state: &mut State<S>,
        command: &Command<C>,
        mask: S::Mask,
    ) -> Result<(), DynamicsError> {
        self.predicted.copy_from(state);
        let changed = self.impose(rover, state, command, mask).and_then(|()| self.evaluate(rover, state, command));
        if changed.is_err() {
            state.copy_from(&self.predicted);
        }
        changed
    }

    /// Brings the wheels to newly imposed speeds at once, where the mask says so: the drives' impulses turn the bodies that carry
    /// them the other way, so that M du = sum a I (d omega - a du). `now` must hold the evaluation at `state`.
    ///
    /// # Errors
    /// [`DynamicsError`].
    pub fn impose<C: Copy + Into<S>>(
        &self,
        rover: &Rover<S>,
        state: &mut State<S>,
        command: &Command<C>,
        mask: S::Mask,
    ) -> Result<(), DynamicsError> {
        if command.drive != Drive::Speed {
            return Ok(());
        }
        let n = rover.coordinates();
        let (mut matrix, mut impulse) = (self.now.mass, zeros());
        for (wheel, &speed) in self.now.wheels.iter().zip(&command.values) {
            let inertia = rover.wheel.inertia;
            add_outer(&mut matrix, inertia, &wheel.turn, &wheel.turn, n);
            add_scaled(&mut impulse, inertia * (speed.into() - wheel.speed), &wheel.turn, n);
        }
        let change = Factors::new(&matrix, n).ok_or(DynamicsError::NotFinite)?.solve(&impulse);
        for (rate, change) in state.rate.iter_mut().zip(change) {
            *rate = S::select(mask, *rate + change, *rate);
        }
        Ok(())
    }
}

#[lanes]
impl<S: Scalar> Integrator<S> {
    /// One step of size `h`; `now` must hold the evaluation at `state` and does so again afterwards.
    ///
    /// # Errors
    /// [`DynamicsError`]; `state` is then left as it was before the step.
    pub fn step<C: Copy + Into<S>>(
        &mut self,
        rover: &Rover<S>,
        state: &mut State<S>,
        command: &Command<C>,
        h: f64,
    ) -> Result<(), DynamicsError> {
        self.stages(rover, state, command, h)?;
        self.predicted.copy_from(state);
        self.first.add_to(&mut self.predicted, 1.5 * h);
        self.second.add_to(&mut self.predicted, 0.5 * h);
        for wheel in &mut self.predicted.wheels {
            wheel.hold = wheel.hold.bounded();
        }
        dig(rover, [&self.now, &self.ahead], &mut self.predicted, h);
        self.ahead.update(rover, &self.predicted, command)?;
        std::mem::swap(&mut self.now, &mut self.ahead);
        std::mem::swap(state, &mut self.predicted);
        for (wheel, evaluation) in state.wheels.iter_mut().zip(&self.now.wheels) {
            wheel.spin = evaluation.spin;
            wheel.track.extend(evaluation.foot_x, evaluation.sinkage.over(0.0));
        }
        Ok(())
    }

    /// The two stages of a step of size `h`: `first`, `second` and the evaluation `ahead` at the second.
    ///
    /// # Errors
    /// [`DynamicsError`].
    #[lanes(entry)]
    pub fn stages<C: Copy + Into<S>>(
        &mut self,
        rover: &Rover<S>,
        state: &State<S>,
        command: &Command<C>,
        h: f64,
    ) -> Result<(), DynamicsError> {
        S::wide(|| {
            let gh = GAMMA * h;
            let factors = self.condense(rover, command.drive, gh)?;
            self.first.set(rover, state, &self.now);
            self.first.solve(rover, &self.now, &self.condensed, &factors, command.drive, gh);
            self.predicted.copy_from(state);
            self.first.add_to(&mut self.predicted, h);
            dig(rover, [&self.now, &self.now], &mut self.predicted, h);
            self.ahead.update(rover, &self.predicted, command)?;
            self.second.set(rover, &self.predicted, &self.ahead);
            self.second.add_scaled(&self.first, -2.0, rover.coordinates());
            self.second.solve(rover, &self.now, &self.condensed, &factors, command.drive, gh);
            Ok(())
        })
    }

    /// Warms the windings over the step of size `h` just made, where they warm.
    pub fn warm(&mut self, rover: &Rover<S>, state: &mut State<S>, h: f64) {
        if rover.effects.warming(S::from(0.0)).is_some() {
            // The evaluation at the start of the step is what was swapped out.
            self.now.warm(rover, &self.ahead, state, h);
        }
    }

    /// Eliminates spins and memories and factors the matrix that is left.
    fn condense(&mut self, rover: &Rover<S>, drive: Drive, gh: f64) -> Result<Factors<S>, DynamicsError> {
        let n = rover.coordinates();
        let mut matrix = self.now.system;
        for (wheel, condensed) in self.now.wheels.iter().zip(&mut self.condensed) {
            *condensed = Condensed::new(rover, wheel, drive, gh);
            add_contact(&mut matrix, wheel, condensed, gh, n);
        }
        for (j, link) in rover.links.iter().enumerate() {
            let friction = link.parameters.damping + self.now.joint_friction[j] * DRY_FRICTION;
            let stop = self.now.stop_damping[j] + self.now.stop_stiffness[j] * gh;
            matrix[3 + j][3 + j] += (friction + stop) * gh;
        }
        Factors::new(&matrix, n).ok_or(DynamicsError::NotFinite)
    }
}

/// Digs the ground under the wheels over `h` seconds, where it follows their slip: exactly for a constant motion, the mean of two
/// evaluations, so that it is stable at any length. With the motions at the two stages it is of order 2 where v h is small beside the length.
#[lanes]
pub(crate) fn dig<S: Scalar>(rover: &Rover<S>, [from, to]: [&Evaluation<S>; 2], state: &mut State<S>, h: f64) {
    let Some(length) = rover.effects.digging_length() else { return };
    let radius = rover.true_wheel().radius;
    for ((wheel, from), to) in state.wheels.iter_mut().zip(&from.wheels).zip(&to.wheels) {
        let motion = from.digging(radius).mean(to.digging(radius));
        wheel.dug_slip = motion.after(wheel.dug_slip, length, h);
    }
}
