//! The model of a problem with fitted values, as it is kept and as it is given to a next experiment.

use super::Problem;
use crate::diagnosis::free::Free;
use crate::diagnosis::given::Given;
use crate::model::{Model, ModelKind};
use bekker_modeldescription::{Lookup, Parameters};

impl Problem<'_> {
    /// The model with fitted values, all of which it states; what the experiment says of single runs is not part of it.
    pub fn improved(&self, free: &[Free], values: &[f64]) -> Model {
        let mut model = self.known.clone();
        model.visit("", &mut |variable, place| {
            if let Some(k) = free.iter().position(|free| free.variable.name == variable.name) {
                *place = values[k];
            }
        });
        model.state_all();
        model
    }

    /// What another experiment with this rig is given: the model with fitted values, and what was set by hand.
    pub fn again(&self, free: &[Free], values: &[f64]) -> Given {
        let given = Given::from(&self.improved(free, values));
        let given = match &self.joint {
            Some(joint) => given.with_soil(joint.soil.clone(), &joint.label),
            None => given,
        };
        self.set.iter().fold(given, |given, (name, value)| given.with_value(name, *value))
    }

    /// The model with fitted values as it is kept: of a single wheel that was measured without naming a
    /// rover a wheel on a carriage, of a test of the soil that test, else the rover.
    pub fn saved(&self, free: &[Free], values: &[f64]) -> Model {
        if let Some((_, first)) = self.saved_parts(free, values).into_iter().next() {
            return first;
        }
        let mut model = self.improved(free, values);
        match self.found {
            ModelKind::Carriage => {
                model = Model::carriage("wheel_on_carriage", model.rig());
                model.state_all();
            }
            ModelKind::SoilTest => {
                model = Model::soil_test("soil_test", model.tested_soil());
                // A test tells a few of the soil's parameters; the others are not stated.
                let known = self.experiment.parameters.keys().chain(self.set.keys());
                let told = known.chain(free.iter().map(|free| &free.variable.name));
                let vocabulary: Vec<String> = model.list().into_iter().map(|(variable, _)| variable.name).collect();
                model.stated = told.filter(|name| vocabulary.contains(name)).cloned().collect();
            }
            ModelKind::Rover => {
                model.test = None;
                model.state_all();
            }
        }
        model
    }
}
