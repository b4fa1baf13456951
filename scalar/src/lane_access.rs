//! One of several rovers in the lanes, in and out.

use crate::{Arch, Lanes, Plain};

/// A part of eight rovers in SIMD lanes, and the same part of one of them. The derive of the same name implements it for a struct
/// over a scalar.
pub trait LaneAccess<One> {
    /// Puts one rover's part into lane `k`.
    fn put_in(&mut self, k: usize, one: &One);

    /// Takes the part in lane `k` out.
    fn take_out(&self, k: usize, one: &mut One);
}

impl<A: Arch> LaneAccess<f64> for Lanes<A> {
    #[inline]
    fn put_in(&mut self, k: usize, one: &f64) {
        self.put(k, *one);
    }

    #[inline]
    fn take_out(&self, k: usize, one: &mut f64) {
        *one = self.lane(k);
    }
}

impl<One, T: LaneAccess<One>> LaneAccess<Vec<One>> for Vec<T> {
    fn put_in(&mut self, k: usize, one: &Vec<One>) {
        self.iter_mut().zip(one).for_each(|(part, one)| part.put_in(k, one));
    }

    fn take_out(&self, k: usize, one: &mut Vec<One>) {
        self.iter().zip(one).for_each(|(part, one)| part.take_out(k, one));
    }
}

impl<One, T: LaneAccess<One>, const N: usize> LaneAccess<[One; N]> for [T; N] {
    fn put_in(&mut self, k: usize, one: &[One; N]) {
        self.iter_mut().zip(one).for_each(|(part, one)| part.put_in(k, one));
    }

    fn take_out(&self, k: usize, one: &mut [One; N]) {
        self.iter().zip(one).for_each(|(part, one)| part.take_out(k, one));
    }
}
