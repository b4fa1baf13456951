//! What an inner step moves, and what it may end in.

use super::{Energies, Event, Status, Window};
use crate::integrator::Integrator;
use crate::rover::dynamics::DynamicsError;
use crate::rover::{Rover, State};
use crate::scalar::{LaneAccess, Mask, Scalar, lanes};
use crate::signals::Command;
use crate::snapshot::Moving;
use num_traits::Signed;

/// Pitch beyond which the rover counts as tipped over, rad.
pub(crate) const TIPPED: f64 = 80.0 * std::f64::consts::PI / 180.0;
/// What a step ended in.
pub(crate) struct Outcome<M> {
    tipped: M,
    sunk: M,
    belly: M,
    stuck: M,
}

impl<M: Mask> Outcome<M> {
    /// Where the run has ended.
    #[lanes]
    pub fn ended(&self) -> M {
        self.tipped | self.sunk | self.belly | self.stuck
    }

    /// The status of number `k` of those side by side.
    pub fn status(&self, k: usize) -> Status {
        if self.tipped.lane(k) {
            Status::Ended(Event::TippedOver)
        } else if self.sunk.lane(k) {
            Status::Ended(Event::SunkToAxle)
        } else if self.belly.lane(k) {
            Status::Ended(Event::BellyContact)
        } else if self.stuck.lane(k) {
            Status::Ended(Event::Stuck)
        } else {
            Status::Running
        }
    }
}

/// What an inner step changes, of one rover or of several in SIMD lanes.
#[derive(Clone, Debug, Moving, LaneAccess)]
pub(crate) struct StepState<S: Scalar = f64> {
    pub state: State<S>,
    pub integrator: Integrator<S>,
    pub energies: Energies<S>,
    pub window: Window<S::Plain>,
}

impl<S: Scalar> StepState<S> {
    /// A rover in `state` under `command`.
    pub fn new<C: Copy + Into<S>>(
        rover: &Rover<S>,
        mut state: State<S>,
        command: &Command<C>,
    ) -> Result<Self, DynamicsError> {
        let mut integrator = Integrator::new(rover, &state);
        integrator.evaluate(rover, &mut state, command)?;
        let window = Window::at(state.position[0].plain());
        Ok(Self { state, integrator, energies: Energies::zero(), window })
    }

    /// Takes a new command over where the mask says so; where it imposes other speeds, the impulse counts as work of the
    /// drives. Elsewhere the command must be the same as before.
    ///
    /// # Errors
    /// [`DynamicsError`] of any; nothing has changed then.
    #[lanes(entry)]
    pub fn change_command<C: Copy + Into<S>>(
        &mut self,
        rover: &Rover<S>,
        command: &Command<C>,
        mask: S::Mask,
    ) -> Result<(), DynamicsError> {
        S::wide(|| {
            let Self { state, integrator, energies, .. } = self;
            let before = integrator.now.mechanical_energy(rover, state);
            integrator.change(rover, state, command, mask)?;
            let after = integrator.now.mechanical_energy(rover, state);
            energies.drive = S::select(mask, energies.drive + (after - before), energies.drive);
            Ok(())
        })
    }

    /// One inner step.
    ///
    /// # Errors
    /// [`DynamicsError`] of any; nothing has moved then.
    #[lanes(entry)]
    pub fn step<C: Copy + Into<S>>(
        &mut self,
        rover: &Rover<S>,
        command: &Command<C>,
        step_size: f64,
    ) -> Result<(), DynamicsError> {
        S::wide(|| {
            let before = self.integrator.now.powers();
            self.integrator.step(rover, &mut self.state, command, step_size)?;
            self.integrator.warm(rover, &mut self.state, step_size);
            let after = self.integrator.now.powers();
            self.energies.add(&before, &after, step_size);
            Ok(())
        })
    }

    /// What the step just made has ended in.
    #[lanes(entry)]
    pub fn outcome(&mut self, rover: &Rover<S>, step_size: f64) -> Outcome<S::Mask> {
        S::wide(|| {
            let radius = rover.true_wheel().radius.plain();
            let wheels = &self.integrator.now.wheels;
            let none = S::Mask::from_lanes(|_| false);
            let mut sunk = none;
            for wheel in wheels {
                sunk = sunk | radius.at_most(wheel.sinkage.plain());
            }
            let speeds = wheels.iter().map(|wheel| wheel.speed.plain());
            Outcome {
                tipped: self.state.position[2].plain().abs().over(TIPPED),
                sunk,
                belly: belly_clearance(rover, &self.state).under(0.0),
                stuck: self.window.stuck(self.state.position[0].plain(), speeds, radius, step_size),
            }
        })
    }
}

/// Least height of the belly, a straight line between the outer wheels of the chassis, above the ground, m.
#[lanes]
pub(crate) fn belly_clearance<S: Scalar>(rover: &Rover<S>, state: &State<S>) -> S::Plain {
    const POINTS: usize = 7;
    let mounts = &rover.wheels;
    let (rear, front) = (mounts[0].mount.x.plain(), mounts[mounts.len() - 1].mount.x.plain());
    let (sin, cos) = state.position[2].plain().sine_cosine();
    let belly = rover.body.belly_z.plain();
    let mut least = S::Plain::from(f64::INFINITY);
    for i in 1..=POINTS {
        let along = rear + (front - rear) * i as f64 / (POINTS + 1) as f64;
        let x = state.position[0].plain() + cos * along - sin * belly;
        let z = state.position[1].plain() + sin * along + cos * belly;
        least = least.smaller(z - rover.terrain.at(S::from_plain(x)).height.plain());
    }
    least
}
