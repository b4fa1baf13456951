//! Whether to go on: what long computations ask between their pieces.

use std::fmt;

/// A question that simulations of measured runs ask at every row. Once the answer is yes they fail with
/// [`Interrupted`](super::prediction::PredictionError::Interrupted), so that a search ends within milliseconds.
#[derive(Clone, Copy, Default)]
pub(crate) struct Halt<'a>(Option<&'a (dyn Fn() -> bool + Sync)>);

impl<'a> Halt<'a> {
    /// Halts where `stop` says yes.
    pub fn when(stop: &'a (dyn Fn() -> bool + Sync)) -> Self {
        Self(Some(stop))
    }

    /// Whether to end.
    pub fn asked(self) -> bool {
        self.0.is_some_and(|stop| stop())
    }
}

impl fmt::Debug for Halt<'_> {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str(if self.0.is_some() { "Halt(when asked)" } else { "Halt(never)" })
    }
}
