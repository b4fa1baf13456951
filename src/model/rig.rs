//! A wheel on a carriage as a model, and a tested wheel on a rover.

use super::{Model, RunError};
use crate::carriage::{Rig, SetPoint, SteadyError, SteadyPoint};
use crate::effects::DefinitionError;
use crate::simulation::{Event, Status};
use crate::soil_test::{SoilTest, TestRig};
use bekker_modeldescription::{Parameters, Variable, join};
use serde::{Deserialize, Serialize};
use std::collections::{BTreeMap, BTreeSet};

/// What a model is of.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ModelKind {
    /// A rover on its ground, which moves in time.
    #[default]
    Rover,
    /// A test of the soil by a plate or by shear: soil, rig and effects on the test. What else a [`Model`] holds is not used.
    SoilTest,
    /// A wheel on a carriage: gravity, wheel, soil and effects; a steady point for each load, slip and wheel speed. What
    /// else a [`Model`] holds is not used.
    Carriage,
}

/// Time for which a rover with a tested wheel has to stand or drive, s.
const FIRST: f64 = 1.0;

/// Why a rover cannot be used as it is.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum UnfitRover {
    /// It does not start.
    #[error("the rover `{name}` does not start: {source}")]
    Start {
        /// Name of the model.
        name: String,
        /// Why.
        source: Box<RunError>,
    },
    /// Its run ends at once.
    #[error("the rover `{name}` does not drive: its run ends after {time:.2} s: {event}")]
    Ended {
        /// Name of the model.
        name: String,
        /// When, s.
        time: f64,
        /// What happened.
        event: Event,
    },
    /// Its equations or its controller fail.
    #[error("the rover `{name}` fails within its first second: {source}")]
    Failed {
        /// Name of the model.
        name: String,
        /// Why.
        source: Box<RunError>,
    },
}

impl Model {
    /// A wheel on a carriage.
    #[must_use]
    pub fn carriage(name: &str, rig: Rig) -> Self {
        let mut model = Self::new(name, crate::rover::Rover::two_wheeled());
        model.kind = ModelKind::Carriage;
        let Rig { environment, wheel, soil, effects } = rig;
        (model.rover.environment, model.rover.wheel) = (environment, wheel);
        (model.rover.soil, model.rover.effects) = (soil, effects);
        model
    }

    /// A test of the soil.
    #[must_use]
    pub fn soil_test(name: &str, test: SoilTest) -> Self {
        let mut model = Self::new(name, crate::rover::Rover::two_wheeled());
        model.kind = ModelKind::SoilTest;
        let SoilTest { soil, rate, moisture, rig } = test;
        model.rover.soil = soil;
        (model.rover.effects.rate, model.rover.effects.moisture) = (rate, moisture);
        model.test = Some(rig);
        model
    }

    /// The soil of this model in its test; in an ideal one where it has none.
    #[must_use]
    pub fn tested_soil(&self) -> SoilTest {
        SoilTest::of(&self.rover, &self.test.clone().unwrap_or_default())
    }

    /// What a test of the soil has, as [`SoilTest`] lists it.
    pub(super) fn visit_soil_test(&mut self, prefix: &str, f: &mut dyn FnMut(Variable, &mut f64)) {
        self.rover.soil.visit(&join(prefix, "soil"), f);
        self.rover.effects.rate.visit(&join(prefix, "rate"), f);
        self.rover.effects.moisture.visit(&join(prefix, "moisture"), f);
        self.test.get_or_insert_with(TestRig::default).visit(prefix, f);
    }

    /// Gravity, wheel, soil and effects of this model, for steady points on a carriage.
    #[must_use]
    pub fn rig(&self) -> Rig {
        Rig::of(&self.rover)
    }

    /// This rover with gravity, wheel, soil and effects of `tested`, which count as stated; of a test of the soil with what it states of
    /// the soil. Parameters of effects that have their defaults in `tested` stay as this rover has them: a carriage does not see all.
    ///
    /// # Errors
    /// [`DefinitionError`] where both define effects of the user's own with one id in different ways.
    pub fn with_rig_of(&self, tested: &Self) -> Result<Self, DefinitionError> {
        let mut rover = self.clone();
        rover.rover.effects.register_all_of(&tested.rover.effects)?;
        let custom = &tested.rover.effects.custom;
        rover.define_effects(custom.iter().map(|effect| effect.definition().clone()).collect())?;
        let (mut values, mut of_effects) = (BTreeMap::new(), BTreeSet::new());
        tested.rover.effects.clone().visit("", &mut |variable, _| {
            of_effects.insert(variable.name);
        });
        // A test of the soil tells of a few of its parameters, which it states, and nothing of a wheel.
        let told = |name: &str| tested.kind != ModelKind::SoilTest || tested.stated.contains(name);
        tested.rig().visit("", &mut |variable, value| {
            if told(&variable.name) && (!of_effects.contains(&variable.name) || *value != variable.default) {
                values.insert(variable.name, *value);
            }
        });
        rover.visit("", &mut |variable, place| {
            values.get(&variable.name).into_iter().for_each(|value| *place = *value);
        });
        values.keys().for_each(|name| rover.stated.insert(name));
        Ok(rover)
    }

    /// Whether a rover comes to rest on its ground and is not at its end within its first second: belly on the ground,
    /// stuck, sunk to an axle. Its inputs have their starting values. What is no rover always passes.
    ///
    /// # Errors
    /// [`UnfitRover`] says what happens instead.
    pub fn check_drive(&self) -> Result<(), UnfitRover> {
        if self.kind != ModelKind::Rover {
            return Ok(());
        }
        let name = || self.name.clone();
        let mut run = self.start().map_err(|source| UnfitRover::Start { name: name(), source: Box::new(source) })?;
        let steps = (FIRST / run.step_size()).ceil() as u64;
        match run.advance(steps).map_err(|source| UnfitRover::Failed { name: name(), source: Box::new(source) })? {
            Status::Running => Ok(()),
            Status::Ended(event) => Err(UnfitRover::Ended { name: name(), time: run.time(), event }),
        }
    }

    /// Steady points by load (N), slip and wheel speed (rad/s), see [`Rig::at`].
    ///
    /// # Errors
    /// [`SteadyError`] of the first that does not exist, with its number in the list, from 0.
    pub fn steady_points(&self, points: &[SetPoint]) -> Result<Vec<SteadyPoint>, (usize, SteadyError)> {
        let rig = self.rig();
        points.iter().enumerate().map(|(k, set)| rig.at(set).map_err(|source| (k, source))).collect()
    }
}
