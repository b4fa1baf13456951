//! What steps the runs of a batch.

#[cfg(target_arch = "x86_64")]
use crate::scalar::{Arch, Avx2, Avx512};

/// Whether the kernels that only the feature `every-kernel` adds are built in. The unit tests, for which this crate is compiled a second
/// time, go without them; `tests/batch_agreement.rs` compares all.
const EVERY: bool = cfg!(all(feature = "every-kernel", not(test)));

/// How many runs are stepped at once, and with which instructions. A choice of speed alone: the bits are the same.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Kernel {
    /// Each run by itself.
    Single,
    /// Eight runs side by side with what every processor of the target has; on x86-64 with the feature `every-kernel`.
    Portable,
    /// Eight runs side by side in pairs of 256 bit registers.
    Avx2,
    /// Eight runs side by side in 512 bit registers; with the feature `every-kernel`.
    Avx512,
}

impl Kernel {
    /// The fastest that is built in and on this processor.
    #[must_use]
    pub fn best() -> Self {
        [Self::Avx512, Self::Avx2, Self::Portable].into_iter().find(|kernel| kernel.is_there()).unwrap_or(Self::Single)
    }

    /// Whether it is built in and this processor has it.
    #[must_use]
    pub fn is_there(self) -> bool {
        match self {
            Self::Single => true,
            Self::Portable => EVERY || cfg!(not(target_arch = "x86_64")),
            #[cfg(target_arch = "x86_64")]
            Self::Avx2 => Avx2::there(),
            #[cfg(target_arch = "x86_64")]
            Self::Avx512 => EVERY && Avx512::there(),
            #[cfg(not(target_arch = "x86_64"))]
            Self::Avx2 | Self::Avx512 => false,
        }
    }
}
