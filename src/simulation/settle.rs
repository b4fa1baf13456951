//! A rover at rest on the soil.

use crate::contact::Hold;
use crate::effects::Track;
use crate::integrator::Integrator;
use crate::linear::{Factors, Vector, add_outer, add_scaled, zeros};
use crate::rover::dynamics::{DynamicsError, Evaluation};
use crate::rover::{Rover, State};
use crate::scalar::{Dual, Scalar};
use crate::signals::Command;
use crate::vehicle::MAX_COORDINATES;

/// Accelerations below which a rover is at rest, m/s^2 and rad/s^2: a force balance within 1e-9 of weight.
const AT_REST: f64 = 1e-8;
/// Newton iterations before the fall-back, which settles in a second or two of simulated time.
const ITERATIONS: usize = 40;
/// Gauss-Newton iterations that put all wheels on the ground: a guess for Newton's method need not be exact.
const STANDING_ITERATIONS: usize = 8;
/// Largest step of one of them, m and rad.
const STANDING_STEP: f64 = 0.2;
/// Weight of the way that they take, beside metres of sinkage: it counts only where the sinkages leave a joint open.
const STANDING_DAMPING: f64 = 1e-9;
/// Steepest pitch of a rover that stands on its wheels, rad.
const MOST_PITCH: f64 = 1.3;
/// Steps that carry derivatives to a rest found in plain numbers: the first meets them to 1e-7 or better (the rest that
/// Newton's method leaves, against the slope of the balance), the second to rounding.
const DERIVATIVE_STEPS: usize = 2;
/// Friction grows in proportion to the holding, to either side; its slope at zero is taken here.
const BESIDE_ZERO: f64 = 1e-9;
const SETTLING_STEPS: usize = 2000;
const SETTLING_STEP: f64 = 0.001;

/// Why a rover cannot be put on the ground.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SettleError {
    /// A wheel is beyond the known ground, or the rover's data are not finite.
    #[error("cannot settle the rover at x = {x} m: {source}")]
    Dynamics {
        /// Where the reference point was to stand.
        x: f64,
        /// Why.
        source: DynamicsError,
    },
    /// No equilibrium was found: the rover tips over or sinks to its axles.
    #[error(
        "cannot settle the rover at x = {x} m: no equilibrium found (left-over acceleration {acceleration:.3e} m/s2); \
         expected a rover whose centre of mass lies between its wheels and a soil that carries it"
    )]
    NoEquilibrium {
        /// Where the reference point was to stand.
        x: f64,
        /// Largest acceleration left, m/s^2.
        acceleration: f64,
    },
}

impl<S: Scalar> Rover<S> {
    /// The state at rest with the reference point above `x`, settled on the soil.
    ///
    /// A slope is held by static friction under locked wheels. Where that does not suffice it is at its
    /// limit and the rover will slide.
    ///
    /// Real parts are found in plain numbers. Derivatives follow from the balance a(u, p) = 0 by the implicit function
    /// theorem, du/dp = -(da/du)^-1 da/dp.
    ///
    /// # Errors
    /// [`SettleError`].
    pub fn settled_at(&self, x: S) -> Result<State<S>, SettleError> {
        let plain = self.map(&|s| s.value());
        let state = plain.settled(x.value())?;
        if S::NDERIV == 0 {
            return Ok(state.map(&S::from));
        }
        carry_derivatives(self, &plain, &state, x).map_err(|source| SettleError::Dynamics { x: x.value(), source })
    }
}

impl Rover<f64> {
    fn settled(&self, x: f64) -> Result<State, SettleError> {
        let fail = |source| SettleError::Dynamics { x, source };
        let mut balance = Balance::new(self);
        let left = match balance.rest(self, self.placed_at(x).map_err(fail)?).map_err(fail)? {
            Ok(state) => return Ok(state),
            Err(left) => left,
        };
        let relaxed = self.relaxed(x).map_err(fail)?;
        balance
            .newton(self, relaxed)
            .map_err(fail)?
            .map_err(|again| SettleError::NoEquilibrium { x, acceleration: left.min(again) })
    }

    /// Places of the wheels' feet along x, m, of a rover at rest above `x`; where it has no rest there, of one that is only put on the ground.
    ///
    /// # Errors
    /// [`DynamicsError`] where the ground is not known there.
    pub(crate) fn feet_at(&self, x: f64) -> Result<Vec<f64>, DynamicsError> {
        let state = match self.settled(x) {
            Ok(state) => state,
            Err(_) => self.placed_at(x)?,
        };
        let mut evaluation = Evaluation::new(self);
        evaluation.update(self, &state, &Command::speed(vec![0.0; self.wheels.len()]))?;
        Ok(evaluation.wheels.iter().map(|wheel| wheel.foot_x).collect())
    }

    /// A first guess: the pitch that the ground has under the outer wheels, sunk by Bekker's estimate (4.18).
    pub(super) fn placed_at(&self, x: f64) -> Result<State, DynamicsError> {
        let height = |k: usize| {
            let at = x + self.wheels[k].mount.x;
            self.terrain.foot([at, self.terrain.at(at).height + self.wheel.radius]).map(|foot| foot.position)
        };
        let ground = |k| height(k).map_err(|source| DynamicsError::Terrain { wheel: k + 1, source });
        let last = self.wheels.len() - 1;
        let (rear, front) = (ground(0)?, ground(last)?);
        let pitch = (front[1] - rear[1]).atan2((front[0] - rear[0]).abs().max(1e-3));
        let sinkage = self.expected_sinkage();
        let mount_z = self.wheels.iter().map(|w| w.mount.z).sum::<f64>() / self.wheels.len() as f64;
        let z = 0.5 * (front[1] + rear[1]) + (self.wheel.radius - sinkage) / pitch.cos() - mount_z * pitch.cos();
        let mut state = State::at_rest(self, x, z);
        state.position[2] = pitch;
        Ok(state)
    }

    /// Bekker's estimate (4.18) of how deep its wheels stand, at most half a radius, m.
    fn expected_sinkage(&self) -> f64 {
        let load = self.total_mass() * self.environment.gravity / self.wheels.len() as f64;
        let (soil, width) = (&self.soil, self.wheel.width);
        let stiffness = (3.0 - soil.exponent) * width * soil.modulus(width) * (2.0 * self.wheel.radius).sqrt();
        (3.0 * load / stiffness).powf(2.0 / (2.0 * soil.exponent + 1.0)).min(0.5 * self.wheel.radius)
    }

    /// Lets the rover come to rest by simulating it with locked wheels, held at `x`.
    fn relaxed(&self, x: f64) -> Result<State, DynamicsError> {
        let mut state = self.placed_at(x)?;
        state.position[1] += 0.2 * self.wheel.radius;
        let command = Command::speed(vec![0.0; self.wheels.len()]);
        let mut integrator = Integrator::new(self, &state);
        integrator.evaluate(self, &mut state, &command)?;
        for _ in 0..SETTLING_STEPS {
            integrator.step(self, &mut state, &command, SETTLING_STEP)?;
            state.position[0] = x;
            state.rate[0] = 0.0;
            state.wheels.iter_mut().for_each(|wheel| (wheel.hold, wheel.dug_slip) = (Hold::default(), 0.0));
            integrator.evaluate(self, &mut state, &command)?;
        }
        state.rate.iter_mut().for_each(|rate| *rate = 0.0);
        state.wheels.iter_mut().for_each(|wheel| wheel.track = Track::default());
        Ok(state)
    }
}

/// Static balance: the accelerations as functions of (holding, z, pitch, joints).
struct Balance<S = f64> {
    evaluation: Evaluation<S>,
    command: Command,
}

impl<S: Scalar> Balance<S> {
    fn new(rover: &Rover<S>) -> Self {
        Self { evaluation: Evaluation::new(rover), command: Command::speed(vec![0.0; rover.wheels.len()]) }
    }

    /// Sets the holding of all wheels: uphill (positive) as if they had been dragged downhill, locked.
    fn hold(state: &mut State<S>, holding: S) {
        let within = holding.larger(S::from(-1.0)).smaller(S::from(1.0));
        let hold = Hold { travel: -within, turn: S::from(0.0) };
        state.wheels.iter_mut().for_each(|wheel| wheel.hold = hold);
    }

    fn accelerations(
        &mut self,
        rover: &Rover<S>,
        state: &mut State<S>,
        unknowns: &Vector<S>,
    ) -> Result<Vector<S>, DynamicsError> {
        Self::hold(state, unknowns[0]);
        state.position[1..].copy_from_slice(&unknowns[1..rover.coordinates()]);
        self.evaluation.update(rover, state, &self.command)?;
        Ok(self.evaluation.acceleration)
    }
}

impl Balance {
    /// Newton's method from a guess, and where it fails from there with all wheels on the ground; the inner error as for
    /// [`Self::newton`].
    fn rest(&mut self, rover: &Rover, guess: State) -> Result<Result<State, f64>, DynamicsError> {
        let mut standing = guess.clone();
        let found = self.newton(rover, guess)?;
        // On rough ground the guess leaves wheels in the air, where the balance does not change with their joints.
        if found.is_err()
            && self.stand(rover, &mut standing).is_ok()
            && let Ok(Ok(state)) = self.newton(rover, standing)
        {
            return Ok(Ok(state));
        }
        Ok(found)
    }

    /// Moves chassis and joints until all wheels are sunk as deep as expected, as nearly as the joints allow.
    fn stand(&mut self, rover: &Rover, state: &mut State) -> Result<(), DynamicsError> {
        let (n, expected) = (rover.coordinates(), rover.expected_sinkage());
        for _ in 0..STANDING_ITERATIONS {
            self.evaluation.update(rover, state, &self.command)?;
            let (mut matrix, mut right) = ([zeros(); MAX_COORDINATES], zeros());
            for wheel in &self.evaluation.wheels {
                let mut normal = zeros();
                normal[..n - 1].copy_from_slice(&wheel.normal[1..n]);
                add_outer(&mut matrix, 1.0, &normal, &normal, n - 1);
                add_scaled(&mut right, wheel.sinkage - expected, &normal, n - 1);
            }
            (0..n - 1).for_each(|i| matrix[i][i] += STANDING_DAMPING);
            let Some(factors) = Factors::new(&matrix, n - 1) else { break };
            let change = factors.solve(&right);
            let largest = change[..n - 1].iter().fold(STANDING_STEP, |most, step| most.max(step.abs()));
            (1..n).for_each(|i| state.position[i] += change[i - 1] * (STANDING_STEP / largest));
        }
        Ok(())
    }

    /// Newton's method from `state`; the inner error is the acceleration left where it did not converge.
    fn newton(&mut self, rover: &Rover, mut state: State) -> Result<Result<State, f64>, DynamicsError> {
        let n = rover.coordinates();
        let mut unknowns = zeros();
        unknowns[1..n].copy_from_slice(&state.position[1..]);
        let mut left = self.accelerations(rover, &mut state, &unknowns)?;
        let size = |a: &Vector<f64>| a[..n].iter().fold(0.0_f64, |m, v| m.max(v.abs()));
        for _ in 0..ITERATIONS {
            if size(&left) < AT_REST {
                // An equilibrium on the nose or tail is none of a rover on its wheels.
                let upright = state.position[2].abs() < MOST_PITCH;
                return Ok(if upright { Ok(state) } else { Err(f64::INFINITY) });
            }
            let mut jacobian = [zeros(); MAX_COORDINATES];
            for j in 0..n {
                let mut moved = unknowns;
                let step = 1e-7;
                moved[j] += step;
                let there = self.accelerations(rover, &mut state, &moved)?;
                (0..n).for_each(|i| jacobian[i][j] = (there[i] - left[i]) / step);
            }
            let Some(factors) = Factors::new(&jacobian, n) else { break };
            let change = factors.solve(&left);
            // At most a fifth of a radius or radian, or half the range of the holding, at a time.
            let scale = (1..n).map(|i| change[i].abs() / 0.02).fold(change[0].abs() / 0.5, f64::max).max(1.0);
            (0..n).for_each(|i| unknowns[i] -= change[i] / scale);
            left = self.accelerations(rover, &mut state, &unknowns)?;
        }
        // Beyond what friction can hold nothing changes with the holding: at rest in all but x, it will slide.
        let slides = unknowns[0].abs() >= 1.0 && left[1..n].iter().all(|a| a.abs() < 1.0);
        Ok(if slides || size(&left) < AT_REST { Ok(state) } else { Err(size(&left)) })
    }
}

/// A rest found in plain numbers, with the derivatives that follow from the parameters and from `x`.
fn carry_derivatives<S: Scalar>(
    rover: &Rover<S>,
    plain: &Rover,
    rest: &State,
    x: S,
) -> Result<State<S>, DynamicsError> {
    let n = rover.coordinates();
    let mut values = zeros();
    values[0] = -rest.wheels.first().map_or(0.0, |wheel| wheel.hold.travel);
    values[1..n].copy_from_slice(&rest.position[1..]);
    // At the limit of friction the holding stays there, and the balance along x is not met.
    let first = usize::from(values[0].abs() >= 1.0);
    let jacobian = exact_jacobian(plain, rest, &values)?;
    let mut inner = [zeros(); MAX_COORDINATES];
    for i in first..n {
        (first..n).for_each(|j| inner[i - first][j - first] = jacobian[i][j]);
    }
    let factors = Factors::new(&inner, n - first).ok_or(DynamicsError::NotFinite)?;
    let mut balance = Balance::new(rover);
    let mut state = rest.map(&S::from);
    (state.position[0], state.start_x) = (x, x);
    let mut unknowns = values.map(S::from);
    // The forces have no slope exactly at zero holding, so a second step would count the first again.
    let steps = if values[0] == 0.0 { 1 } else { DERIVATIVE_STEPS };
    for _ in 0..steps {
        let left = balance.accelerations(rover, &mut state, &unknowns)?;
        let mut right = zeros();
        right[..n - first].copy_from_slice(&left[first..n]);
        let change = factors.solve(&right);
        for i in first..n {
            // The real part is settled; what it would still move is rounding.
            let change = change[i - first];
            unknowns[i] -= change - change.value();
        }
    }
    Balance::hold(&mut state, unknowns[0]);
    state.position[1..].copy_from_slice(&unknowns[1..n]);
    Ok(state)
}

/// Slopes of the accelerations at rest in (holding, z, pitch, joints).
fn exact_jacobian(
    rover: &Rover,
    rest: &State,
    unknowns: &Vector<f64>,
) -> Result<[Vector<f64>; MAX_COORDINATES], DynamicsError> {
    let n = rover.coordinates();
    let lifted = rover.map(&Dual::<1>::from);
    let (mut balance, mut state) = (Balance::new(&lifted), rest.map(&Dual::<1>::from));
    let mut jacobian = [zeros(); MAX_COORDINATES];
    for j in 0..n {
        let mut seeded = unknowns.map(Dual::<1>::from);
        if j == 0 && unknowns[0] == 0.0 {
            seeded[0] = Dual::from(BESIDE_ZERO);
        }
        seeded[j] = seeded[j].derivative(0);
        let slopes = balance.accelerations(&lifted, &mut state, &seeded)?;
        (0..n).for_each(|i| jacobian[i][j] = slopes[i].eps.0.map_or(0.0, |eps| eps[0]));
    }
    Ok(jacobian)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::Model;
    use crate::terrain::{Profile, Random, Spectrum, Terrain};

    /// Two rests of the same balance, m and rad: both leave [`AT_REST`] of acceleration at most.
    const SAME: f64 = 1e-7;

    /// Locked wheels of a rover that is dropped slide over the ground; that is no way on which slip digs.
    #[test]
    fn property_a_rover_that_is_dropped_comes_to_rest_on_ground_that_is_not_dug() {
        let mut rover = Model::preset("rocker_bogie_velocity").expect("a preset").rover;
        (rover.effects.slip_sinkage.n1, rover.effects.slip_sinkage.length) = (0.4, 0.05);
        rover.terrain =
            Terrain::new(Profile::Random(Random::new(Spectrum { roughness: 0.04, wavelength: 4.0, exponent: 3.0 }, 1)));
        let dropped = rover.relaxed(0.0).expect("known ground");
        assert!(dropped.wheels.iter().all(|wheel| wheel.dug_slip == 0.0), "{dropped:?}");
    }

    /// Rough ground leaves a wheel of the first guess in the air; to drop the rover takes some hundred times as long, and is
    /// to be the exception. It ends in the same rest.
    #[test]
    fn property_a_rocker_bogie_settles_on_rough_ground_without_being_dropped() {
        const GROUNDS: u32 = 200;
        let spectrum = Spectrum { roughness: 0.04, wavelength: 4.0, exponent: 3.0 };
        let (mut at_once, mut stood, mut compared) = (0, 0, 0);
        for seed in 0..GROUNDS {
            let mut rover = Model::preset("rocker_bogie_velocity").expect("a preset").rover;
            rover.terrain = Terrain::new(Profile::Random(Random::new(spectrum, seed)));
            let mut balance = Balance::new(&rover);
            let guess = rover.placed_at(0.0).expect("known ground");
            let first = balance.newton(&rover, guess.clone()).expect("finite").is_ok();
            let rest = balance.rest(&rover, guess).expect("finite");
            at_once += u32::from(first);
            stood += u32::from(rest.is_ok());
            if let Ok(rest) = rest
                && !first
                && compared < 5
            {
                compared += 1;
                let dropped = balance.newton(&rover, rover.relaxed(0.0).expect("known ground")).expect("finite");
                let dropped = dropped.expect("a dropped rover comes to rest");
                for (a, b) in rest.position.iter().zip(&dropped.position) {
                    assert!((a - b).abs() < SAME, "ground {seed}: {:?}, dropped {:?}", rest.position, dropped.position);
                }
            }
        }
        assert!(stood > GROUNDS * 98 / 100, "{stood} of {GROUNDS}");
        // Else the grounds are not rough enough to need it.
        assert!(at_once < GROUNDS * 3 / 4 && compared == 5, "{at_once} of {GROUNDS} from the first guess");
    }
}
