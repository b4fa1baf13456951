//! The same quantity of eight rovers, side by side, as one number of the physics.

use super::arch::{Arch, WIDTH};
use super::{Mask, Plain, Scalar, functions};
use num_dual::{DualNum, DualStruct, Mappable};
use num_traits::{FromPrimitive, Inv, Num, One, Signed, Zero};
use std::cmp::Ordering;
use std::fmt;
use std::iter::{Product, Sum};
use std::ops::{Add, AddAssign, Div, DivAssign, Mul, MulAssign, Neg, Rem, RemAssign, Sub, SubAssign};

/// Eight numbers on the instruction set `A`.
#[derive(Clone, Copy)]
pub struct Lanes<A: Arch>(A::V);

impl<A: Arch> Lanes<A> {
    /// The numbers.
    #[inline(always)]
    pub fn numbers(self) -> [f64; WIDTH] {
        A::store(self.0)
    }

    /// Puts number `k`.
    #[inline(always)]
    pub fn put(&mut self, k: usize, x: f64) {
        // SAFETY: `Arch` says that the numbers lie in memory as an array.
        let numbers = unsafe { &mut *std::ptr::from_mut(&mut self.0).cast::<[f64; WIDTH]>() };
        numbers[k] = x;
    }
}

impl<A: Arch> fmt::Debug for Lanes<A> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.numbers().fmt(f)
    }
}

impl<A: Arch> fmt::Display for Lanes<A> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:?}", self.numbers())
    }
}

impl<A: Arch> From<f64> for Lanes<A> {
    #[inline(always)]
    fn from(x: f64) -> Self {
        Self(A::splat(x))
    }
}

/// An operator, its assigning form, and both with a plain number.
macro_rules! operator {
    ($($operator:ident $method:ident $assign:ident $method_assign:ident $f:expr;)*) => {$(
        impl<A: Arch> $operator for Lanes<A> {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                $f(self, other)
            }
        }

        impl<A: Arch> $operator<&Self> for Lanes<A> {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: &Self) -> Self {
                $f(self, *other)
            }
        }

        impl<A: Arch> $operator<f64> for Lanes<A> {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: f64) -> Self {
                $f(self, Self::from(other))
            }
        }

        impl<A: Arch> $assign for Lanes<A> {
            #[inline(always)]
            fn $method_assign(&mut self, other: Self) {
                *self = $f(*self, other);
            }
        }

        impl<A: Arch> $assign<f64> for Lanes<A> {
            #[inline(always)]
            fn $method_assign(&mut self, other: f64) {
                *self = $f(*self, Self::from(other));
            }
        }
    )*};
}

#[inline(always)]
fn remainder<A: Arch>(a: Lanes<A>, b: Lanes<A>) -> Lanes<A> {
    <Lanes<A> as Plain>::from_lanes(|k| a.lane(k) % b.lane(k))
}

operator! {
    Add add AddAssign add_assign |a: Self, b: Self| Self(A::add(a.0, b.0));
    Sub sub SubAssign sub_assign |a: Self, b: Self| Self(A::sub(a.0, b.0));
    Mul mul MulAssign mul_assign |a: Self, b: Self| Self(A::mul(a.0, b.0));
    Div div DivAssign div_assign |a: Self, b: Self| Self(A::div(a.0, b.0));
    Rem rem RemAssign rem_assign remainder;
}

impl<A: Arch> Neg for Lanes<A> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self(A::neg(self.0))
    }
}

impl<A: Arch> PartialEq for Lanes<A> {
    #[inline(always)]
    fn eq(&self, other: &Self) -> bool {
        A::same(self.0, other.0).all()
    }
}

impl<A: Arch> PartialEq<f64> for Lanes<A> {
    #[inline(always)]
    fn eq(&self, other: &f64) -> bool {
        *self == Self::from(*other)
    }
}

/// Numbers side by side have an order only where all agree.
impl<A: Arch> PartialOrd for Lanes<A> {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        let first = self.lane(0).partial_cmp(&other.lane(0));
        (1..WIDTH).all(|k| self.lane(k).partial_cmp(&other.lane(k)) == first).then_some(first)?
    }
}

impl<A: Arch> PartialOrd<f64> for Lanes<A> {
    fn partial_cmp(&self, other: &f64) -> Option<Ordering> {
        self.partial_cmp(&Self::from(*other))
    }
}

impl<A: Arch> Zero for Lanes<A> {
    fn zero() -> Self {
        Self::from(0.0)
    }

    fn is_zero(&self) -> bool {
        *self == 0.0
    }
}

impl<A: Arch> One for Lanes<A> {
    fn one() -> Self {
        Self::from(1.0)
    }
}

impl<A: Arch> Num for Lanes<A> {
    type FromStrRadixErr = <f64 as Num>::FromStrRadixErr;

    fn from_str_radix(text: &str, radix: u32) -> Result<Self, Self::FromStrRadixErr> {
        f64::from_str_radix(text, radix).map(Self::from)
    }
}

impl<A: Arch> Signed for Lanes<A> {
    #[inline(always)]
    fn abs(&self) -> Self {
        Self(A::abs(self.0))
    }

    fn abs_sub(&self, other: &Self) -> Self {
        (*self - *other).larger(Self::from(0.0))
    }

    fn signum(&self) -> Self {
        self.each(f64::signum)
    }

    fn is_positive(&self) -> bool {
        self.numbers().iter().all(|x| x.is_sign_positive())
    }

    fn is_negative(&self) -> bool {
        self.numbers().iter().all(|x| x.is_sign_negative())
    }
}

impl<A: Arch> Inv for Lanes<A> {
    type Output = Self;
    #[inline(always)]
    fn inv(self) -> Self {
        Self::from(1.0) / self
    }
}

impl<A: Arch> Sum for Lanes<A> {
    fn sum<I: Iterator<Item = Self>>(all: I) -> Self {
        all.fold(Self::from(0.0), |sum, x| sum + x)
    }
}

impl<A: Arch> Product for Lanes<A> {
    fn product<I: Iterator<Item = Self>>(all: I) -> Self {
        all.fold(Self::from(1.0), |product, x| product * x)
    }
}

impl<A: Arch> FromPrimitive for Lanes<A> {
    fn from_i64(n: i64) -> Option<Self> {
        f64::from_i64(n).map(Self::from)
    }

    fn from_u64(n: u64) -> Option<Self> {
        f64::from_u64(n).map(Self::from)
    }

    fn from_f64(n: f64) -> Option<Self> {
        Some(Self::from(n))
    }
}

impl<A: Arch> DualStruct for Lanes<A> {
    type Real = f64;
    type Inner = Self;

    fn re(&self) -> f64 {
        self.lane(0)
    }

    fn from_inner(inner: &Self) -> Self {
        *inner
    }
}

impl<A: Arch> Mappable<Self> for Lanes<A> {
    type Output<O> = O;

    fn map_dual<M: Fn(Self) -> O, O>(self, f: M) -> O {
        f(self)
    }
}

/// Functions of libm, number by number: the bits of `f64`'s.
macro_rules! one_by_one {
    ($($f:ident),*) => {
        $(fn $f(&self) -> Self {
            self.each(|x| DualNum::$f(&x))
        })*
    };
}

impl<A: Arch> DualNum for Lanes<A> {
    type Primitive = f64;
    const NDERIV: usize = 0;
    type InnerDual = f64;

    fn from_re(re: f64) -> Self {
        Self::from(re)
    }

    fn scale(self, factor: &f64) -> Self {
        self * *factor
    }

    #[inline(always)]
    fn recip(&self) -> Self {
        Self::from(1.0) / *self
    }

    #[inline(always)]
    fn sqrt(&self) -> Self {
        Self(A::sqrt(self.0))
    }

    fn powi(&self, n: i32) -> Self {
        self.each(|x| x.powi(n))
    }

    fn powf(&self, n: f64) -> Self {
        self.each(|x| x.powf(n))
    }

    fn log(&self, base: f64) -> Self {
        self.each(|x| x.log(base))
    }

    fn sin_cos(&self) -> (Self, Self) {
        (self.sin(), self.cos())
    }

    fn atan2(&self, other: Self) -> Self {
        <Self as Plain>::from_lanes(|k| self.lane(k).atan2(other.lane(k)))
    }

    one_by_one!(
        cbrt, exp, exp2, exp_m1, ln, log2, log10, ln_1p, sin, cos, tan, asin, acos, atan, sinh, cosh, tanh, asinh,
        acosh, atanh, sph_j0, sph_j1, sph_j2
    );
}

impl<A: Arch> Scalar for Lanes<A> {
    type Mask = A::M;
    type Plain = Self;
    type Part = f64;

    fn parts() -> usize {
        WIDTH
    }

    fn part(self, k: usize) -> f64 {
        self.lane(k)
    }

    fn with_part(mut self, k: usize, part: f64) -> Self {
        self.put(k, part);
        self
    }

    #[inline(always)]
    fn plain(self) -> Self {
        self
    }

    #[inline(always)]
    fn from_plain(plain: Self) -> Self {
        plain
    }

    #[inline(always)]
    fn select(mask: A::M, yes: Self, no: Self) -> Self {
        Self(A::select(mask, yes.0, no.0))
    }

    #[inline(always)]
    fn power(self, exponent: Self) -> Self {
        functions::power(self, exponent)
    }

    #[inline(always)]
    fn exponential(self) -> Self {
        functions::exp(self)
    }

    #[inline(always)]
    fn sine_cosine(self) -> (Self, Self) {
        functions::sin_cos(self)
    }

    #[inline(always)]
    fn arc_tangent(self) -> Self {
        functions::atan(self)
    }

    #[inline(always)]
    fn arc_cosine(self) -> Self {
        functions::acos(self)
    }

    #[inline(always)]
    fn is_exactly(self, x: f64) -> bool {
        self == x
    }

    #[inline(always)]
    fn all_finite(self) -> bool {
        self.abs().less(Self::from(f64::INFINITY)).all()
    }

    #[inline(always)]
    fn wide<T>(f: impl FnOnce() -> T) -> T {
        A::wide(f)
    }
}

impl<A: Arch> Plain for Lanes<A> {
    const LANES: usize = WIDTH;

    #[inline(always)]
    fn lane(self, k: usize) -> f64 {
        // SAFETY: `Arch` says that the numbers lie in memory as an array.
        let numbers = unsafe { &*std::ptr::from_ref(&self.0).cast::<[f64; WIDTH]>() };
        numbers[k]
    }

    #[inline(always)]
    fn from_lanes(f: impl FnMut(usize) -> f64) -> Self {
        Self(A::load(&std::array::from_fn(f)))
    }

    #[inline(always)]
    fn less(self, other: Self) -> A::M {
        A::less(self.0, other.0)
    }

    #[inline(always)]
    fn less_or_same(self, other: Self) -> A::M {
        A::less_or_same(self.0, other.0)
    }

    #[inline(always)]
    fn same(self, other: Self) -> A::M {
        A::same(self.0, other.0)
    }

    #[inline(always)]
    fn power_of_two(self) -> Self {
        Self(A::power_of_two(self.0))
    }

    #[inline(always)]
    fn bit(self, k: u32) -> A::M {
        A::bit(self.0, k)
    }

    #[inline(always)]
    fn split(self) -> (Self, Self) {
        let (m, k) = A::split(self.0);
        (Self(m), Self(k))
    }
}
