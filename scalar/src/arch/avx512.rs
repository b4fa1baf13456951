//! AVX-512.
//!
//! SAFETY of every `unsafe` here: a value of these types, and a call of `wide`, exists only where the batch has found the
//! instruction set on this processor ([`Arch::there`]); loads and stores are of whole arrays.

use super::{Arch, Avx2, Bits, WIDTH};
use crate::{SPLIT_BIAS, SPLIT_FRACTION, SPLIT_MAGIC, SPLIT_ROOT, SPLIT_SHIFT};
use std::arch::x86_64::*;

/// AVX-512: eight numbers in one register.
#[derive(Clone, Copy, Debug)]
pub struct Avx512;

#[target_feature(enable = "avx512f,avx512dq,avx512vl,avx512bw,avx512cd,avx2,bmi1,bmi2,lzcnt,popcnt")]
fn wide_512<T>(f: impl FnOnce() -> T) -> T {
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
