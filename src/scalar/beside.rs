//! One of several rovers side by side, in and out.

#[cfg(feature = "batch")]
pub(crate) use side_by_side::Beside;

#[cfg(feature = "batch")]
mod side_by_side {
    use crate::scalar::{Arch, Lanes, Plain};

    /// A part of several rovers side by side, and the same part of one of them.
    pub(crate) trait Beside<One> {
        /// Puts one in as number `k`.
        fn put_in(&mut self, k: usize, one: &One);

        /// Takes number `k` out.
        fn take_out(&self, k: usize, one: &mut One);
    }

    impl<A: Arch> Beside<f64> for Lanes<A> {
        #[inline]
        fn put_in(&mut self, k: usize, one: &f64) {
            self.put(k, *one);
        }

        #[inline]
        fn take_out(&self, k: usize, one: &mut f64) {
            *one = self.lane(k);
        }
    }

    impl<One, T: Beside<One>> Beside<Vec<One>> for Vec<T> {
        fn put_in(&mut self, k: usize, one: &Vec<One>) {
            self.iter_mut().zip(one).for_each(|(part, one)| part.put_in(k, one));
        }

        fn take_out(&self, k: usize, one: &mut Vec<One>) {
            self.iter().zip(one).for_each(|(part, one)| part.take_out(k, one));
        }
    }

    impl<One, T: Beside<One>, const N: usize> Beside<[One; N]> for [T; N] {
        fn put_in(&mut self, k: usize, one: &[One; N]) {
            self.iter_mut().zip(one).for_each(|(part, one)| part.put_in(k, one));
        }

        fn take_out(&self, k: usize, one: &mut [One; N]) {
            self.iter().zip(one).for_each(|(part, one)| part.take_out(k, one));
        }
    }
}

/// Lists the fields of a struct that one rover of several has for itself, and then those that need not be carried over.
/// Every field has to be in one of both lists, or it does not compile.
#[cfg(feature = "batch")]
macro_rules! beside {
    ($part:ident { $($field:ident),* $(,)? } $({ $($other:ident),* $(,)? })?) => {
        impl<A: $crate::scalar::Arch> $crate::scalar::Beside<$part<f64>> for $part<$crate::scalar::Lanes<A>> {
            fn put_in(&mut self, k: usize, one: &$part<f64>) {
                let $part { $($field,)* $($($other: _,)*)? } = self;
                $($crate::scalar::Beside::put_in($field, k, &one.$field);)*
            }

            fn take_out(&self, k: usize, one: &mut $part<f64>) {
                let $part { $($field,)* $($($other: _,)*)? } = self;
                $($crate::scalar::Beside::take_out($field, k, &mut one.$field);)*
            }
        }
    };
}
/// Without the feature `batch` no type needs the trait `Beside`, and the macro expands to nothing.
#[cfg(not(feature = "batch"))]
macro_rules! beside {
    ($($fields:tt)*) => {};
}
pub(crate) use beside;
