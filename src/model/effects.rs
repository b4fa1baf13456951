//! Effects of the user's own in a model.

use super::{ContactAngleSource, ControlKind, Model, SoilSource};
use crate::effects::{DefinitionError, EffectDefinition, Facts};
use crate::rover::Rover;
use crate::signals::Signals;
use crate::soil_test::TEST_EFFECTS;
use bekker_modeldescription::Lookup;

/// Groups of names that not every model has.
const OTHER_GROUPS: [&str; 6] = ["terrain", "link", "obstacle", "plate", "soil_box", "shear_box"];

impl Model {
    /// Adds effects of the user's own, all neutral, from TOML with `[[effect]]` tables; the form is described in
    /// [`custom`](crate::effects::custom). An effect that is there already, with the same definition, stays as it is.
    ///
    /// # Errors
    /// [`DefinitionError`]; the model is unchanged then.
    pub fn add_effects(&mut self, text: &str) -> Result<(), DefinitionError> {
        self.define_effects(EffectDefinition::all_from_toml(text)?)
    }

    /// What there is to know of the effect `id`, be it of a wheel, a rover or a test of the soil; nothing where it is unknown or given
    /// as an expression.
    #[must_use]
    pub fn facts_of(&self, id: &str) -> Option<Facts> {
        let of_test = || self.test.as_ref()?.effects.facts().find(|(known, _)| *known == id).map(|(_, facts)| facts);
        self.rover.effects.facts_of(id).or_else(of_test)
    }

    /// Adds effects of the user's own by their definitions.
    ///
    /// # Errors
    /// [`DefinitionError`]; the model is unchanged then.
    pub fn define_effects(&mut self, definitions: Vec<EffectDefinition>) -> Result<(), DefinitionError> {
        if definitions.is_empty() {
            return Ok(());
        }
        let mut effects = self.rover.effects.clone();
        for definition in definitions {
            let id = definition.id.clone();
            effects.add(definition)?;
            self.refuse_taken(&id)?;
        }
        self.rover.effects = effects;
        Ok(())
    }
}

/// Refuses an id that is the first part of other names.
pub(super) fn refuse_group(groups: &[String], id: &str) -> Result<(), DefinitionError> {
    if !groups.iter().any(|group| group == id) {
        return Ok(());
    }
    let owner = format!("the parameters or signals `{id}` of every model");
    Err(DefinitionError::Taken { id: id.to_owned(), owner })
}

/// First parts of the names that parameters, inputs and signals have, whatever controls the model.
pub(super) fn groups_of_names() -> Vec<String> {
    let mut model = Model::new("", Rover::two_wheeled());
    let mut signals = Signals::<f64>::of(1, 1);
    let mut names: Vec<String> = signals.list().into_iter().map(|(variable, _)| variable.name).collect();
    model.control.nominal_soil = Some(model.rover.soil);
    model.control.contact_angles = ContactAngleSource::Estimator;
    model.control.soil = SoilSource::Estimator;
    for kind in [
        ControlKind::Torque,
        ControlKind::SpeedLoop,
        ControlKind::Velocity,
        ControlKind::VelocityTuned,
        ControlKind::Rtc,
        ControlKind::Slip,
        ControlKind::EqualTorque,
    ] {
        model.control.kind = kind;
        names.extend(model.list().into_iter().chain(model.inputs().list()).map(|(variable, _)| variable.name));
    }
    let group = |name: &String| name.split(['.', '[']).next().unwrap_or_default().to_owned();
    let tests = TEST_EFFECTS.iter().map(|(id, _)| (*id).to_owned());
    let mut groups: Vec<String> = names.iter().map(group).chain(OTHER_GROUPS.map(str::to_owned)).chain(tests).collect();
    groups.sort();
    groups.dedup();
    groups
}
