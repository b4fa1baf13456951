//! A rover's whole state as bytes.

use super::plant::{AdvancedBy, RoverFmu};
use crate::model::Failure;
use bekker::snapshot::{Fingerprint, Reader, SnapshotError, Writer, close, open};

/// What the bytes are, and the version of their format.
const KIND: [u8; 4] = *b"BKFR";
const VERSION: u32 = 2;

impl From<SnapshotError> for Failure {
    fn from(error: SnapshotError) -> Self {
        Self(error.to_string())
    }
}

/// Writes a list of numbers with its length.
pub(super) fn write_list(list: &[f64], to: &mut Writer) {
    to.number(list.len() as u64);
    list.iter().for_each(|value| to.real(*value));
}

/// Reads a list of numbers of a known length.
pub(super) fn read_list(list: &mut [f64], what: &'static str, from: &mut Reader) -> Result<(), SnapshotError> {
    from.length(what, list.len())?;
    list.iter_mut().try_for_each(|value| from.real().map(|read| *value = read))
}

pub(super) fn read_flag(from: &mut Reader) -> Result<bool, SnapshotError> {
    match from.number()? {
        0 => Ok(false),
        1 => Ok(true),
        code => Err(SnapshotError::Code { what: "yes or no", code }),
    }
}

impl RoverFmu {
    pub(super) fn save(&self) -> Result<Vec<u8>, Failure> {
        let mut body = Writer::default();
        write_list(&self.values, &mut body);
        write_list(&self.started_with(), &mut body);
        write_list(&self.applied, &mut body);
        body.bytes(&self.run.snapshot()?);
        write_list(&self.before, &mut body);
        body.number(u64::from(self.motion == AdvancedBy::BetweenSteps));
        body.real(self.time);
        if let Some(model_exchange) = &self.model_exchange {
            model_exchange.equations.write(&mut body);
            body.real(model_exchange.time);
            body.real(model_exchange.accepted);
            body.number(u64::from(model_exchange.stuck));
            body.number(u64::from(self.motion == AdvancedBy::Integrator));
        }
        Ok(close(KIND, VERSION, Fingerprint::of(&self.description.content), &body.finish()))
    }

    /// The run is started anew with the parameters that it had, and then brought to its state.
    pub(super) fn load(&mut self, bytes: &[u8]) -> Result<(), Failure> {
        let body =
            open(KIND, VERSION, Fingerprint::of(&self.description.content), bytes).map_err(SnapshotError::from)?;
        let mut from = Reader::new(body);
        let mut there = self.clone();
        read_list(&mut there.values, "values", &mut from)?;
        let mut parameters = vec![0.0; there.references.parameters.len()];
        read_list(&mut parameters, "parameters", &mut from)?;
        there.restart(&parameters)?;
        read_list(&mut parameters, "parameters", &mut from)?;
        there.tune_to(parameters)?;
        there.run.restore(from.bytes()?)?;
        read_list(&mut there.before, "signals", &mut from)?;
        let between = read_flag(&mut from)?;
        let time = from.real()?;
        let values = there.values.clone();
        there.begin()?;
        (there.values, there.time) = (values, time);
        there.motion = if between { AdvancedBy::BetweenSteps } else { AdvancedBy::Steps };
        if let Some(model_exchange) = &mut there.model_exchange {
            model_exchange.equations.read(&mut from)?;
            model_exchange.time = from.real()?;
            model_exchange.accepted = from.real()?;
            model_exchange.stuck = read_flag(&mut from)?;
            if read_flag(&mut from)? {
                there.motion = AdvancedBy::Integrator;
            }
            model_exchange.stale();
        }
        from.end()?;
        *self = there;
        Ok(())
    }
}
