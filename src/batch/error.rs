//! Errors of a batch.

use crate::model::RunError;

/// Why a batch cannot be made or stepped.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum BatchError {
    /// There is no run in it.
    #[error("a batch of no runs; expected one at least")]
    Empty,
    /// No thread to step it.
    #[error("0 threads; expected one at least")]
    NoThreads,
    /// Instructions that this processor does not have.
    #[error("the kernel {0:?} is not built in or not on this processor; expected another, such as Kernel::best()")]
    Kernel(super::Kernel),
    /// A run of another structure.
    #[error(
        "run {index} differs from the first in its inputs, its signals or its inner step; expected the same of all"
    )]
    Structure {
        /// Its place, from 0.
        index: usize,
    },
    /// The wrong number of input values.
    #[error("{got} input values were given, this batch takes {expected}")]
    InputLength {
        /// Values given.
        got: usize,
        /// Runs times inputs of a run.
        expected: usize,
    },
    /// The wrong number of marks.
    #[error("{got} marks of active runs were given, this batch has {expected} runs")]
    ActiveLength {
        /// Marks given.
        got: usize,
        /// Runs.
        expected: usize,
    },
    /// An input that a run refuses.
    #[error("run {index}: {source}")]
    Input {
        /// Its place, from 0.
        index: usize,
        /// Why.
        source: RunError,
    },
    /// A bug: a run was left in an unknown state.
    #[error("a run of this batch panicked; expected a new batch from here on")]
    Panicked,
}
