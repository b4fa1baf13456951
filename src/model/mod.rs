//! A model: everything that a run needs, in one value that TOML, FMU, Python and command line share.

mod ahead;
mod closed_loop;
mod controller;
mod effects;
mod error;
mod estimating;
mod file;
mod find;
mod inputs;
mod obstacles;
mod oracle;
mod ordinary;
mod origin;
mod plant;
mod presets;
mod registering;
mod rig;
mod run;
mod run_error;
mod saving;
mod sections;
mod soil_map;
mod start_checks;
mod stated;
mod summary;
mod tuning;
mod variation;

pub use ahead::{Ahead, AheadError};
pub use closed_loop::{Control, ControlKind, RtcTiming, nominal};
pub use controller::ControllerRun;
pub use error::ModelError;
pub use estimating::{ContactAngleSource, SoilSource};
pub use inputs::Inputs;
pub use plant::{AnyPlant, Plant};
pub use presets::PRESETS;
pub use rig::{ModelKind, UnfitRover};
pub use run::Run;
pub use run_error::RunError;
pub use stated::Stated;
pub use summary::{Summary, SummaryBuilder};
pub use variation::{Distribution, Variation, VariationError};

use crate::control::RegisteredLaw;
use crate::effects::{Facts, Needs};
use crate::obstacle::{BodyContact, Obstacle};
use crate::rover::Rover;
use crate::sensors::Sensors;
use crate::soil_test::TestRig;
use bekker_modeldescription::{Parameters, Unit, Variable, join, parameters};
use std::fmt;

parameters! {
    /// Where a run starts.
    pub struct Start {
        /// Start of the chassis reference point along x.
        x0: [Unit::METRE] = 0.0, -1e4..=1e4, Fixed, "user";
    }
}

/// How a run is stepped.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Stepping {
    /// Inner step, s.
    pub step_size: f64,
    /// Default length of a run, s.
    pub duration: f64,
    /// Seed of the sensors' noise.
    pub seed: u32,
    /// What moves the rover.
    pub plant: Plant,
}

impl Default for Stepping {
    fn default() -> Self {
        Self { step_size: 0.002, duration: 20.0, seed: 0, plant: Plant::default() }
    }
}

/// A rover on its ground, its sensors and control, and how to run them; or a wheel on a carriage or a test of the soil, see
/// [`ModelKind`].
#[derive(Clone)]
pub struct Model {
    /// Name for people.
    pub name: String,
    /// What the model is of.
    pub kind: ModelKind,
    /// Parameters that the model states: those of its file. They hold against an experiment's `[parameters]`.
    pub stated: Stated,
    /// Rover, soil, terrain, effects.
    pub rover: Rover,
    /// Start.
    pub start: Start,
    /// Sensors; read only where a controller uses them.
    pub sensors: Sensors,
    /// Control.
    pub control: Control,
    /// Step, duration, seed, plant.
    pub stepping: Stepping,
    /// Rigid obstacles; for the plant of rigid bodies only.
    pub obstacles: Vec<Obstacle>,
    /// The rig of a soil test, of [`ModelKind::SoilTest`] alone.
    pub test: Option<TestRig>,
    /// Friction of chassis and links on the ground; read by the plant of rigid bodies only.
    pub body_contact: BodyContact,
    /// The control law of another crate, see [`Model::drive_by`].
    pub registered_law: Option<RegisteredLaw>,
}

/// The text of a model without a registered law is the same, and with it its
/// [`Fingerprint`](crate::snapshot::Fingerprint), whether or not one can be registered.
impl fmt::Debug for Model {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { name, kind, stated, rover, start, sensors, control, stepping, obstacles, body_contact, .. } = self;
        let mut text = f.debug_struct("Model");
        text.field("name", name).field("kind", kind).field("stated", stated).field("rover", rover);
        text.field("start", start).field("sensors", sensors).field("control", control).field("stepping", stepping);
        text.field("obstacles", obstacles).field("body_contact", body_contact);
        if let Some(law) = &self.registered_law {
            text.field("registered_law", law);
        }
        if let Some(test) = &self.test {
            text.field("test", test);
        }
        text.finish()
    }
}

impl Model {
    /// A model of `rover` with commanded torques.
    #[must_use]
    pub fn new(name: &str, rover: Rover) -> Self {
        Self {
            name: name.to_owned(),
            kind: ModelKind::Rover,
            stated: Stated::default(),
            rover,
            start: Start::default(),
            sensors: Sensors::default(),
            control: Control::default(),
            stepping: Stepping::default(),
            obstacles: Vec::new(),
            test: None,
            body_contact: BodyContact::default(),
            registered_law: None,
        }
    }

    /// The model at the start of a run: settled on its ground, controllers at rest.
    ///
    /// # Errors
    /// [`RunError`] where a parameter is out of range, the rover finds no rest or a controller refuses it.
    pub fn start(&self) -> Result<Run, RunError> {
        Run::new(self)
    }

    /// The inputs that a run of this model takes, with their descriptions and starting values.
    #[must_use]
    pub fn inputs(&self) -> Inputs {
        Inputs::new(self)
    }
}

/// Limits of the drives, which a wheel whose speed is imposed does not feel.
const LIMITS: [&str; 3] = ["motor.inverse_torque_limit", "motor.inverse_current_limit", "motor.inverse_voltage"];

/// The whole vocabulary of this model: what something reads. Sensors and control are listed where there is
/// a controller, the drives' limits where torques are commanded, effects where the rover has what they need, obstacles
/// where the plant feels them.
impl Parameters<f64> for Model {
    fn visit(&mut self, prefix: &str, f: &mut dyn FnMut(Variable, &mut f64)) {
        match self.kind {
            ModelKind::Carriage => return self.visit_rig(prefix, f),
            ModelKind::SoilTest => return self.visit_soil_test(prefix, f),
            ModelKind::Rover => {}
        }
        let limited = self.control.kind != ControlKind::Speed;
        let jointed = !self.rover.links.is_empty();
        let unfelt = self.unfelt_effects(limited, jointed);
        self.rover.visit("", &mut |variable, place| {
            let name = variable.name.as_str();
            let of_unfelt = || name.split_once('.').is_some_and(|(group, _)| unfelt.iter().any(|id| id == group));
            if (limited || !LIMITS.contains(&name)) && !of_unfelt() {
                f(Variable { name: join(prefix, &variable.name), ..variable }, place);
            }
        });
        if let Some(test) = &mut self.test {
            test.visit(prefix, f);
        }
        self.start.visit(prefix, f);
        if self.stepping.plant == Plant::RigidBodies {
            self.body_contact.visit(&join(prefix, "rover"), f);
            for (k, obstacle) in self.obstacles.iter_mut().enumerate() {
                obstacle.parameters.visit(&join(prefix, &format!("obstacle[{}]", k + 1)), f);
            }
        }
        match self.control.kind {
            ControlKind::Torque | ControlKind::Speed => {}
            ControlKind::SpeedLoop | ControlKind::Velocity => {
                self.sensors.encoder.visit(&join(prefix, "sensor"), f);
                self.control.velocity.visit(&join(prefix, "velocity_control"), f);
            }
            ControlKind::VelocityTuned => {
                self.sensors.encoder.visit(&join(prefix, "sensor"), f);
                self.control.velocity_tuned.visit(&join(prefix, "velocity_tuned"), f);
            }
            ControlKind::Rtc => {
                self.sensors.body.visit(&join(prefix, "sensor"), f);
                self.control.rtc.visit(&join(prefix, "rtc"), f);
                self.control.rtc_timing.visit(&join(prefix, "rtc"), f);
                self.sensors.encoder.visit(&join(prefix, "sensor"), f);
                self.visit_estimators(jointed, prefix, f);
            }
            ControlKind::RtcSpeed => {
                self.sensors.body.visit(&join(prefix, "sensor"), f);
                self.control.rtc_speed.visit(&join(prefix, "rtc_speed"), f);
                self.sensors.encoder.visit(&join(prefix, "sensor"), f);
                self.control.velocity.visit(&join(prefix, "velocity_control"), f);
                self.visit_estimators(jointed, prefix, f);
            }
            ControlKind::Slip => {
                self.sensors.body.visit(&join(prefix, "sensor"), f);
                self.sensors.encoder.visit(&join(prefix, "sensor"), f);
                self.control.velocity.visit(&join(prefix, "velocity_control"), f);
                self.control.slip.visit(&join(prefix, "slip_control"), f);
                self.sensors.gyroscope.visit(&join(prefix, "sensor"), f);
                if jointed {
                    self.sensors.joint.visit(&join(prefix, "sensor"), f);
                }
            }
            ControlKind::EqualTorque => {
                self.sensors.body.visit(&join(prefix, "sensor"), f);
                self.control.equal_torque.visit(&join(prefix, "equal_torque"), f);
            }
            ControlKind::Registered => {
                self.sensors.body.visit(&join(prefix, "sensor"), f);
                self.sensors.encoder.visit(&join(prefix, "sensor"), f);
                self.sensors.gyroscope.visit(&join(prefix, "sensor"), f);
                if jointed {
                    self.sensors.joint.visit(&join(prefix, "sensor"), f);
                }
                if let Some(law) = &mut self.registered_law {
                    law.visit(prefix, f);
                }
            }
        }
        if let Some(soil) = &mut self.control.nominal_soil {
            soil.visit(&join(prefix, "nominal.soil"), f);
        }
    }

    fn values(&self, f: &mut dyn FnMut(f64)) {
        self.clone().visit("", &mut |_, value| f(*value));
    }
}

impl Model {
    /// Ids of the effects that need what this rover does not have.
    fn unfelt_effects(&self, torques: bool, joints: bool) -> Vec<String> {
        let lacks = |facts: &Facts| match facts.needs {
            Needs::Nothing => false,
            Needs::CommandedTorque => !torques,
            Needs::Joints => !joints,
        };
        let all = self.rover.effects.facts();
        all.filter(|(_, facts)| lacks(facts)).map(|(id, _)| id.to_owned()).collect()
    }

    /// What a wheel on a carriage has, as [`Rig`](crate::carriage::Rig) lists it.
    fn visit_rig(&mut self, prefix: &str, f: &mut dyn FnMut(Variable, &mut f64)) {
        self.rover.environment.visit(prefix, f);
        self.rover.wheel.visit(&join(prefix, "wheel"), f);
        self.rover.soil.visit(&join(prefix, "soil"), f);
        self.rover.effects.visit(prefix, f);
    }

    /// The sensors of joints, and what rough-terrain control's estimators read beyond them.
    fn visit_estimators(&mut self, jointed: bool, prefix: &str, f: &mut dyn FnMut(Variable, &mut f64)) {
        let sensor = join(prefix, "sensor");
        if jointed {
            self.sensors.joint.visit(&sensor, f);
        }
        let angles = self.control.contact_angles == ContactAngleSource::Estimator;
        let soil = self.control.soil == SoilSource::Estimator;
        if angles || soil {
            self.sensors.gyroscope.visit(&sensor, f);
        }
        if angles {
            self.control.contact_angle_estimation.visit(&join(prefix, "contact_angle_estimation"), f);
        }
        if soil {
            self.sensors.current.visit(&sensor, f);
            self.control.soil_identification.visit(&join(prefix, "soil_identification"), f);
        }
    }
}
