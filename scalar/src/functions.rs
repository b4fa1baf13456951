//! Elementary functions of which `f64` and numbers side by side have the same bits: polynomials without tables and
//! without fused multiply-adds. Their errors against libm, over the ranges given, are tests (`tests/batch_functions.rs`).
//!
//! Reductions and coefficients are the classical ones: Cody and Waite 1980 for the constants in parts; Taylor's series
//! where they suffice over the reduced range; for the arc sine and the logarithm the minimax coefficients of FDLIBM
//! (Sun Microsystems 1993), for the arc tangent those of Cephes (Moshier 1989).

use super::{Mask, Plain, ROUNDING, lanes};
use std::f64::consts::{FRAC_2_PI, LOG2_E};

/// ln 2 in two parts; the first has 21 zero bits at its end, so that products with whole numbers are exact.
const LN_2: [f64; 2] = [0.693_147_180_369_123_8, 1.908_214_929_270_587_7e-10];
/// pi/2 in three parts of 33 bits.
const FRAC_PI_2: [f64; 3] = [1.570_796_326_734_125_6, 6.077_100_506_303_966e-11, 2.022_266_248_711_166_5e-21];
/// Where the parts of pi/2 suffice; beyond it libm is called for each number.
const LARGE_ANGLE: f64 = 1e6;

/// Horner's scheme, highest power first.
#[inline(always)]
fn horner<R: Plain, const N: usize>(x: R, coefficients: [f64; N]) -> R {
    let mut sum = R::from(coefficients[0]);
    for coefficient in coefficients.into_iter().skip(1) {
        sum = sum * x + coefficient;
    }
    sum
}

/// The sum of c_i x^i in pairs (Estrin's scheme): half the chain of dependent operations.
#[inline(always)]
fn pairs<R: Plain, const N: usize>(x: R, coefficients: [[f64; 2]; N]) -> R {
    let squared = x * x;
    let mut sum = x * coefficients[0][0] + coefficients[0][1];
    for [odd, even] in coefficients.into_iter().skip(1) {
        sum = sum * squared + (x * odd + even);
    }
    sum
}

/// e^x; relative error under 3e-16 for -708 <= x <= 709. Below it stays at e^-708, above 710 it is infinite.
#[inline(always)]
pub fn exp<R: Plain>(x: R) -> R {
    let x = x.larger(R::from(-708.0)).smaller(R::from(710.0));
    let shifted = x * LOG2_E + ROUNDING;
    let whole = shifted - ROUNDING;
    let rest = (x - whole * LN_2[0]) - whole * LN_2[1];
    // 1/k!, |rest| <= ln(2)/2: the first term left out is 7e-18.
    let series = pairs(
        rest,
        [
            [1.605_904_383_682_161_3e-10, 2.087_675_698_786_81e-9],
            [2.505_210_838_544_172e-8, 2.755_731_922_398_589_3e-7],
            [2.755_731_922_398_589e-6, 2.480_158_730_158_73e-5],
            [1.984_126_984_126_984e-4, 1.388_888_888_888_889e-3],
            [8.333_333_333_333_333e-3, 4.166_666_666_666_666_4e-2],
            [1.666_666_666_666_666_6e-1, 0.5],
        ],
    );
    (rest * rest * series + rest + 1.0) * shifted.power_of_two()
}

/// Sine and cosine; absolute error under 2e-16 for |x| <= 1e6, libm's beyond.
#[inline(always)]
pub fn sin_cos<R: Plain>(x: R) -> (R, R) {
    let shifted = x * FRAC_2_PI + ROUNDING;
    let quarter = shifted - ROUNDING;
    let r = ((x - quarter * FRAC_PI_2[0]) - quarter * FRAC_PI_2[1]) - quarter * FRAC_PI_2[2];
    let z = r * r;
    // Taylor's series over |r| <= pi/4, the last terms adjusted for the range (FDLIBM's __kernel_sin and __kernel_cos).
    let sin = r + r
        * z
        * pairs(
            z,
            [
                [1.589_690_995_211_55e-10, -2.505_076_025_340_686_3e-8],
                [2.755_731_370_707_007e-6, -1.984_126_982_985_795e-4],
                [8.333_333_333_322_49e-3, -1.666_666_666_666_663_2e-1],
            ],
        );
    let quartic = z
        * z
        * pairs(
            z,
            [
                [-1.135_964_755_778_819_5e-11, 2.087_572_321_298_175e-9],
                [-2.755_731_435_139_066_3e-7, 2.480_158_728_947_673e-5],
                [-1.388_888_888_887_411e-3, 4.166_666_666_666_66e-2],
            ],
        );
    let half = z * 0.5;
    let one = R::from(1.0) - half;
    let cos = one + (((R::from(1.0) - one) - half) + quartic);
    let (odd, second) = (shifted.bit(0), shifted.bit(1));
    let sine = R::select(odd, cos, sin).negative_where(second);
    let cosine = R::select(odd, sin, cos).negative_where((odd & !second) | (!odd & second));
    let fits = x.abs().less_or_same(R::from(LARGE_ANGLE));
    if fits.all() {
        return (sine, cosine);
    }
    (R::select(fits, sine, x.each(f64::sin)), R::select(fits, cosine, x.each(f64::cos)))
}

/// Natural logarithm of a positive normal number; relative error under 3e-16 (absolute near 1: 1e-16).
#[inline(always)]
pub fn ln<R: Plain>(x: R) -> R {
    let (m, k) = x.split();
    let f = m - 1.0;
    let s = f / (f + 2.0);
    let z = s * s;
    let series = horner(
        z,
        [
            1.479_819_860_511_658_6e-1,
            1.531_383_769_920_937_3e-1,
            1.818_357_216_161_805e-1,
            2.222_219_843_214_978_4e-1,
            2.857_142_874_366_239e-1,
            3.999_999_999_940_942e-1,
            6.666_666_666_666_735e-1,
        ],
    ) * z;
    let half = f * f * 0.5;
    k * LN_2[0] - ((half - (s * (half + series) + k * LN_2[1])) - f)
}

/// x^n for x >= 0 and a finite result: exp(n ln x), `x` itself for n = 1, and 0 below the smallest normal number.
/// Relative error under 4e-16 (1 + |n ln x|).
#[inline(always)]
pub fn power<R: Plain>(x: R, exponent: R) -> R {
    // The thesis's soil has n = 1, where the power takes longer than the rest of a node.
    let plain = exponent.same(R::from(1.0));
    if plain.all() {
        return x;
    }
    let raised = exp(exponent * ln(x));
    let raised = R::select(x.less(R::from(f64::MIN_POSITIVE)), R::from(0.0), raised);
    R::select(plain, x, raised)
}

/// Arc tangent; relative error under 4e-16.
#[lanes]
pub fn atan<R: Plain>(x: R) -> R {
    let size = x.abs();
    // tan(pi/8) and tan(3 pi/8): nearer to zero, to pi/4, to pi/2.
    let middle = size.over(0.414_213_562_373_095_05);
    let steep = size.over(2.414_213_562_373_095);
    let above = R::select(steep, R::from(-1.0), R::select(middle, size - 1.0, size));
    let below = R::select(steep, size, R::select(middle, size + 1.0, R::from(1.0)));
    let t = above / below;
    let z = t * t;
    let numerator = horner(
        z,
        [
            -8.750_608_600_031_904e-1,
            -1.615_753_718_733_365e1,
            -7.500_855_792_314_705e1,
            -1.228_866_684_490_136_2e2,
            -6.485_021_904_942_025e1,
        ],
    );
    let denominator = horner(
        z,
        [
            1.0,
            2.485_846_490_142_306_3e1,
            1.650_270_098_316_988_6e2,
            4.328_810_604_912_903e2,
            4.853_903_996_359_137e2,
            1.945_506_571_482_614e2,
        ],
    );
    let zero = R::from(0.0);
    let (quarter, rest) = (std::f64::consts::FRAC_PI_4, 3.061_616_997_868_383e-17);
    let whole = R::select(steep, R::from(2.0 * quarter), R::select(middle, R::from(quarter), zero));
    let correction = R::select(steep, R::from(2.0 * rest), R::select(middle, R::from(rest), zero));
    let angle = whole + ((t * z * (numerator / denominator) + correction) + t);
    angle.negative_where(x.bit(63))
}

/// Arc cosine; absolute error under 5e-16, relative error under 5e-16 for x >= 0.5; NaN outside -1..1.
#[lanes]
pub fn acos<R: Plain>(x: R) -> R {
    let size = x.abs();
    let inner = size.less(R::from(0.5));
    let z = R::select(inner, x * x, (R::from(1.0) - size) * 0.5);
    let above = horner(
        z,
        [
            3.479_331_075_960_212e-5,
            7.915_349_942_898_145e-4,
            -4.005_553_450_067_941e-2,
            2.012_125_321_348_629_3e-1,
            -3.255_658_186_224_009e-1,
            1.666_666_666_666_666_6e-1,
        ],
    ) * z;
    let below = horner(
        z,
        [7.703_815_055_590_194e-2, -6.882_839_716_054_533e-1, 2.020_945_760_233_505_7, -2.403_394_911_734_414, 1.0],
    );
    let ratio = above / below;
    let half_pi = [std::f64::consts::FRAC_PI_2, 6.123_233_995_736_766e-17];
    // asin(x) = x + x ratio near 0; asin(root) from the half angle elsewhere.
    let middle = R::from(half_pi[0]) - (x - (R::from(half_pi[1]) - x * ratio));
    let root = z.sqrt();
    let half = root + root * ratio;
    let outer =
        R::select(x.less(R::from(0.0)), R::from(2.0 * half_pi[0]) - (half * 2.0 - 2.0 * half_pi[1]), half * 2.0);
    R::select(inner, middle, outer)
}
