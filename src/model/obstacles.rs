//! Obstacles in a model file.

use super::{Model, ModelError, Plant};
use crate::obstacle::{Obstacle, ObstacleKind, ObstacleParameters};
use bekker_modeldescription::Lookup;
use serde::{Deserialize, Serialize};

/// An obstacle with its numbers; those of [`ObstacleParameters`] where missing.
#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct ObstacleSpec {
    kind: ObstacleKind,
    x: Option<f64>,
    height: Option<f64>,
    width: Option<f64>,
    friction: Option<f64>,
}

impl From<&Obstacle> for ObstacleSpec {
    fn from(obstacle: &Obstacle) -> Self {
        let ObstacleParameters { x, height, width, friction } = obstacle.parameters;
        let [x, height, width, friction] = [x, height, width, friction].map(Some);
        Self { kind: obstacle.kind, x, height, width, friction }
    }
}

impl Model {
    /// Adds obstacles; their numbers go through the vocabulary, so that errors carry full names.
    pub(super) fn add_obstacles(&mut self, specs: &[ObstacleSpec]) -> Result<(), ModelError> {
        if !specs.is_empty() && self.stepping.plant != Plant::RigidBodies {
            return Err(ModelError::Obstacles(specs.len()));
        }
        for spec in specs {
            self.obstacles.push(Obstacle { kind: spec.kind, parameters: ObstacleParameters::default() });
            let number = self.obstacles.len();
            let given = [("x", spec.x), ("height", spec.height), ("width", spec.width), ("friction", spec.friction)];
            for (name, value) in given {
                if let Some(value) = value {
                    self.set(&format!("obstacle[{number}].{name}"), value)?;
                }
            }
        }
        Ok(())
    }
}
