//! Numbers as bytes.

use super::SnapshotError;

/// Where a state is written.
#[derive(Debug, Default)]
pub struct Writer(Vec<u8>);

impl Writer {
    /// Writes one number.
    pub fn number(&mut self, value: u64) {
        self.0.extend(value.to_le_bytes());
    }

    /// Writes a floating point number, bit for bit.
    pub fn real(&mut self, value: f64) {
        self.number(value.to_bits());
    }

    /// Writes bytes with their number.
    pub fn bytes(&mut self, bytes: &[u8]) {
        self.number(bytes.len() as u64);
        self.0.extend(bytes);
    }

    /// Everything that was written.
    #[must_use]
    pub fn finish(self) -> Vec<u8> {
        self.0
    }
}

/// Where a state is read from.
#[derive(Debug)]
pub struct Reader<'a>(&'a [u8]);

impl<'a> Reader<'a> {
    /// Reads `bytes` from their start.
    #[must_use]
    pub fn new(bytes: &'a [u8]) -> Self {
        Self(bytes)
    }

    /// Reads one number.
    ///
    /// # Errors
    /// [`SnapshotError::Ends`].
    pub fn number(&mut self) -> Result<u64, SnapshotError> {
        let (number, rest) =
            self.0.split_first_chunk().ok_or_else(|| SnapshotError::Ends { missing: 8 - self.0.len() })?;
        self.0 = rest;
        Ok(u64::from_le_bytes(*number))
    }

    /// Reads a floating point number.
    ///
    /// # Errors
    /// [`SnapshotError::Ends`].
    pub fn real(&mut self) -> Result<f64, SnapshotError> {
        self.number().map(f64::from_bits)
    }

    /// Reads bytes that were written with their number.
    ///
    /// # Errors
    /// [`SnapshotError::Ends`].
    pub fn bytes(&mut self) -> Result<&'a [u8], SnapshotError> {
        let length = usize::try_from(self.number()?).unwrap_or(usize::MAX);
        let (bytes, rest) =
            self.0.split_at_checked(length).ok_or_else(|| SnapshotError::Ends { missing: length - self.0.len() })?;
        self.0 = rest;
        Ok(bytes)
    }

    /// Reads the length of a list, which has to be `expected`.
    ///
    /// # Errors
    /// [`SnapshotError::Length`].
    pub fn length(&mut self, what: &'static str, expected: usize) -> Result<(), SnapshotError> {
        let got = self.number()?;
        if got == expected as u64 { Ok(()) } else { Err(SnapshotError::Length { what, got, expected }) }
    }

    /// Makes sure that nothing is left.
    ///
    /// # Errors
    /// [`SnapshotError::Longer`].
    pub fn end(&self) -> Result<(), SnapshotError> {
        if self.0.is_empty() { Ok(()) } else { Err(SnapshotError::Longer { rest: self.0.len() }) }
    }
}
