//! Writing and reading of moving parts.

use super::SnapshotError;
use bekker_modeldescription::Parameters;
use nalgebra::SMatrix;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;

/// Most entries of a list that the model does not size.
const MOST: u64 = 1024;

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

/// A part of a run with something that moves.
pub(crate) trait Moving {
    /// Writes what moves.
    fn save(&self, to: &mut Writer);

    /// Reads what moves, into a part of the same shape. After an error it is of no use any more.
    fn load(&mut self, from: &mut Reader) -> Result<(), SnapshotError>;
}

/// Lists the moving fields of a struct, in the order in which they are written.
macro_rules! moving {
    ($part:ty { $($field:ident),* $(,)? }) => {
        impl $crate::snapshot::Moving for $part {
            fn save(&self, to: &mut $crate::snapshot::Writer) {
                $(self.$field.save(to);)*
            }

            fn load(&mut self, from: &mut $crate::snapshot::Reader) -> Result<(), $crate::snapshot::SnapshotError> {
                $(self.$field.load(from)?;)*
                Ok(())
            }
        }
    };
}
pub(crate) use moving;

/// Lists the values of an enumeration with the codes by which they are written.
macro_rules! moving_code {
    ($part:ty, $what:literal { $($value:pat => $code:literal => $made:expr),* $(,)? }) => {
        impl $crate::snapshot::Moving for $part {
            fn save(&self, to: &mut $crate::snapshot::Writer) {
                to.number(match self { $($value => $code),* });
            }

            fn load(&mut self, from: &mut $crate::snapshot::Reader) -> Result<(), $crate::snapshot::SnapshotError> {
                *self = match from.number()? {
                    $($code => $made,)*
                    code => return Err($crate::snapshot::SnapshotError::Code { what: $what, code }),
                };
                Ok(())
            }
        }
    };
}
pub(crate) use moving_code;

impl Moving for f64 {
    fn save(&self, to: &mut Writer) {
        to.real(*self);
    }

    fn load(&mut self, from: &mut Reader) -> Result<(), SnapshotError> {
        *self = from.real()?;
        Ok(())
    }
}

impl Moving for u64 {
    fn save(&self, to: &mut Writer) {
        to.number(*self);
    }

    fn load(&mut self, from: &mut Reader) -> Result<(), SnapshotError> {
        *self = from.number()?;
        Ok(())
    }
}

impl Moving for i64 {
    fn save(&self, to: &mut Writer) {
        to.number(self.cast_unsigned());
    }

    fn load(&mut self, from: &mut Reader) -> Result<(), SnapshotError> {
        *self = from.number()?.cast_signed();
        Ok(())
    }
}

/// Numbers that are written as 64 bit ones.
macro_rules! smaller_number {
    ($($number:ty => $what:literal),*) => {
        $(impl Moving for $number {
            fn save(&self, to: &mut Writer) {
                to.number(*self as u64);
            }

            fn load(&mut self, from: &mut Reader) -> Result<(), SnapshotError> {
                let code = from.number()?;
                *self = Self::try_from(code).map_err(|_| SnapshotError::Code { what: $what, code })?;
                Ok(())
            }
        })*
    };
}
smaller_number!(u32 => "a count", usize => "a count");

moving_code!(bool, "yes or no" { false => 0 => false, true => 1 => true });

impl<T: Moving + Default> Moving for Option<T> {
    fn save(&self, to: &mut Writer) {
        self.is_some().save(to);
        if let Some(value) = self {
            value.save(to);
        }
    }

    fn load(&mut self, from: &mut Reader) -> Result<(), SnapshotError> {
        let mut there = false;
        there.load(from)?;
        if there { self.get_or_insert_default().load(from) } else { Ok(*self = None) }
    }
}

impl<A: Moving, B: Moving> Moving for (A, B) {
    fn save(&self, to: &mut Writer) {
        self.0.save(to);
        self.1.save(to);
    }

    fn load(&mut self, from: &mut Reader) -> Result<(), SnapshotError> {
        self.0.load(from)?;
        self.1.load(from)
    }
}

impl<T: Moving, const N: usize> Moving for [T; N] {
    fn save(&self, to: &mut Writer) {
        self.iter().for_each(|entry| entry.save(to));
    }

    fn load(&mut self, from: &mut Reader) -> Result<(), SnapshotError> {
        self.iter_mut().try_for_each(|entry| entry.load(from))
    }
}

impl<const R: usize, const C: usize> Moving for SMatrix<f64, R, C> {
    fn save(&self, to: &mut Writer) {
        self.iter().for_each(|entry| entry.save(to));
    }

    fn load(&mut self, from: &mut Reader) -> Result<(), SnapshotError> {
        self.iter_mut().try_for_each(|entry| entry.load(from))
    }
}

/// A list whose length the model decides.
impl<T: Moving> Moving for Vec<T> {
    fn save(&self, to: &mut Writer) {
        to.number(self.len() as u64);
        self.iter().for_each(|entry| entry.save(to));
    }

    fn load(&mut self, from: &mut Reader) -> Result<(), SnapshotError> {
        from.length("entries of a list", self.len())?;
        self.iter_mut().try_for_each(|entry| entry.load(from))
    }
}

/// Reads a list that grows on the way, up to a length that no rover reaches.
pub(crate) fn load_grown<T: Moving + Default>(list: &mut Vec<T>, from: &mut Reader) -> Result<(), SnapshotError> {
    let got = from.number()?;
    if got > MOST {
        return Err(SnapshotError::Length { what: "entries of a list", got, expected: list.len() });
    }
    list.clear();
    for _ in 0..got {
        let mut entry = T::default();
        entry.load(from)?;
        list.push(entry);
    }
    Ok(())
}

/// A new value, read.
pub(crate) fn loaded<T: Moving + Default>(from: &mut Reader) -> Result<T, SnapshotError> {
    let mut value = T::default();
    value.load(from)?;
    Ok(value)
}

/// Writes all numbers of a group of signals or inputs.
pub(crate) fn save_all(group: &impl Parameters<f64>, to: &mut Writer) {
    group.values(&mut |value| value.save(to));
}

/// Reads all numbers of a group of signals or inputs.
pub(crate) fn load_all(group: &mut impl Parameters<f64>, from: &mut Reader) -> Result<(), SnapshotError> {
    let mut read = Ok(());
    group.visit("", &mut |_, place| {
        if read.is_ok() {
            read = place.load(from);
        }
    });
    read
}

/// A random stream: its seed, its number and its place in words.
impl Moving for ChaCha8Rng {
    fn save(&self, to: &mut Writer) {
        to.bytes(&self.get_seed());
        to.number(self.get_stream());
        let place = self.get_word_pos();
        to.number(place as u64);
        to.number((place >> 64) as u64);
    }

    fn load(&mut self, from: &mut Reader) -> Result<(), SnapshotError> {
        let seed = from.bytes()?;
        let got = seed.len() as u64;
        let seed = seed.try_into().map_err(|_| SnapshotError::Length { what: "bytes of a seed", got, expected: 32 })?;
        *self = Self::from_seed(seed);
        self.set_stream(from.number()?);
        let (low, high) = (from.number()?, from.number()?);
        self.set_word_pos(u128::from(low) | (u128::from(high) << 64));
        Ok(())
    }
}
