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
//! kind = "rtc"                     # torque, speed, speed_loop, velocity, velocity_tuned, rtc, slip, equal_torque
//! strength = "mohr_coulomb"        # shear limit of rtc; or "thesis", (4.15) as printed; or "mobilised"
//! solver = "clarabel"              # of rtc's optimisation; or "active_set", for batches of rovers
//! criterion = "power"            # of rtc: power or traction; without it, whichever the ground asks for (4.11)
//! contact_angles = "sensor"        # of rtc; or "estimator", the filter of 2.5
//! soil = "nominal"                 # strength that rtc believes in; or "estimator", identified on the way
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

use super::obstacles::ObstacleSpec;
use super::{ContactAngleSource, Control, ControlKind, Model, ModelKind, PRESETS, SoilSource, Stepping};
use crate::control::{Criterion, Solver, Strength};
use crate::effects::{DefinitionError, EffectDefinition};
use crate::rover::{Link, LinkParameters, MAX_COORDINATES, MAX_WHEELS, Mount, Rover, WheelMount};
use crate::terrain::{TerrainSpec, TerrainSpecError};
use bekker_modeldescription::{Lookup, ParameterError, Parameters};
use serde::{Deserialize, Serialize};
use std::path::Path;

/// Why a model cannot be read.
#[derive(Debug, thiserror::Error)]
pub enum ModelError {
    /// The text is not TOML, or has an unknown key or a value of the wrong type.
    #[error("the model file cannot be read: {0}")]
    Syntax(#[from] toml::de::Error),
    /// The model cannot be written.
    #[error("the model cannot be written: {0}")]
    Unwritable(#[from] toml::ser::Error),
    /// The file cannot be opened.
    #[error("{file}: {source}")]
    Unreadable {
        /// The file.
        file: String,
        /// What the system says.
        source: std::io::Error,
    },
    /// A parameter is unknown or out of range.
    #[error(transparent)]
    Parameter(#[from] ParameterError),
    /// A parameter's value is not a number.
    #[error("parameter `{name}`: expected a number, found {found}")]
    NotANumber {
        /// The parameter.
        name: String,
        /// The type found.
        found: &'static str,
    },
    /// No built-in model has this name.
    #[error("unknown preset `{name}`; the presets are {}", preset_names())]
    UnknownPreset {
        /// The name asked for.
        name: String,
    },
    /// The vehicle's structure makes no sense.
    #[error("vehicle: {0}")]
    Vehicle(String),
    /// An effect of the user's own is refused.
    #[error(transparent)]
    Effect(#[from] DefinitionError),
    /// The terrain cannot be built.
    #[error(transparent)]
    Terrain(#[from] TerrainSpecError),
    /// The model has obstacles, and its plant computes contact with soil only.
    #[error(
        "{0} [[obstacle]] given, but the plant is in joint coordinates; expected simulation.plant = \"rigid_bodies\""
    )]
    Obstacles(usize),
    /// A wheel on a carriage with something that only a rover has.
    #[error("[rig]: a wheel on a carriage has no [{0}]; expected [parameters] and [[effect]] beside it")]
    Rig(&'static str),
    /// A name of neither a file nor a built-in model.
    #[error("`{name}` is neither a file nor a built-in model ({})", preset_names())]
    Neither {
        /// The name.
        name: String,
    },
    /// A model file is refused.
    #[error("in `{file}`: {source}")]
    File {
        /// The file.
        file: String,
        /// Why.
        source: Box<ModelError>,
    },
    /// A number of `[simulation]` is out of range.
    #[error("simulation.{name} = {value}: expected {expected}")]
    Simulation {
        /// The key.
        name: &'static str,
        /// Its value.
        value: f64,
        /// The allowed range.
        expected: &'static str,
    },
}

fn preset_names() -> String {
    PRESETS.iter().map(|(name, _)| *name).collect::<Vec<_>>().join(", ")
}

#[derive(Debug, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    #[serde(skip_serializing_if = "Option::is_none")]
    name: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    preset: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    vehicle: Option<Vehicle>,
    #[serde(skip_serializing_if = "Option::is_none")]
    rig: Option<RigSpec>,
    #[serde(default)]
    parameters: toml::Table,
    #[serde(skip_serializing_if = "Option::is_none")]
    terrain: Option<TerrainSpec>,
    #[serde(skip_serializing_if = "Option::is_none")]
    control: Option<ControlSpec>,
    #[serde(skip_serializing_if = "Option::is_none")]
    simulation: Option<Stepping>,
    /// What an FMU of this model offers: read where one is made.
    #[serde(default, skip_serializing)]
    #[allow(dead_code, reason = "a key that a model file may have and nothing here reads")]
    fmu: Option<toml::Table>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    obstacle: Vec<ObstacleSpec>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    effect: Vec<EffectDefinition>,
}

#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Vehicle {
    wheels: Vec<usize>,
    #[serde(default)]
    links: Vec<usize>,
}

#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct RigSpec {
    kind: RigKind,
}

/// Rigs that a model may be of.
#[derive(Debug, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
enum RigKind {
    Carriage,
}

#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct ControlSpec {
    #[serde(skip_serializing_if = "Option::is_none")]
    kind: Option<ControlKind>,
    #[serde(skip_serializing_if = "Option::is_none")]
    strength: Option<Strength>,
    #[serde(skip_serializing_if = "Option::is_none")]
    solver: Option<Solver>,
    #[serde(skip_serializing_if = "Option::is_none")]
    criterion: Option<Criterion>,
    #[serde(skip_serializing_if = "Option::is_none")]
    contact_angles: Option<ContactAngleSource>,
    #[serde(skip_serializing_if = "Option::is_none")]
    soil: Option<SoilSource>,
    #[serde(skip_serializing_if = "Option::is_none")]
    nominal_soil: Option<toml::Table>,
}

/// Prefix of the soil that controllers believe in, which stands in its own table of a file.
const NOMINAL_SOIL: &str = "nominal.soil";

impl ControlSpec {
    /// Takes over the words.
    fn choose(&self, control: &mut Control) {
        control.kind = self.kind.unwrap_or(control.kind);
        control.strength = self.strength.unwrap_or(control.strength);
        control.solver = self.solver.unwrap_or(control.solver);
        control.criterion = self.criterion.or(control.criterion);
        control.contact_angles = self.contact_angles.unwrap_or(control.contact_angles);
        control.soil = self.soil.unwrap_or(control.soil);
    }

    /// The words of `control`, those that are not the usual ones.
    fn of(control: &Control, nominal_soil: toml::Table) -> Self {
        Self {
            kind: Some(control.kind),
            strength: Some(control.strength).filter(|strength| *strength != Strength::default()),
            solver: Some(control.solver).filter(|solver| *solver != Solver::default()),
            criterion: control.criterion,
            contact_angles: Some(control.contact_angles).filter(|source| *source != ContactAngleSource::default()),
            soil: Some(control.soil).filter(|source| *source != SoilSource::default()),
            nominal_soil: control.nominal_soil.map(|_| nominal_soil),
        }
    }
}

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
        if file.rig.is_some() {
            file.refuse_rover()?;
            model.kind = ModelKind::Carriage;
            "wheel_on_carriage".clone_into(&mut model.name);
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
        if self.kind == ModelKind::Carriage {
            let file = File {
                name: Some(self.name.clone()),
                rig: Some(RigSpec { kind: RigKind::Carriage }),
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

impl File {
    /// Refuses the sections that describe a rover.
    fn refuse_rover(&self) -> Result<(), ModelError> {
        let sections = [
            ("vehicle", self.vehicle.is_some()),
            ("terrain", self.terrain.is_some()),
            ("control", self.control.is_some()),
            ("simulation", self.simulation.is_some()),
            ("[obstacle]", !self.obstacle.is_empty()),
        ];
        sections.iter().find(|(_, given)| *given).map_or(Ok(()), |(section, _)| Err(ModelError::Rig(section)))
    }
}

impl Vehicle {
    /// Gives `rover` this structure; wheels and links that it already has keep their numbers.
    fn build(&self, rover: &mut Rover) -> Result<(), ModelError> {
        let bodies = 1 + self.links.len();
        if !(2..=MAX_WHEELS).contains(&self.wheels.len()) {
            let found = self.wheels.len();
            return Err(ModelError::Vehicle(format!("expected 2 to {MAX_WHEELS} wheels, found {found}")));
        }
        if 3 + self.links.len() > MAX_COORDINATES {
            let most = MAX_COORDINATES - 3;
            return Err(ModelError::Vehicle(format!("expected at most {most} links, found {}", self.links.len())));
        }
        if let Some(k) = self.wheels.iter().position(|&body| body >= bodies) {
            let body = self.wheels[k];
            return Err(ModelError::Vehicle(format!(
                "wheel {} sits on body {body}, expected 0 (the chassis) to {}",
                k + 1,
                bodies - 1
            )));
        }
        if let Some(j) = self.links.iter().enumerate().position(|(j, &parent)| parent > j) {
            return Err(ModelError::Vehicle(format!(
                "link {} is carried by body {}, expected 0 (the chassis) or a link of a lower number",
                j + 1,
                self.links[j]
            )));
        }
        let places = even_places(self.wheels.len());
        let mount = |k: usize| rover.wheels.get(k).map_or(Mount { x: places[k], z: 0.0 }, |wheel| wheel.mount);
        let wheels = self.wheels.iter().enumerate().map(|(k, &body)| WheelMount { body, mount: mount(k) }).collect();
        let link = |j: usize| rover.links.get(j).map_or_else(LinkParameters::default, |link| link.parameters);
        let links = self.links.iter().enumerate().map(|(j, &parent)| Link { parent, parameters: link(j) }).collect();
        rover.wheels = wheels;
        rover.links = links;
        Ok(())
    }
}

/// Wheels 70 cm apart in all, evenly spaced: where a file gives no places.
fn even_places(wheels: usize) -> Vec<f64> {
    (0..wheels).map(|k| 0.7 * k as f64 / (wheels - 1) as f64 - 0.35).collect()
}

impl Stepping {
    fn checked(self) -> Result<Self, ModelError> {
        let refuse = |name, value, expected| Err(ModelError::Simulation { name, value, expected });
        if !(self.step_size > 0.0 && self.step_size <= 0.02) {
            return refuse("step_size", self.step_size, "more than 0 and at most 0.02 s");
        }
        if !(self.duration > 0.0 && self.duration.is_finite()) {
            return refuse("duration", self.duration, "a finite time of more than 0 s");
        }
        Ok(self)
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
