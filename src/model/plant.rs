//! Which plant moves a model's rover.

use super::{Model, RunError};
#[cfg(feature = "rigid")]
use crate::rigid::RigidBodies;
use crate::rover::{Rover, State};
use crate::signals::{Command, Drive, Signals};
use crate::simulation::{Simulation, Status, StepError};

/// What moves the rover: `simulation.plant`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Plant {
    /// Equations of motion in joint coordinates: soil only, exact derivatives, order 2.
    #[default]
    JointCoordinates,
    /// Rigid bodies and joints of rapier2d: soil, obstacles and a belly that touches the ground, order 1.
    RigidBodies,
}

/// A plant in motion. Cloning it is a snapshot: the clone goes on to the same bits.
#[derive(Clone, Debug)]
pub enum AnyPlant {
    /// In joint coordinates.
    JointCoordinates(Box<Simulation>),
    /// Of rigid bodies.
    #[cfg(feature = "rigid")]
    RigidBodies(Box<RigidBodies>),
}

/// Calls the same method of whichever plant it is.
macro_rules! of_plant {
    ($self:ident, $plant:ident => $call:expr) => {
        match $self {
            AnyPlant::JointCoordinates($plant) => $call,
            #[cfg(feature = "rigid")]
            AnyPlant::RigidBodies($plant) => $call,
        }
    };
}

impl AnyPlant {
    /// The plant of `model` at its start.
    ///
    /// # Errors
    /// [`RunError`] where the rover finds no rest, stands in an obstacle, or the plant is not built in.
    pub(super) fn new(model: &Model) -> Result<Self, RunError> {
        let (rover, x0, step_size) = (model.rover.clone(), model.start.x0, model.stepping.step_size);
        match model.stepping.plant {
            Plant::JointCoordinates => Ok(Self::JointCoordinates(Box::new(Simulation::new(rover, x0, step_size)?))),
            #[cfg(feature = "rigid")]
            Plant::RigidBodies => {
                let friction = model.body_contact.belly_friction;
                let plant = RigidBodies::new(rover, x0, step_size, &model.obstacles, friction)?;
                Ok(Self::RigidBodies(Box::new(plant)))
            }
            #[cfg(not(feature = "rigid"))]
            Plant::RigidBodies => Err(RunError::NoRigidBodies),
        }
    }

    /// Applies `command` and makes `steps` inner steps with it.
    ///
    /// # Errors
    /// [`StepError`]; the state is then that of the last good step.
    pub fn advance(&mut self, command: &Command, steps: u64) -> Result<Status, StepError> {
        of_plant!(self, plant => plant.advance(command, steps))
    }

    /// Takes the command `value(k)` of each wheel k over, which must be finite; it holds from now on.
    pub(super) fn hold(&mut self, drive: Drive, value: &dyn Fn(usize) -> f64) -> Result<(), StepError> {
        of_plant!(self, plant => plant.hold(drive, value))
    }

    /// Makes `steps` inner steps with the command that holds.
    pub(super) fn go_on(&mut self, steps: u64) -> Result<Status, StepError> {
        of_plant!(self, plant => plant.go_on(steps))
    }

    /// Signals at the present time: the true ones, but for the errors of sensors among the rover's effects.
    #[must_use]
    pub fn signals(&self) -> &Signals {
        of_plant!(self, plant => plant.signals())
    }

    /// Time since the start, s.
    #[must_use]
    pub fn time(&self) -> f64 {
        of_plant!(self, plant => plant.time())
    }

    /// Inner steps since the start.
    #[must_use]
    pub fn ticks(&self) -> u64 {
        of_plant!(self, plant => plant.ticks())
    }

    /// Inner step, s.
    #[must_use]
    pub fn step_size(&self) -> f64 {
        of_plant!(self, plant => plant.step_size())
    }

    /// Whether the run goes on.
    #[must_use]
    pub fn status(&self) -> Status {
        of_plant!(self, plant => plant.status())
    }

    /// The rover.
    #[must_use]
    pub fn rover(&self) -> &Rover {
        of_plant!(self, plant => plant.rover())
    }

    /// The moving data in joint coordinates.
    #[must_use]
    pub fn state(&self) -> &State {
        of_plant!(self, plant => plant.state())
    }

    /// Whether the last command was torques or speeds.
    #[must_use]
    pub fn drive(&self) -> Drive {
        of_plant!(self, plant => plant.drive())
    }
}

impl Model {
    /// Refuses what only the plant of rigid bodies can do, where the model has another one.
    pub(super) fn check_plant(&self) -> Result<(), RunError> {
        if self.stepping.plant == Plant::JointCoordinates && !self.obstacles.is_empty() {
            return Err(RunError::ObstaclesWithoutBodies { obstacles: self.obstacles.len() });
        }
        Ok(())
    }

    /// Refuses the plant of rigid bodies, for what needs joint coordinates (`purpose`).
    pub(crate) fn in_joint_coordinates(&self, purpose: &'static str) -> Result<(), RunError> {
        match self.stepping.plant {
            Plant::JointCoordinates => Ok(()),
            Plant::RigidBodies => Err(RunError::NeedsJointCoordinates { purpose }),
        }
    }
}
