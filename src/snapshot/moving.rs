//! Writing and reading of moving parts.

use super::{Reader, SnapshotError, Writer};
use bekker_modeldescription::Parameters;
use nalgebra::SMatrix;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;

/// Most entries of a list that the model does not size.
const MOST: u64 = 1024;

/// A part of a run with something that moves. The derive of the same name implements it for a struct, field by field.
pub(crate) trait Moving {
    /// Writes what moves.
    fn save(&self, to: &mut Writer);

    /// Reads what moves, into a part of the same shape. After an error it is of no use any more.
    fn load(&mut self, from: &mut Reader) -> Result<(), SnapshotError>;
}

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
        if there {
            return self.get_or_insert_default().load(from);
        }
        *self = None;
        Ok(())
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
