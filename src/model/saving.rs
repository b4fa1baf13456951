//! A run's moving state as bytes, see [`crate::snapshot`].

use super::{AnyPlant, Run};
use crate::snapshot::{Moving, Reader, SnapshotError, Writer, close, load_all, open, save_all};

/// What the bytes are, and the version of their format: it grows with every change of what moves.
const KIND: [u8; 4] = *b"BKRN";
const VERSION: u32 = 3;

impl Run {
    /// Everything that moves as bytes, from which a run of the same model goes on to the same bits, here or in another
    /// process: plant, effects' memories, sensors with their random streams, controllers, estimators, inputs.
    ///
    /// What [`Rtc::problem`](crate::control::Rtc::problem) shows is posed anew by the next command and not kept.
    ///
    /// # Errors
    /// [`SnapshotError::RigidBodies`] for the plant of rigid bodies.
    pub fn snapshot(&self) -> Result<Vec<u8>, SnapshotError> {
        let mut body = Writer::default();
        let Self { simulation, sensors, controller, inputs, command, measurement, .. } = self;
        match simulation {
            AnyPlant::JointCoordinates(simulation) => simulation.save(&mut body),
            #[cfg(feature = "rigid")]
            AnyPlant::RigidBodies(_) => return Err(SnapshotError::RigidBodies),
        }
        sensors.save(&mut body);
        controller.iter().for_each(|controller| controller.save(&mut body));
        save_all(inputs, &mut body);
        command.save(&mut body);
        measurement.save(&mut body);
        Ok(close(KIND, VERSION, self.origin.fingerprint(), &body.finish()))
    }

    /// Goes on from the bytes that a run of the same model wrote.
    ///
    /// # Errors
    /// [`SnapshotError`] for bytes of something else, of another model or version, damaged or incomplete ones; the run is
    /// then as it was.
    pub fn restore(&mut self, bytes: &[u8]) -> Result<(), SnapshotError> {
        let mut from = Reader::new(open(KIND, VERSION, self.origin.fingerprint(), bytes)?);
        let mut there = self.clone();
        match &mut there.simulation {
            AnyPlant::JointCoordinates(simulation) => simulation.load(&mut from)?,
            #[cfg(feature = "rigid")]
            AnyPlant::RigidBodies(_) => return Err(SnapshotError::RigidBodies),
        }
        there.sensors.load(&mut from)?;
        there.controller.iter_mut().try_for_each(|controller| controller.load(&mut from))?;
        load_all(&mut there.inputs, &mut from)?;
        there.command.load(&mut from)?;
        there.measurement.load(&mut from)?;
        from.end()?;
        *self = there;
        Ok(())
    }
}
