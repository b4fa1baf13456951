//! Models in TOML, in and out.
//!
//! ```toml
//! name = "my rover"
//! preset = "gentle_rtc"            # start from a built-in model; or:
//! [vehicle]
//! wheels = [0, 1, 1]               # body of each wheel, rear to front: 0 the chassis, k link k
//! links = [0]                      # body that carries each link's joint
//! [parameters]                     # by the vocabulary's names
//! soil.cohesion = 800.0            # nested tables and dotted names mean the same
//! "wheel[1].x" = -0.4
//! [terrain]
//! preset = "waves"
//! [control]
//! kind = "rtc"                     # torque, speed, speed_loop, velocity, velocity_tuned, rtc, rtc_speed, slip, equal_torque
//! strength = "mohr_coulomb"        # shear limit of rtc; or "thesis", (4.15) as printed; or "mobilised"
//! solver = "clarabel"              # of rtc's optimisation; or "active_set", for batches of rovers
//! criterion = "power"              # power or traction, of rtc_speed also electrical_power; without it as the ground asks (4.11)
//! contact_angles = "sensor"        # of rtc; or "estimator", the filter of 2.5
//! soil = "nominal"                 # strength that rtc believes in; or "estimator", identified on the way; or "map"
//! [control.nominal_soil]           # the soil that controllers believe in; without it, the true one
//! cohesion = 500.0                 # names of `soil.*`; those that are not named are as the true soil's
//! [simulation]
//! step_size = 0.002
//! duration = 20.0
//! seed = 0
//! plant = "rigid_bodies"           # joint_coordinates (default) or rigid_bodies, which feels obstacles
//! [fmu]                            # what an FMU of this model offers; nothing else reads it
//! kind = "rover"                   # rover, controller or rover_with_controller
//! [[obstacle]]                     # any number; m
//! kind = "rock"                    # rock, block, ledge
//! x = 2.0
//! height = 0.06
//! width = 0.2
//! friction = 0.7
//! [[effect]]                       # effects of the user's own, see [`custom`](crate::effects::custom)
//! id = "cable"
//! target = "body.force_x"
//! expression = "-k * max(travelled, 0)"
//! parameters = { k = { neutral = 0.0, min = 0.0, max = 10.0, unit = "N/m" } }
//! ```
//!
//! A wheel on a carriage, as a single-wheel experiment tests it, has gravity, wheel, soil and effects, and no more:
//! ```toml
//! name = "wheel_on_carriage"
//! [rig]
//! kind = "carriage"
//! [parameters]
//! wheel.radius = 0.058
//! soil.cohesion = 170.0
//! ```
//!
//! A test of the soil by a plate or by shear has `kind = "soil_test"` there, and states of the soil what was found.

use super::obstacles::ObstacleSpec;
use super::sections::{ControlSpec, File, RigKind, RigSpec, Vehicle};
use super::{Model, ModelError, ModelKind};
use crate::effects::DefinitionError;
use crate::rover::Rover;
use bekker_modeldescription::{Lookup, Parameters};
use std::path::Path;

/// Prefix of the soil that controllers believe in, which stands in its own table of a file.
const NOMINAL_SOIL: &str = "nominal.soil";

impl Model {
    /// Reads a model from TOML; files that it names are looked for in `folder` (the working folder where
    /// none is given).
    ///
    /// # Errors
    /// [`ModelError`] saying which name, where, and what was expected.
    pub fn from_toml(text: &str, folder: Option<&Path>) -> Result<Self, ModelError> {
        Self::from_toml_with(text, folder, |_| Ok(()))
    }

    /// The same for a model with effects or a control law of other crates: `register` gives them to it before the
    /// parameters are read, by [`Model::register_effect`] and [`Model::register_law`].
    ///
    /// # Errors
    /// [`ModelError`].
    pub fn from_toml_with(
        text: &str,
        folder: Option<&Path>,
        register: impl FnOnce(&mut Self) -> Result<(), DefinitionError>,
    ) -> Result<Self, ModelError> {
        let file: File = crate::toml_text::read(text)?;
        let mut model = match &file.preset {
            Some(preset) => Self::preset(preset)?,
            None => Self::new("rover", Rover::two_wheeled()),
        };
        if let Some(rig) = &file.rig {
            file.refuse_rover()?;
            (model.kind, model.name) = match rig.kind {
                RigKind::Carriage => (ModelKind::Carriage, "wheel_on_carriage".to_owned()),
                RigKind::SoilTest => (ModelKind::SoilTest, "soil_test".to_owned()),
            };
        }
        if let Some(name) = file.name {
            model.name = name;
        }
        if let Some(vehicle) = &file.vehicle {
            vehicle.build(&mut model.rover)?;
        }
        if let Some(terrain) = &file.terrain {
            model.rover.terrain = terrain.terrain(folder.unwrap_or(Path::new(".")))?;
        }
        if let Some(control) = &file.control {
            control.choose(&mut model.control);
        }
        if let Some(stepping) = file.simulation {
            model.stepping = stepping.checked()?;
        }
        model.add_obstacles(&file.obstacle)?;
        model.define_effects(file.effect)?;
        register(&mut model)?;
        model.set_parameters(&file.parameters)?;
        if let Some(soil) = file.control.and_then(|control| control.nominal_soil) {
            model.believe(&soil)?;
        }
        Ok(model)
    }

    /// Gives the controllers a soil of their own: the rover's, but for the numbers in `soil`.
    fn believe(&mut self, soil: &toml::Table) -> Result<(), ModelError> {
        self.control.nominal_soil = Some(self.rover.soil);
        let mut flat = Vec::new();
        flatten(NOMINAL_SOIL, soil, &mut flat)?;
        for (name, value) in flat {
            self.set(&name, value)?;
        }
        Ok(())
    }

    /// Reads a model file.
    ///
    /// # Errors
    /// [`ModelError`].
    pub fn read(path: &Path) -> Result<Self, ModelError> {
        let text = std::fs::read_to_string(path)
            .map_err(|source| ModelError::Unreadable { file: path.display().to_string(), source })?;
        Self::from_toml(&text, path.parent())
    }

    /// Sets parameters from a table, nested or with dotted names; they count as stated ([`Model::stated`]).
    ///
    /// # Errors
    /// [`ModelError::Parameter`] or [`ModelError::NotANumber`] for the first that is refused.
    pub fn set_parameters(&mut self, table: &toml::Table) -> Result<(), ModelError> {
        let mut flat = Vec::new();
        flatten("", table, &mut flat)?;
        for (name, value) in flat {
            self.set(&name, value)?;
            self.stated.insert(&name);
        }
        Ok(())
    }

    /// The model as TOML, complete in itself: every parameter with its value, samples of the terrain inline.
    /// Reading it back gives the same model to the last bit.
    ///
    /// # Errors
    /// [`ModelError::Unwritable`] where a value has no form in TOML.
    pub fn to_toml(&self) -> Result<String, ModelError> {
        let (mut parameters, mut nominal_soil) = (toml::Table::new(), toml::Table::new());
        self.clone().visit("", &mut |variable, value| {
            // The numbers of terrain, obstacles and nominal soil stand in their own sections.
            if let Some(name) = variable.name.strip_prefix(NOMINAL_SOIL) {
                nominal_soil.insert(name.trim_start_matches('.').to_owned(), toml::Value::Float(*value));
            } else if !variable.name.starts_with("terrain.") && !variable.name.starts_with("obstacle[") {
                parameters.insert(variable.name, toml::Value::Float(*value));
            }
        });
        if self.kind != ModelKind::Rover {
            let kind = if self.kind == ModelKind::Carriage { RigKind::Carriage } else { RigKind::SoilTest };
            if self.kind == ModelKind::SoilTest && self.stated.names().next().is_some() {
                // A test tells of a part of the soil; the rest stays open.
                parameters.retain(|name, _| self.stated.contains(name));
            }
            let file = File {
                name: Some(self.name.clone()),
                rig: Some(RigSpec { kind }),
                parameters,
                effect: self.rover.effects.custom.iter().map(|effect| effect.definition().clone()).collect(),
                ..File::default()
            };
            return Ok(toml::to_string(&file)?);
        }
        let file = File {
            name: Some(self.name.clone()),
            preset: None,
            rig: None,
            vehicle: Some(Vehicle {
                wheels: self.rover.wheels.iter().map(|wheel| wheel.body).collect(),
                links: self.rover.links.iter().map(|link| link.parent).collect(),
            }),
            parameters,
            terrain: Some(self.rover.terrain.to_spec()),
            control: Some(ControlSpec::of(&self.control, nominal_soil)),
            simulation: Some(self.stepping),
            fmu: None,
            obstacle: self.obstacles.iter().map(ObstacleSpec::from).collect(),
            effect: self.rover.effects.custom.iter().map(|effect| effect.definition().clone()).collect(),
        };
        Ok(toml::to_string(&file)?)
    }
}

/// Joins nested tables into dotted names.
fn flatten(prefix: &str, table: &toml::Table, flat: &mut Vec<(String, f64)>) -> Result<(), ModelError> {
    for (key, value) in table {
        let name = bekker_modeldescription::join(prefix, key);
        match value {
            toml::Value::Table(inner) => flatten(&name, inner, flat)?,
            toml::Value::Float(number) => flat.push((name, *number)),
            toml::Value::Integer(number) => flat.push((name, *number as f64)),
            other => return Err(ModelError::NotANumber { name, found: other.type_str() }),
        }
    }
    Ok(())
}
