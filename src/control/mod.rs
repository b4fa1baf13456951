//! Controllers: they see measurements and a reference, never the true state.

use crate::signals::{Command, Measurement, Reference};

/// Turns measurements and a reference into a command, once a control period.
pub trait Controller {
    /// The command for the next control period; written into `command`, which has one value a wheel.
    fn command(&mut self, measured: &Measurement, goal: &Reference, command: &mut Command);

    /// Forgets all history.
    fn reset(&mut self);
}
