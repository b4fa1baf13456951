//! The sections of a model file, and what each gives to a model.

use super::obstacles::ObstacleSpec;
use super::{ContactAngleSource, Control, ControlKind, ModelError, SoilSource, Stepping};
use crate::control::{Criterion, Solver, Strength};
use crate::effects::EffectDefinition;
use crate::rover::{Link, LinkParameters, MAX_COORDINATES, MAX_WHEELS, Mount, Rover, WheelMount};
use crate::terrain::TerrainSpec;
use serde::{Deserialize, Serialize};

#[derive(Debug, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct File {
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) name: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) preset: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) vehicle: Option<Vehicle>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) rig: Option<RigSpec>,
    #[serde(default)]
    pub(super) parameters: toml::Table,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) terrain: Option<TerrainSpec>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) control: Option<ControlSpec>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) simulation: Option<Stepping>,
    /// What an FMU of this model offers: read where one is made.
    #[serde(default, skip_serializing)]
    #[allow(dead_code, reason = "a key that a model file may have and nothing here reads")]
    pub(super) fmu: Option<toml::Table>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub(super) obstacle: Vec<ObstacleSpec>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub(super) effect: Vec<EffectDefinition>,
}

impl File {
    /// Refuses the sections that describe a rover.
    pub(super) fn refuse_rover(&self) -> Result<(), ModelError> {
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

#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Vehicle {
    pub(super) wheels: Vec<usize>,
    #[serde(default)]
    pub(super) links: Vec<usize>,
}

impl Vehicle {
    /// Gives `rover` this structure; wheels and links that it already has keep their numbers.
    pub(super) fn build(&self, rover: &mut Rover) -> Result<(), ModelError> {
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

#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct RigSpec {
    pub(super) kind: RigKind,
}

/// Rigs that a model may be of.
#[derive(Debug, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(super) enum RigKind {
    Carriage,
    SoilTest,
}

#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct ControlSpec {
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) kind: Option<ControlKind>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) strength: Option<Strength>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) solver: Option<Solver>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) criterion: Option<Criterion>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) contact_angles: Option<ContactAngleSource>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) soil: Option<SoilSource>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) nominal_soil: Option<toml::Table>,
}

impl ControlSpec {
    /// Takes over the words.
    pub(super) fn choose(&self, control: &mut Control) {
        control.kind = self.kind.unwrap_or(control.kind);
        control.strength = self.strength.unwrap_or(control.strength);
        control.solver = self.solver.unwrap_or(control.solver);
        control.criterion = self.criterion.or(control.criterion);
        control.contact_angles = self.contact_angles.unwrap_or(control.contact_angles);
        control.soil = self.soil.unwrap_or(control.soil);
    }

    /// The words of `control`, those that are not the usual ones.
    pub(super) fn of(control: &Control, nominal_soil: toml::Table) -> Self {
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

impl Stepping {
    pub(super) fn checked(self) -> Result<Self, ModelError> {
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
