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

use crate::contact::Forces;
use crate::rover::dynamics::{DynamicsError, Evaluation, WheelEvaluation};
use crate::rover::linear::{Factors, Matrix, Vector, add_outer, add_scaled, dot, zeros};
use crate::rover::{Rover, State};
use crate::scalar::{Scalar, always};
use crate::signals::{Command, Drive};
use crate::snapshot::moving_beside;

/// gamma = 1 - 1/sqrt 2.
pub(crate) const GAMMA: f64 = 1.0 - std::f64::consts::FRAC_1_SQRT_2;

/// Share of a joint's dry friction over its rate that A holds. The slope of dry friction says nothing of its reversal,
/// and with friction over rate itself the first stage overshoots to 1 - 1/gamma of a rate that a step would stop, where
/// friction does not grow along: the joint would chatter. Twice 1/gamma of it ends that stage at half the rate, and
/// the step between 0 and an eighth of it.
pub(crate) const DRY_FRICTION: f64 = 2.0 / GAMMA;

/// Rate or increment of a whole state; a wheel's entries are its spin, `hold.travel` and `hold.turn`.
#[derive(Clone, Debug)]
pub(crate) struct Increment<S> {
    pub position: Vector<S>,
    pub rate: Vector<S>,
    pub wheels: Vec<[S; 3]>,
}

/// What elimination of one wheel's spin and memory leaves. The spin's increment is
/// `spin + spin_by_velocity * tangent.k + spin_by_turn * turn.k`, with `spin` from the right-hand side.
#[derive(Clone, Copy, Debug)]
struct Condensed<S> {
    /// Slopes of the forces in the spin, with the memory eliminated.
    by_spin: Forces<S>,
    /// Slopes of the forces in the tangential velocity and in the body's turn, with the spin eliminated too.
    by_velocity: Forces<S>,
    by_turn: Forces<S>,
    /// The same of the drive's reaction on the body, and its slope in `spin`.
    reaction_by_velocity: S,
    reaction_by_turn: S,
    reaction_by_spin: S,
    /// 1/(1 - gamma h slope) of the memory.
    hold_factor: S,
    /// 1/(I - gamma h slope) of the spin.
    spin_factor: S,
    spin_by_velocity: S,
    spin_by_turn: S,
}

/// Memory of the integrator: evaluations and increments, allocated once.
#[derive(Clone, Debug)]
pub(crate) struct Integrator<S = f64> {
    /// Right-hand side at the present state.
    pub now: Evaluation<S>,
    /// The same at the second stage, once a step's [`Integrator::stages`] are made.
    pub ahead: Evaluation<S>,
    predicted: State<S>,
    /// Solutions k1 and k2 of the stages.
    pub first: Increment<S>,
    pub second: Increment<S>,
    condensed: Vec<Condensed<S>>,
}

moving_beside!(Integrator { now } { ahead, predicted, first, second, condensed });

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

    /// One step of size `h`; `now` must hold the evaluation at `state` and does so again afterwards.
    ///
    /// # Errors
    /// [`DynamicsError`]; `state` is then left as it was before the step.
    #[cfg_attr(feature = "batch", inline(always))]
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
    pub fn stages<C: Copy + Into<S>>(
        &mut self,
        rover: &Rover<S>,
        state: &State<S>,
        command: &Command<C>,
        h: f64,
    ) -> Result<(), DynamicsError> {
        S::wide(
            #[cfg_attr(feature = "batch", inline(always))]
            || {
                let gh = GAMMA * h;
                let factors = self.condense(rover, command.drive, gh)?;
                self.first.set(rover, state, &self.now);
                self.first.solve(rover, &self.now, &self.condensed, &factors, command.drive, gh);
                self.predicted.copy_from(state);
                self.first.add_to(&mut self.predicted, h);
                self.ahead.update(rover, &self.predicted, command)?;
                self.second.set(rover, &self.predicted, &self.ahead);
                self.second.add_scaled(&self.first, -2.0, rover.coordinates());
                self.second.solve(rover, &self.now, &self.condensed, &factors, command.drive, gh);
                Ok(())
            },
        )
    }

    /// Warms the windings over the step of size `h` just made, where they warm.
    #[cfg_attr(feature = "batch", inline(always))]
    pub fn warm(&mut self, rover: &Rover<S>, state: &mut State<S>, h: f64) {
        if rover.effects.winding_heat.acts() {
            // The evaluation at the start of the step is what was swapped out.
            self.now.warm(rover, &self.ahead, state, h);
        }
    }

    /// Eliminates spins and memories and factors the matrix that is left.
    #[cfg_attr(feature = "batch", inline(always))]
    fn condense(&mut self, rover: &Rover<S>, drive: Drive, gh: f64) -> Result<Factors<S>, DynamicsError> {
        let n = rover.coordinates();
        let mut matrix = self.now.system;
        for (wheel, condensed) in self.now.wheels.iter().zip(&mut self.condensed) {
            *condensed = Condensed::new(rover, wheel, drive, gh);
            add_contact(&mut matrix, wheel, condensed, gh, n);
        }
        for (j, link) in rover.links.iter().enumerate() {
            matrix[3 + j][3 + j] += (link.parameters.damping + self.now.joint_friction[j] * DRY_FRICTION) * gh;
        }
        Factors::new(&matrix, n).ok_or(DynamicsError::NotFinite)
    }
}

/// Adds `- gamma h` times the slopes of one wheel's contact and drive to the condensed matrix.
#[cfg_attr(feature = "batch", inline(always))]
fn add_contact<S: Scalar>(
    matrix: &mut Matrix<S>,
    wheel: &WheelEvaluation<S>,
    condensed: &Condensed<S>,
    gh: f64,
    n: usize,
) {
    let slopes = &wheel.touch.slopes;
    let (by_velocity, by_turn) = (&condensed.by_velocity, &condensed.by_turn);
    let along_normal = (slopes.stiffness * gh - slopes.damping) * gh;
    add_outer(matrix, along_normal, &wheel.normal, &wheel.normal, n);
    add_outer(matrix, by_velocity.normal * -gh, &wheel.normal, &wheel.tangent, n);
    add_outer(matrix, by_velocity.drawbar * -gh, &wheel.tangent, &wheel.tangent, n);
    add_outer(matrix, by_turn.normal * -gh, &wheel.normal, &wheel.turn, n);
    add_outer(matrix, by_turn.drawbar * -gh, &wheel.tangent, &wheel.turn, n);
    add_outer(matrix, condensed.reaction_by_velocity * -gh, &wheel.turn, &wheel.tangent, n);
    add_outer(matrix, condensed.reaction_by_turn * -gh, &wheel.turn, &wheel.turn, n);
}

impl<S: Scalar> Condensed<S> {
    fn zero() -> Self {
        let (zero, none) = (S::from(0.0), Forces::zero());
        Self {
            by_spin: none,
            by_velocity: none,
            by_turn: none,
            reaction_by_velocity: zero,
            reaction_by_turn: zero,
            reaction_by_spin: zero,
            hold_factor: zero,
            spin_factor: zero,
            spin_by_velocity: zero,
            spin_by_turn: zero,
        }
    }

    #[cfg_attr(feature = "batch", inline(always))]
    fn new(rover: &Rover<S>, wheel: &WheelEvaluation<S>, drive: Drive, gh: f64) -> Self {
        let slopes = &wheel.touch.slopes;
        let hold_factor = (S::from(1.0) - slopes.rate_own * gh).recip();
        let through_hold = always(
            #[cfg_attr(feature = "batch", inline(always))]
            |[travel, turn]: [S; 2]| {
                slopes.travel.scaled(travel * hold_factor * gh).plus(slopes.turn.scaled(turn * hold_factor * gh))
            },
        );
        let by_velocity = slopes.velocity.plus(through_hold(slopes.rate_by_velocity));
        let by_spin = slopes.spin.plus(through_hold(slopes.rate_by_spin));
        let spin_factor = (rover.wheel.inertia + (by_spin.torque - wheel.drive_slope) * gh).recip();
        let (spin_by_velocity, spin_by_turn) = match drive {
            // I dw = ... - gamma h dT + gamma h slope (dw + a.du): the drive's slope is in the relative speed.
            Drive::Torque => (-(by_velocity.torque * spin_factor * gh), wheel.drive_slope * spin_factor * gh),
            // The spin follows the body: its increment is minus the body's turn.
            Drive::Speed => (S::from(0.0), S::from(-1.0)),
        };
        let total = by_velocity.plus(by_spin.scaled(spin_by_velocity));
        let by_turn = by_spin.scaled(spin_by_turn);
        let (reaction_by_velocity, reaction_by_turn, reaction_by_spin) = match drive {
            Drive::Torque => {
                (wheel.drive_slope * spin_by_velocity, wheel.drive_slope * (spin_by_turn + 1.0), wheel.drive_slope)
            }
            Drive::Speed => (total.torque, by_turn.torque, S::from(0.0)),
        };
        Self {
            by_spin,
            by_velocity: total,
            by_turn,
            reaction_by_velocity,
            reaction_by_turn,
            reaction_by_spin,
            hold_factor,
            spin_factor,
            spin_by_velocity,
            spin_by_turn,
        }
    }
}

impl<S: Scalar> Increment<S> {
    /// The time derivative of `state`, as evaluated.
    #[cfg_attr(feature = "batch", inline(always))]
    fn set(&mut self, rover: &Rover<S>, state: &State<S>, evaluation: &Evaluation<S>) {
        self.position[..state.rate.len()].copy_from_slice(&state.rate);
        self.rate = evaluation.acceleration;
        for (k, (entry, wheel)) in self.wheels.iter_mut().zip(&evaluation.wheels).enumerate() {
            *entry = [evaluation.spin_rate(rover, k), wheel.touch.rate.travel, wheel.touch.rate.turn];
        }
    }

    #[cfg_attr(feature = "batch", inline(always))]
    fn add_scaled(&mut self, other: &Self, factor: f64, n: usize) {
        let factor = S::from(factor);
        add_scaled(&mut self.position, factor, &other.position, n);
        add_scaled(&mut self.rate, factor, &other.rate, n);
        for (entry, other) in self.wheels.iter_mut().zip(&other.wheels) {
            for (a, b) in entry.iter_mut().zip(other) {
                *a += *b * factor;
            }
        }
    }

    #[cfg_attr(feature = "batch", inline(always))]
    pub fn add_to(&self, state: &mut State<S>, factor: f64) {
        for (i, (position, rate)) in state.position.iter_mut().zip(&mut state.rate).enumerate() {
            *position += self.position[i] * factor;
            *rate += self.rate[i] * factor;
        }
        for (wheel, [spin, travel, turn]) in state.wheels.iter_mut().zip(&self.wheels) {
            wheel.spin += *spin * factor;
            wheel.hold.travel += *travel * factor;
            wheel.hold.turn += *turn * factor;
        }
    }

    /// Replaces this right-hand side r by the solution k of (I - gamma h A) k = r.
    #[cfg_attr(feature = "batch", inline(always))]
    fn solve(
        &mut self,
        rover: &Rover<S>,
        now: &Evaluation<S>,
        condensed: &[Condensed<S>],
        factors: &Factors<S>,
        drive: Drive,
        gh: f64,
    ) {
        let n = rover.coordinates();
        let inertia = rover.wheel.inertia;
        let mut right = zeros();
        for (i, row) in now.system.iter().enumerate().take(n) {
            right[i] = dot(row, &self.rate, n);
        }
        for ((wheel, c), entry) in now.wheels.iter().zip(condensed).zip(&mut self.wheels) {
            let slopes = &wheel.touch.slopes;
            let (travel, turn) = (c.hold_factor * entry[1], c.hold_factor * entry[2]);
            let mut constant = slopes.travel.scaled(travel).plus(slopes.turn.scaled(turn));
            let mut reaction = constant.torque;
            if drive == Drive::Torque {
                // The part of the spin's increment that does not depend on the body's motion.
                entry[0] = (inertia * entry[0] - constant.torque * gh) * c.spin_factor;
                constant = constant.plus(c.by_spin.scaled(entry[0]));
                reaction = c.reaction_by_spin * entry[0];
            } else {
                entry[0] = S::from(0.0);
            }
            let sunk = dot(&wheel.normal, &self.position, n);
            add_scaled(&mut right, (constant.normal - slopes.stiffness * sunk) * gh, &wheel.normal, n);
            add_scaled(&mut right, constant.drawbar * gh, &wheel.tangent, n);
            add_scaled(&mut right, reaction * gh, &wheel.turn, n);
        }
        self.rate = factors.solve(&right);
        for i in 0..n {
            self.position[i] += self.rate[i] * gh;
        }
        for ((wheel, c), entry) in now.wheels.iter().zip(condensed).zip(&mut self.wheels) {
            let velocity = dot(&wheel.tangent, &self.rate, n);
            entry[0] += c.spin_by_velocity * velocity + c.spin_by_turn * dot(&wheel.turn, &self.rate, n);
            let slopes = &wheel.touch.slopes;
            for i in 0..2 {
                let driven = slopes.rate_by_velocity[i] * velocity + slopes.rate_by_spin[i] * entry[0];
                entry[i + 1] = (entry[i + 1] + driven * gh) * c.hold_factor;
            }
        }
    }
}
