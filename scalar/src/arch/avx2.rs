//! AVX2.
//!
//! SAFETY of every `unsafe` here: a value of these types, and a call of `wide`, exists only where the batch has found the
//! instruction set on this processor ([`Arch::there`]); loads and stores are of whole arrays.

use super::{Arch, WIDTH};
use crate::{Mask, SPLIT_BIAS, SPLIT_FRACTION, SPLIT_MAGIC, SPLIT_ROOT, SPLIT_SHIFT, always};
use std::arch::x86_64::*;
use std::ops::{BitAnd, BitOr, Not};

/// AVX2: eight numbers in two registers.
#[derive(Clone, Copy, Debug)]
pub struct Avx2;

#[target_feature(enable = "avx2,bmi1,bmi2,lzcnt,popcnt")]
fn wide_256<T>(f: impl FnOnce() -> T) -> T {
    f()
}

/// A mask of two registers, all bits of a number set where it is yes.
#[derive(Clone, Copy, Debug)]
pub struct Halves(__m256d, __m256d);

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
        let full: [f64; WIDTH] = std::array::from_fn(|k| f64::from_bits(if f(k) { u64::MAX } else { 0 }));
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
