//! The frame around a state: what it is, whose, and whether it is whole.

use std::fmt;

/// Bytes of the frame before the body.
const HEAD: usize = 32;

/// Why a frame is refused.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum FrameError {
    /// The bytes are no such state.
    #[error("these bytes are no saved state of this kind")]
    Foreign,
    /// Another version of the format.
    #[error("the saved state has the format version {got}, expected {expected}")]
    Version {
        /// Version found.
        got: u32,
        /// The version that is written here.
        expected: u32,
    },
    /// A state of another model.
    #[error("the saved state belongs to another model, or to this one with other parameters")]
    Model,
    /// Bytes are missing or too many.
    #[error("the saved state has {got} bytes, expected {expected}")]
    Size {
        /// Bytes found.
        got: usize,
        /// Number of bytes that the frame states.
        expected: u64,
    },
    /// Bytes have changed.
    #[error("the saved state is damaged: its checksum is not that of its bytes")]
    Damaged,
}

/// A 64 bit hash, FNV-1a: against accidents, not against attackers. It takes text from [`std::fmt::Write`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Fingerprint(u64);

impl Default for Fingerprint {
    fn default() -> Self {
        Self(0xcbf2_9ce4_8422_2325)
    }
}

impl Fingerprint {
    /// The fingerprint of a value, by its debugging text: every field that the value has is in it, and a number is
    /// written there with as many digits as tell it from all others.
    #[must_use]
    pub fn of(value: &impl fmt::Debug) -> Self {
        let mut fingerprint = Self::default();
        // Taking text in never fails.
        let _ = fmt::Write::write_fmt(&mut fingerprint, format_args!("{value:?}"));
        fingerprint
    }

    /// Takes bytes in.
    pub fn take(&mut self, bytes: &[u8]) {
        for byte in bytes {
            self.0 = (self.0 ^ u64::from(*byte)).wrapping_mul(0x0000_0100_0000_01b3);
        }
    }

    /// The hash.
    #[must_use]
    pub fn value(self) -> u64 {
        self.0
    }
}

impl fmt::Write for Fingerprint {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        self.take(text.as_bytes());
        Ok(())
    }
}

fn checksum(body: &[u8]) -> u64 {
    let mut sum = Fingerprint::default();
    sum.take(body);
    sum.value()
}

/// `body` in its frame.
#[must_use]
pub fn close(kind: [u8; 4], version: u32, model: Fingerprint, body: &[u8]) -> Vec<u8> {
    let mut bytes = Vec::with_capacity(HEAD + body.len());
    bytes.extend(kind);
    bytes.extend(version.to_le_bytes());
    bytes.extend(model.value().to_le_bytes());
    bytes.extend((body.len() as u64).to_le_bytes());
    bytes.extend(checksum(body).to_le_bytes());
    bytes.extend(body);
    bytes
}

/// The body of a frame that [`close`] made of the same kind, version and model.
///
/// # Errors
/// [`FrameError`].
pub fn open(kind: [u8; 4], version: u32, model: Fingerprint, bytes: &[u8]) -> Result<&[u8], FrameError> {
    let rest = bytes.strip_prefix(&kind).ok_or(FrameError::Foreign)?;
    let (got, rest) = rest.split_first_chunk().ok_or(FrameError::Foreign)?;
    let got = u32::from_le_bytes(*got);
    if got != version {
        return Err(FrameError::Version { got, expected: version });
    }
    let head = Head::of(rest).ok_or(FrameError::Foreign)?;
    if head.model != model.value() {
        return Err(FrameError::Model);
    }
    if head.body.len() as u64 != head.length {
        return Err(FrameError::Size { got: bytes.len(), expected: head.length.saturating_add(HEAD as u64) });
    }
    if head.checksum == checksum(head.body) { Ok(head.body) } else { Err(FrameError::Damaged) }
}

/// What follows kind and version.
struct Head<'a> {
    model: u64,
    length: u64,
    checksum: u64,
    body: &'a [u8],
}

impl<'a> Head<'a> {
    fn of(rest: &'a [u8]) -> Option<Self> {
        let (model, rest) = rest.split_first_chunk()?;
        let (length, rest) = rest.split_first_chunk()?;
        let (checksum, body) = rest.split_first_chunk()?;
        let [model, length, checksum] = [model, length, checksum].map(|bytes| u64::from_le_bytes(*bytes));
        Some(Self { model, length, checksum, body })
    }
}
