//! Parameters that may change while a run is under way.

use super::closed_loop::ActiveController;
use super::origin::Origin;
use super::{AnyPlant, ControllerRun, Model, Run, RunError};
use bekker_modeldescription::{Lookup, Parameters};

impl Model {
    /// Whether the parameter `name` may change on the way, see [`Run::retune`]: soil, gravity, motors, sensors, the gains of
    /// controllers, and effects but for those, and those parameters, that are not tunable ([`Facts`](crate::effects::Facts)). What makes the
    /// vehicle, the ground, the clocks and the estimators is decided at the start.
    #[must_use]
    pub fn is_tunable(&self, name: &str) -> bool {
        let group = name.split(['.', '[']).next().unwrap_or(name);
        match group {
            "gravity" | "soil" | "nominal" | "motor" | "sensor" => true,
            "velocity_control" | "velocity_tuned" | "rtc" | "rtc_speed" | "slip_control" | "equal_torque" => {
                !name.ends_with(".period")
            }
            _ if self.registered_law.as_ref().is_some_and(|law| law.id() == group) => !name.ends_with(".period"),
            _ => {
                let effects = &self.rover.effects;
                let custom = || effects.custom.iter().any(|effect| effect.id() == group);
                let own = name[group.len()..].trim_start_matches('.');
                effects.facts_of(group).map_or_else(custom, |facts| facts.tunable && !facts.not_tunable.contains(&own))
            }
        }
    }

    /// Refuses a change from `before` that is not one of tunable parameters.
    fn check_tuning(&self, before: &Self) -> Result<(), RunError> {
        self.clone().check()?;
        let (now, before) = (names_and_values(&mut self.clone()), names_and_values(&mut before.clone()));
        let refused = |name: &str| RunError::NotTunable { name: name.to_owned() };
        if now.len() != before.len() {
            return Err(refused("the model's structure"));
        }
        for ((name, value), (known, old)) in now.iter().zip(&before) {
            if name != known || (value.to_bits() != old.to_bits() && !self.is_tunable(name)) {
                return Err(refused(name));
            }
        }
        Ok(())
    }
}

fn names_and_values(model: &mut Model) -> Vec<(String, f64)> {
    let mut all = Vec::new();
    model.visit("", &mut |variable, value| all.push((variable.name, *value)));
    all
}

impl Run {
    /// Goes on under the parameters of `model`, which may differ from those of the run so far in tunable ones
    /// ([`Model::is_tunable`]). What moves stays as it is, histories of controllers and streams of noise too; forces, and
    /// with them accelerations, are those of the new parameters at once.
    ///
    /// # Errors
    /// [`RunError::NotTunable`] where something else differs, [`RunError`] where a controller or the equations of motion
    /// refuse the parameters; the run is then as it was.
    pub fn retune(&mut self, model: &Model) -> Result<(), RunError> {
        let purpose = "a change of parameters on the way";
        self.origin.model().in_joint_coordinates(purpose)?;
        model.check_tuning(self.origin.model())?;
        let mut there = self.clone();
        match &mut there.simulation {
            AnyPlant::JointCoordinates(simulation) => simulation.retune(model.rover.clone())?,
            #[cfg(feature = "rigid")]
            AnyPlant::RigidBodies(_) => return Err(RunError::NeedsJointCoordinates { purpose }),
        }
        there.sensors.retune(model.sensors);
        if let Some(controller) = &mut there.controller {
            *controller = resumed(controller, model, self.time())?;
        }
        there.origin = Origin::new(model);
        *self = there;
        Ok(())
    }
}

impl ControllerRun {
    /// As [`Run::retune`], for a controller by itself.
    ///
    /// # Errors
    /// As [`Run::retune`].
    pub fn retune(&mut self, model: &Model) -> Result<(), RunError> {
        model.check_tuning(self.origin.model())?;
        self.controller = resumed(&self.controller, model, self.time())?;
        self.origin = Origin::new(model);
        Ok(())
    }
}

/// The controller of `model`, with the history of `old`.
fn resumed(old: &ActiveController, model: &Model, time: f64) -> Result<ActiveController, RunError> {
    let mut new = ActiveController::new(model)
        .map_err(|source| RunError::Control { time, source })?
        .ok_or(RunError::NoController { kind: model.control.kind })?;
    new.resume(old).map_err(|_| RunError::NotTunable { name: "the model's structure".to_owned() })?;
    Ok(new)
}
