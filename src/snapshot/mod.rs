//! The moving state of a run as bytes, which goes on to the same bits, in this process or in another.
//!
//! Bytes hold what a step changes and nothing else: constants follow from the model. So a state is read in place, into a
//! run of the same model, whose shapes are there already: no length in the bytes decides about memory, and a number that
//! does not fit is an error with a name. Writing and reading of a part both follow from its fields, by
//! a derive. (A general format would write the constants too, or need a
//! second struct beside each; and it would be one more library in an FMU, whose size counts.)
//!
//! Numbers are little-endian, floating point as its IEEE 754 bits. A frame holds them together:
//!
//! | bytes | what |
//! |---|---|
//! | 4 | what kind of state |
//! | 4 | version of the format |
//! | 8 | fingerprint of the model |
//! | 8 | length of the body |
//! | 8 | checksum of the body |
//! | | the body |
//!
//! Caches that an optimisation rebuilds from its numbers alone (those of Clarabel) are left out: a clone of a run drops
//! them too and goes on to the same bits.

mod bytes;
mod frame;
mod moving;

pub(crate) use crate::scalar::Moving;
pub use bytes::{Reader, Writer};
pub use frame::{Fingerprint, FrameError, close, open};
pub(crate) use moving::{Moving, load_all, load_grown, loaded, moving_code, save_all};

/// Why a state cannot be written or taken over.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum SnapshotError {
    /// The frame does not fit or is damaged.
    #[error(transparent)]
    Frame(#[from] FrameError),
    /// The bytes end too early.
    #[error("the saved state ends {missing} bytes too early")]
    Ends {
        /// How many bytes more were expected.
        missing: usize,
    },
    /// There are bytes left.
    #[error("the saved state is {rest} bytes longer than expected")]
    Longer {
        /// How many.
        rest: usize,
    },
    /// A list has another length than the model's.
    #[error("the saved state has {got} {what}, expected {expected}")]
    Length {
        /// What is listed.
        what: &'static str,
        /// Entries found.
        got: u64,
        /// Entries of this model.
        expected: usize,
    },
    /// A code stands for nothing.
    #[error("the saved state has the code {code} for {what}")]
    Code {
        /// What is coded.
        what: &'static str,
        /// The code.
        code: u64,
    },
    /// The plant of rigid bodies, whose solver keeps a memory that it does not show.
    #[error(
        "the state of the plant of rigid bodies cannot be written as bytes: the solver of rapier2d keeps memories of its \
         contacts to itself; expected simulation.plant = \"joint_coordinates\""
    )]
    RigidBodies,
}
