//! A wheel on a carriage as a [`FmuModel`]: load, slip and wheel speed in, drawbar pull, torque and sinkage out.
//!
//! A steady map without states: outputs are those of the inputs and parameters that hold at the end of a step, whatever its
//! length. All parameters may change between two steps.

use super::by_reference::{by_reference, from_values, into_places, starts};
use super::state::{read_list, write_list};
use super::step_position::StepPosition;
use super::{Packed, description};
use crate::model::{Failure, FmuModel, Outcome};
use bekker::carriage::{SetPoint, SteadyPoint};
use bekker::model::{Model as RoverModel, ModelKind};
use bekker::snapshot::{Fingerprint, Reader, SnapshotError, Writer, close, open};
use bekker_modeldescription::xml::Variability::Tunable;
use bekker_modeldescription::xml::{Description, Entry};
use bekker_modeldescription::{Lookup, Parameters};
use std::ops::Range;
use std::sync::Arc;

/// What the bytes of a state are, and the version of their format.
const KIND: [u8; 4] = *b"BKFW";
const VERSION: u32 = 1;

/// The step that is offered, s; every other one gives the same.
const STEP: f64 = 0.01;

/// A wheel on a carriage at its present inputs.
#[derive(Clone)]
pub(super) struct Carriage {
    description: Arc<Description>,
    model: RoverModel,
    /// Values by reference; that of time is not used.
    values: Vec<f64>,
    parameters: Range<usize>,
    inputs: Range<usize>,
    outputs: Range<usize>,
    time: f64,
}

impl Carriage {
    /// The wheel of a model file.
    ///
    /// # Errors
    /// A sentence where the model is a rover.
    pub fn new(model: RoverModel, packed: Packed) -> Result<Self, String> {
        if model.kind != ModelKind::Carriage {
            return Err(format!(
                "`{}` is a rover, expected a wheel on a carriage ([rig] kind = \"carriage\")",
                model.name
            ));
        }
        let mut entries = vec![Entry::time()];
        let tunable = |(variable, value)| Entry { variability: Tunable, ..Entry::parameter(variable, value) };
        entries.extend(model.clone().list().into_iter().map(tunable));
        let parameters = 1..entries.len();
        entries.extend(SetPoint::default().list().into_iter().map(|(variable, value)| Entry::input(variable, value)));
        let inputs = parameters.end..entries.len();
        let at_start: Vec<usize> = inputs.clone().collect();
        let output = |variable| Entry::output(variable).depending_on(vec![], at_start.clone());
        entries.extend(SteadyPoint::default().list().into_iter().map(|(variable, _)| output(variable)));
        let outputs = inputs.end..entries.len();
        let description = Arc::new(description(&model, packed, STEP, entries));
        let values = starts(&description);
        Ok(Self { description, model, values, parameters, inputs, outputs, time: 0.0 })
    }

    /// Computes the outputs from inputs and parameters.
    fn evaluate(&mut self) -> Result<(), Failure> {
        self.model.places(&mut from_values(&self.values[self.parameters.clone()]));
        self.model.clone().check().map_err(|error| Failure(error.to_string()))?;
        let mut set = SetPoint::default();
        set.places(&mut from_values(&self.values[self.inputs.clone()]));
        set.check().map_err(|error| Failure(error.to_string()))?;
        let point = self.model.rig().at(&set).map_err(|error| Failure(error.to_string()))?;
        point.values(&mut into_places(&mut self.values[self.outputs.clone()]));
        Ok(())
    }

    fn fingerprint(&self) -> Fingerprint {
        Fingerprint::of(&self.description.content)
    }
}

impl FmuModel for Carriage {
    by_reference!();

    fn start(&mut self) -> Result<(), Failure> {
        self.time = 0.0;
        self.evaluate()
    }

    fn inner_step(&self) -> f64 {
        STEP
    }

    fn advance(&mut self, steps: u64) -> Result<Outcome, Failure> {
        let place = StepPosition::of(self.time, STEP)?;
        self.advance_to((place.end() + steps) as f64 * STEP)
    }

    fn advance_to(&mut self, time: f64) -> Result<Outcome, Failure> {
        StepPosition::of(time, STEP)?;
        self.evaluate()?;
        self.time = time;
        Ok(Outcome::Running)
    }

    fn reset(&mut self) {
        self.values = starts(&self.description);
        self.time = 0.0;
    }

    fn serialise(&self) -> Result<Vec<u8>, Failure> {
        let mut body = Writer::default();
        write_list(&self.values, &mut body);
        body.real(self.time);
        Ok(close(KIND, VERSION, self.fingerprint(), &body.finish()))
    }

    fn deserialise(&mut self, bytes: &[u8]) -> Result<(), Failure> {
        let body = open(KIND, VERSION, self.fingerprint(), bytes).map_err(SnapshotError::from)?;
        let mut from = Reader::new(body);
        let mut there = self.clone();
        read_list(&mut there.values, "values", &mut from)?;
        there.time = from.real()?;
        from.end()?;
        *self = there;
        Ok(())
    }
}
