//! What steps the runs of a batch.

use crate::scalar::Arch;
#[cfg(target_arch = "x86_64")]
use crate::scalar::{Avx2, Avx512};

/// How many runs are stepped at once, and with which instructions. A choice of speed alone: the bits are the same.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Kernel {
    /// Each run by itself.
    Single,
    /// Eight runs side by side with what every processor of the target has.
    Portable,
    /// Eight runs side by side in pairs of 256 bit registers.
    Avx2,
    /// Eight runs side by side in 512 bit registers.
    Avx512,
}

impl Kernel {
    /// The fastest on this processor.
    #[must_use]
    pub fn best() -> Self {
        [Self::Avx512, Self::Avx2].into_iter().find(|kernel| kernel.is_there()).unwrap_or(Self::Portable)
    }

    /// Whether this processor has it.
    #[must_use]
    pub fn is_there(self) -> bool {
        match self {
            Self::Single | Self::Portable => true,
            #[cfg(target_arch = "x86_64")]
            Self::Avx2 => Avx2::there(),
            #[cfg(target_arch = "x86_64")]
            Self::Avx512 => Avx512::there(),
            #[cfg(not(target_arch = "x86_64"))]
            Self::Avx2 | Self::Avx512 => false,
        }
    }
}
