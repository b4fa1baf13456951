//! Eight numbers side by side on the instruction sets that a program may meet: AVX-512, AVX2, and plain arrays for all
//! others. Every operation is the one of IEEE 754, so the bits are the same on each.

use super::{Mask, SPLIT_BIAS, SPLIT_FRACTION, SPLIT_MAGIC, SPLIT_ROOT, SPLIT_SHIFT};
use std::fmt::Debug;
use std::ops::{BitAnd, BitOr, Not};

/// Numbers side by side.
pub(crate) const WIDTH: usize = 8;

/// An instruction set. A value of [`Self::V`] is made only where [`Self::there`] has said yes.
///
/// # Safety
/// [`Self::V`] lies in memory as `[f64; 8]` does.
pub(crate) unsafe trait Arch: Copy + Debug + Send + Sync + 'static {
    /// Eight numbers.
    type V: Copy + Send + Sync;
    /// Eight yes or no.
    type M: Mask + Send + Sync;

    /// Whether this processor has it.
    fn there() -> bool;
    /// Calls `f`, compiled for it.
    fn wide<T>(f: impl FnOnce() -> T) -> T;

    fn splat(x: f64) -> Self::V;
    fn load(x: &[f64; WIDTH]) -> Self::V;
    fn store(v: Self::V) -> [f64; WIDTH];
    fn add(a: Self::V, b: Self::V) -> Self::V;
    fn sub(a: Self::V, b: Self::V) -> Self::V;
    fn mul(a: Self::V, b: Self::V) -> Self::V;
    fn div(a: Self::V, b: Self::V) -> Self::V;
    fn sqrt(a: Self::V) -> Self::V;
    fn neg(a: Self::V) -> Self::V;
    fn abs(a: Self::V) -> Self::V;
    fn less(a: Self::V, b: Self::V) -> Self::M;
    fn less_or_same(a: Self::V, b: Self::V) -> Self::M;
    fn same(a: Self::V, b: Self::V) -> Self::M;
    fn select(mask: Self::M, yes: Self::V, no: Self::V) -> Self::V;
    fn power_of_two(a: Self::V) -> Self::V;
    fn bit(a: Self::V, k: u32) -> Self::M;
    fn split(a: Self::V) -> (Self::V, Self::V);
}

/// A mask of one bit a number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Bits(u8);

impl Mask for Bits {
    #[inline(always)]
    fn any(self) -> bool {
        self.0 != 0
    }

    #[inline(always)]
    fn lane(self, k: usize) -> bool {
        self.0 >> k & 1 != 0
    }

    #[inline(always)]
    fn from_lanes(mut f: impl FnMut(usize) -> bool) -> Self {
        Self((0..WIDTH).fold(0, |bits, k| bits | u8::from(f(k)) << k))
    }
}

macro_rules! bit_operators {
    ($($mask:ty),*) => {$(
        impl BitAnd for $mask {
            type Output = Self;
            #[inline(always)]
            fn bitand(self, other: Self) -> Self {
                Self(self.0 & other.0)
            }
        }

        impl BitOr for $mask {
            type Output = Self;
            #[inline(always)]
            fn bitor(self, other: Self) -> Self {
                Self(self.0 | other.0)
            }
        }

        impl Not for $mask {
            type Output = Self;
            #[inline(always)]
            fn not(self) -> Self {
                Self(!self.0)
            }
        }
    )*};
}
bit_operators!(Bits);

/// Plain arrays, which the compiler puts on whatever every processor of the target has.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Arrays;

#[inline(always)]
fn each<const N: usize>(f: impl FnMut(usize) -> f64) -> [f64; N] {
    std::array::from_fn(f)
}

unsafe impl Arch for Arrays {
    type V = [f64; WIDTH];
    type M = Bits;

    fn there() -> bool {
        true
    }

    #[inline(always)]
    fn wide<T>(f: impl FnOnce() -> T) -> T {
        f()
    }

    #[inline(always)]
    fn splat(x: f64) -> Self::V {
        [x; WIDTH]
    }

    #[inline(always)]
    fn load(x: &[f64; WIDTH]) -> Self::V {
        *x
    }

    #[inline(always)]
    fn store(v: Self::V) -> [f64; WIDTH] {
        v
    }

    #[inline(always)]
    fn add(a: Self::V, b: Self::V) -> Self::V {
        each(|k| a[k] + b[k])
    }

    #[inline(always)]
    fn sub(a: Self::V, b: Self::V) -> Self::V {
        each(|k| a[k] - b[k])
    }

    #[inline(always)]
    fn mul(a: Self::V, b: Self::V) -> Self::V {
        each(|k| a[k] * b[k])
    }

    #[inline(always)]
    fn div(a: Self::V, b: Self::V) -> Self::V {
        each(|k| a[k] / b[k])
    }

    #[inline(always)]
    fn sqrt(a: Self::V) -> Self::V {
        each(|k| a[k].sqrt())
    }

    #[inline(always)]
    fn neg(a: Self::V) -> Self::V {
        each(|k| -a[k])
    }

    #[inline(always)]
    fn abs(a: Self::V) -> Self::V {
        each(|k| a[k].abs())
    }

    #[inline(always)]
    fn less(a: Self::V, b: Self::V) -> Self::M {
        Bits::from_lanes(|k| a[k] < b[k])
    }

    #[inline(always)]
    fn less_or_same(a: Self::V, b: Self::V) -> Self::M {
        Bits::from_lanes(|k| a[k] <= b[k])
    }

    #[inline(always)]
    fn same(a: Self::V, b: Self::V) -> Self::M {
        Bits::from_lanes(|k| a[k] == b[k])
    }

    #[inline(always)]
    fn select(mask: Self::M, yes: Self::V, no: Self::V) -> Self::V {
        each(|k| if mask.lane(k) { yes[k] } else { no[k] })
    }

    #[inline(always)]
    fn power_of_two(a: Self::V) -> Self::V {
        each(|k| super::Plain::power_of_two(a[k]))
    }

    #[inline(always)]
    fn bit(a: Self::V, k: u32) -> Self::M {
        Bits::from_lanes(|i| super::Plain::bit(a[i], k))
    }

    #[inline(always)]
    fn split(a: Self::V) -> (Self::V, Self::V) {
        let parts = a.map(super::Plain::split);
        (parts.map(|part| part.0), parts.map(|part| part.1))
    }
}

#[cfg(target_arch = "x86_64")]
pub(crate) use x86::{Avx2, Avx512};

/// SAFETY of every `unsafe` here: a value of these types, and a call of `wide`, exists only where the batch has found the
/// instruction set on this processor ([`Arch::there`]); loads and stores are of whole arrays.
#[cfg(target_arch = "x86_64")]
mod x86 {
    use super::super::always;
    use super::*;
    use std::arch::x86_64::*;

    /// AVX-512: eight numbers in one register.
    #[derive(Clone, Copy, Debug)]
    pub(crate) struct Avx512;

    /// AVX2: eight numbers in two registers.
    #[derive(Clone, Copy, Debug)]
    pub(crate) struct Avx2;

    #[target_feature(enable = "avx512f,avx512dq,avx512vl,avx512bw,avx512cd,avx2,bmi1,bmi2,lzcnt,popcnt")]
    fn wide_512<T>(f: impl FnOnce() -> T) -> T {
        f()
    }

    #[target_feature(enable = "avx2,bmi1,bmi2,lzcnt,popcnt")]
    fn wide_256<T>(f: impl FnOnce() -> T) -> T {
        f()
    }

    unsafe impl Arch for Avx512 {
        type V = __m512d;
        type M = Bits;

        fn there() -> bool {
            Avx2::there()
                && is_x86_feature_detected!("avx512f")
                && is_x86_feature_detected!("avx512dq")
                && is_x86_feature_detected!("avx512vl")
                && is_x86_feature_detected!("avx512bw")
                && is_x86_feature_detected!("avx512cd")
        }

        #[inline(always)]
        fn wide<T>(f: impl FnOnce() -> T) -> T {
            unsafe { wide_512(f) }
        }

        #[inline(always)]
        fn splat(x: f64) -> __m512d {
            unsafe { _mm512_set1_pd(x) }
        }

        #[inline(always)]
        fn load(x: &[f64; WIDTH]) -> __m512d {
            unsafe { _mm512_loadu_pd(x.as_ptr()) }
        }

        #[inline(always)]
        fn store(v: __m512d) -> [f64; WIDTH] {
            let mut x = [0.0; WIDTH];
            unsafe { _mm512_storeu_pd(x.as_mut_ptr(), v) };
            x
        }

        #[inline(always)]
        fn add(a: __m512d, b: __m512d) -> __m512d {
            unsafe { _mm512_add_pd(a, b) }
        }

        #[inline(always)]
        fn sub(a: __m512d, b: __m512d) -> __m512d {
            unsafe { _mm512_sub_pd(a, b) }
        }

        #[inline(always)]
        fn mul(a: __m512d, b: __m512d) -> __m512d {
            unsafe { _mm512_mul_pd(a, b) }
        }

        #[inline(always)]
        fn div(a: __m512d, b: __m512d) -> __m512d {
            unsafe { _mm512_div_pd(a, b) }
        }

        #[inline(always)]
        fn sqrt(a: __m512d) -> __m512d {
            unsafe { _mm512_sqrt_pd(a) }
        }

        #[inline(always)]
        fn neg(a: __m512d) -> __m512d {
            unsafe { _mm512_xor_pd(a, _mm512_set1_pd(-0.0)) }
        }

        #[inline(always)]
        fn abs(a: __m512d) -> __m512d {
            unsafe { _mm512_abs_pd(a) }
        }

        #[inline(always)]
        fn less(a: __m512d, b: __m512d) -> Bits {
            Bits(unsafe { _mm512_cmp_pd_mask::<_CMP_LT_OQ>(a, b) })
        }

        #[inline(always)]
        fn less_or_same(a: __m512d, b: __m512d) -> Bits {
            Bits(unsafe { _mm512_cmp_pd_mask::<_CMP_LE_OQ>(a, b) })
        }

        #[inline(always)]
        fn same(a: __m512d, b: __m512d) -> Bits {
            Bits(unsafe { _mm512_cmp_pd_mask::<_CMP_EQ_OQ>(a, b) })
        }

        #[inline(always)]
        fn select(mask: Bits, yes: __m512d, no: __m512d) -> __m512d {
            unsafe { _mm512_mask_blend_pd(mask.0, no, yes) }
        }

        #[inline(always)]
        fn power_of_two(a: __m512d) -> __m512d {
            unsafe {
                let shifted = _mm512_add_epi64(_mm512_castpd_si512(a), _mm512_set1_epi64(1023));
                _mm512_castsi512_pd(_mm512_slli_epi64::<52>(shifted))
            }
        }

        #[inline(always)]
        fn bit(a: __m512d, k: u32) -> Bits {
            Bits(unsafe { _mm512_test_epi64_mask(_mm512_castpd_si512(a), _mm512_set1_epi64(1 << k)) })
        }

        #[inline(always)]
        fn split(a: __m512d) -> (__m512d, __m512d) {
            unsafe {
                let constant = |bits: u64| _mm512_set1_epi64(bits.cast_signed());
                let shifted = _mm512_add_epi64(_mm512_castpd_si512(a), constant(SPLIT_SHIFT));
                let exponent = _mm512_or_si512(_mm512_srli_epi64::<52>(shifted), constant(SPLIT_MAGIC));
                let fraction = _mm512_and_si512(shifted, constant(SPLIT_FRACTION));
                (
                    _mm512_castsi512_pd(_mm512_add_epi64(fraction, constant(SPLIT_ROOT))),
                    _mm512_sub_pd(_mm512_castsi512_pd(exponent), _mm512_set1_pd(SPLIT_BIAS)),
                )
            }
        }
    }

    /// A mask of two registers, all bits of a number set where it is yes.
    #[derive(Clone, Copy, Debug)]
    pub(crate) struct Halves(__m256d, __m256d);

    impl Halves {
        #[inline(always)]
        fn bits(self) -> u8 {
            unsafe { (_mm256_movemask_pd(self.0) | _mm256_movemask_pd(self.1) << 4) as u8 }
        }
    }

    impl Mask for Halves {
        #[inline(always)]
        fn any(self) -> bool {
            self.bits() != 0
        }

        #[inline(always)]
        fn all(self) -> bool {
            self.bits() == 0xff
        }

        #[inline(always)]
        fn lane(self, k: usize) -> bool {
            self.bits() >> k & 1 != 0
        }

        #[inline(always)]
        fn from_lanes(mut f: impl FnMut(usize) -> bool) -> Self {
            let full: [f64; WIDTH] = each(|k| f64::from_bits(if f(k) { u64::MAX } else { 0 }));
            let [a, b] = Avx2::load(&full);
            Self(a, b)
        }
    }

    impl BitAnd for Halves {
        type Output = Self;
        #[inline(always)]
        fn bitand(self, other: Self) -> Self {
            unsafe { Self(_mm256_and_pd(self.0, other.0), _mm256_and_pd(self.1, other.1)) }
        }
    }

    impl BitOr for Halves {
        type Output = Self;
        #[inline(always)]
        fn bitor(self, other: Self) -> Self {
            unsafe { Self(_mm256_or_pd(self.0, other.0), _mm256_or_pd(self.1, other.1)) }
        }
    }

    impl Not for Halves {
        type Output = Self;
        #[inline(always)]
        fn not(self) -> Self {
            let ones = unsafe { _mm256_castsi256_pd(_mm256_set1_epi64x(-1)) };
            unsafe { Self(_mm256_xor_pd(self.0, ones), _mm256_xor_pd(self.1, ones)) }
        }
    }

    /// Applies an intrinsic to both halves.
    macro_rules! halves {
        ($f:ident($a:ident $(, $b:ident)?)) => {
            unsafe { [$f($a[0] $(, $b[0])?), $f($a[1] $(, $b[1])?)] }
        };
    }

    unsafe impl Arch for Avx2 {
        type V = [__m256d; 2];
        type M = Halves;

        fn there() -> bool {
            is_x86_feature_detected!("avx2")
                && is_x86_feature_detected!("bmi1")
                && is_x86_feature_detected!("bmi2")
                && is_x86_feature_detected!("lzcnt")
                && is_x86_feature_detected!("popcnt")
        }

        #[inline(always)]
        fn wide<T>(f: impl FnOnce() -> T) -> T {
            unsafe { wide_256(f) }
        }

        #[inline(always)]
        fn splat(x: f64) -> Self::V {
            unsafe { [_mm256_set1_pd(x); 2] }
        }

        #[inline(always)]
        fn load(x: &[f64; WIDTH]) -> Self::V {
            unsafe { [_mm256_loadu_pd(x.as_ptr()), _mm256_loadu_pd(x.as_ptr().add(4))] }
        }

        #[inline(always)]
        fn store(v: Self::V) -> [f64; WIDTH] {
            let mut x = [0.0; WIDTH];
            unsafe {
                _mm256_storeu_pd(x.as_mut_ptr(), v[0]);
                _mm256_storeu_pd(x.as_mut_ptr().add(4), v[1]);
            }
            x
        }

        #[inline(always)]
        fn add(a: Self::V, b: Self::V) -> Self::V {
            halves!(_mm256_add_pd(a, b))
        }

        #[inline(always)]
        fn sub(a: Self::V, b: Self::V) -> Self::V {
            halves!(_mm256_sub_pd(a, b))
        }

        #[inline(always)]
        fn mul(a: Self::V, b: Self::V) -> Self::V {
            halves!(_mm256_mul_pd(a, b))
        }

        #[inline(always)]
        fn div(a: Self::V, b: Self::V) -> Self::V {
            halves!(_mm256_div_pd(a, b))
        }

        #[inline(always)]
        fn sqrt(a: Self::V) -> Self::V {
            halves!(_mm256_sqrt_pd(a))
        }

        #[inline(always)]
        fn neg(a: Self::V) -> Self::V {
            let sign = Self::splat(-0.0);
            halves!(_mm256_xor_pd(a, sign))
        }

        #[inline(always)]
        fn abs(a: Self::V) -> Self::V {
            let sign = Self::splat(-0.0);
            halves!(_mm256_andnot_pd(sign, a))
        }

        #[inline(always)]
        fn less(a: Self::V, b: Self::V) -> Halves {
            unsafe { Halves(_mm256_cmp_pd::<_CMP_LT_OQ>(a[0], b[0]), _mm256_cmp_pd::<_CMP_LT_OQ>(a[1], b[1])) }
        }

        #[inline(always)]
        fn less_or_same(a: Self::V, b: Self::V) -> Halves {
            unsafe { Halves(_mm256_cmp_pd::<_CMP_LE_OQ>(a[0], b[0]), _mm256_cmp_pd::<_CMP_LE_OQ>(a[1], b[1])) }
        }

        #[inline(always)]
        fn same(a: Self::V, b: Self::V) -> Halves {
            unsafe { Halves(_mm256_cmp_pd::<_CMP_EQ_OQ>(a[0], b[0]), _mm256_cmp_pd::<_CMP_EQ_OQ>(a[1], b[1])) }
        }

        #[inline(always)]
        fn select(mask: Halves, yes: Self::V, no: Self::V) -> Self::V {
            unsafe { [_mm256_blendv_pd(no[0], yes[0], mask.0), _mm256_blendv_pd(no[1], yes[1], mask.1)] }
        }

        #[inline(always)]
        fn power_of_two(a: Self::V) -> Self::V {
            let one = always(
                #[inline(always)]
                |half: __m256d| unsafe {
                    let shifted = _mm256_add_epi64(_mm256_castpd_si256(half), _mm256_set1_epi64x(1023));
                    _mm256_castsi256_pd(_mm256_slli_epi64::<52>(shifted))
                },
            );
            [one(a[0]), one(a[1])]
        }

        #[inline(always)]
        fn bit(a: Self::V, k: u32) -> Halves {
            let test = always(
                #[inline(always)]
                |half: __m256d| unsafe {
                    let bit = _mm256_set1_epi64x(1 << k);
                    let set = _mm256_and_si256(_mm256_castpd_si256(half), bit);
                    _mm256_castsi256_pd(_mm256_cmpeq_epi64(set, bit))
                },
            );
            Halves(test(a[0]), test(a[1]))
        }

        #[inline(always)]
        fn split(a: Self::V) -> (Self::V, Self::V) {
            let one = always(
                #[inline(always)]
                |half: __m256d| unsafe {
                    let shifted =
                        _mm256_add_epi64(_mm256_castpd_si256(half), _mm256_set1_epi64x(SPLIT_SHIFT.cast_signed()));
                    let magic = _mm256_set1_epi64x(SPLIT_MAGIC.cast_signed());
                    let exponent = _mm256_or_si256(_mm256_srli_epi64::<52>(shifted), magic);
                    let fraction = _mm256_and_si256(shifted, _mm256_set1_epi64x(SPLIT_FRACTION.cast_signed()));
                    (
                        _mm256_castsi256_pd(_mm256_add_epi64(fraction, _mm256_set1_epi64x(SPLIT_ROOT.cast_signed()))),
                        _mm256_sub_pd(_mm256_castsi256_pd(exponent), _mm256_set1_pd(SPLIT_BIAS)),
                    )
                },
            );
            let [(m0, k0), (m1, k1)] = [one(a[0]), one(a[1])];
            ([m0, m1], [k0, k1])
        }
    }
}
