//! Why a run cannot start or go on.

use super::ControlKind;
use crate::control::ControlError;
use crate::simulation::StepError;
use bekker_modeldescription::ParameterError;

/// Why a run cannot start or go on.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum RunError {
    /// A parameter or input is out of range or unknown.
    #[error(transparent)]
    Parameter(#[from] ParameterError),
    /// The simulation failed.
    #[error(transparent)]
    Step(#[from] StepError),
    /// The controller failed.
    #[error("the controller gave no command at t = {time} s: {source}")]
    Control {
        /// Time, s.
        time: f64,
        /// Why.
        source: ControlError,
    },
    /// The control period does not fit the inner step.
    #[error("the control period {period} s is not a whole multiple of the inner step {step_size} s")]
    Period {
        /// Control period, s.
        period: f64,
        /// Inner step, s.
        step_size: f64,
    },
    /// The wheels are not in order.
    #[error("wheel[{wheel}].x = {x} m is not ahead of wheel[{}].x = {before} m; wheels are numbered from rear to front", wheel - 1)]
    WheelOrder {
        /// Wheel, from 1 at the rear.
        wheel: usize,
        /// Its place, m.
        x: f64,
        /// The place of the wheel before it, m.
        before: f64,
    },
    /// The model has obstacles, and its plant computes contact with soil only.
    #[error(
        "the model has {obstacles} obstacles, which the plant in joint coordinates cannot feel; \
         expected simulation.plant = \"rigid_bodies\" or no obstacles"
    )]
    ObstaclesWithoutBodies {
        /// Obstacles of the model.
        obstacles: usize,
    },
    /// A wheel on a carriage.
    #[error(
        "the model `{name}` is a wheel on a carriage, which has steady points and no motion in time; expected a rover"
    )]
    Carriage {
        /// Name of the model.
        name: String,
    },
    /// A test of a soil.
    #[error("the model `{name}` is a test of a soil, which has no motion in time; expected a rover")]
    SoilTest {
        /// Name of the model.
        name: String,
    },
    /// A parameter that a run under way cannot change.
    #[error("`{name}` cannot change while a run is under way; expected a change of soil, effects, sensors or gains")]
    NotTunable {
        /// The parameter.
        name: String,
    },
    /// A controller is asked for by itself, and the model has none that needs measurements only.
    #[error(
        "control.kind = {kind:?} is no controller that needs measurements only; \
         expected velocity, velocity_tuned, rtc, rtc_speed or equal_torque"
    )]
    NoController {
        /// The kind of control.
        kind: ControlKind,
    },
    /// Something that needs the plant in joint coordinates.
    #[error("{purpose} needs the plant in joint coordinates; expected simulation.plant = \"joint_coordinates\"")]
    NeedsJointCoordinates {
        /// What needs it.
        purpose: &'static str,
    },
    /// The plant of rigid bodies is not built in.
    #[error(
        "simulation.plant = \"rigid_bodies\" is not built in here; expected \"joint_coordinates\" or the feature `rigid`"
    )]
    NoRigidBodies,
    /// The wrong number of input values.
    #[error("{got} input values were given, this model has {expected} inputs")]
    InputLength {
        /// Values given.
        got: usize,
        /// Inputs of the model.
        expected: usize,
    },
}
