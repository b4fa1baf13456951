//! Elementary functions of the physics beside libm's, over the ranges that they state.

use bekker::scalar::functions::{acos, atan, exp, ln, power, sin_cos};

/// Draws of each range.
const DRAWS: usize = 400_000;

/// Largest error of `f` beside `reference` over `from..to` and at its ends, as `error` measures it.
fn largest(from: f64, to: f64, error: impl Fn(f64) -> f64) -> f64 {
    // Golden ratio steps cover the range evenly and repeat nothing.
    let inside = (0..DRAWS).map(|i| from + (to - from) * (i as f64 * 0.618_033_988_749_894_9).fract());
    [from, to].into_iter().chain(inside).map(error).fold(0.0, f64::max)
}

fn relative(x: f64, reference: f64) -> f64 {
    if x == reference { 0.0 } else { ((x - reference) / reference).abs() }
}

#[test]
fn agreement_exponential() {
    for (from, to) in [(-708.0, 709.0), (-30.0, 0.0), (-1.0, 1.0), (-1e-3, 1e-3)] {
        let most = largest(from, to, |x| relative(exp(x), x.exp()));
        assert!(most < 3e-16, "{from}..{to}: {most:e}");
    }
    assert_eq!((exp(0.0), exp(720.0), exp(-1e9)), (1.0, f64::INFINITY, exp(-708.0)));
    assert!(exp(f64::NAN).is_nan() && exp(-708.0) > 0.0);
}

#[test]
fn agreement_sine_and_cosine() {
    // Near multiples of pi/2 the error is absolute.
    for (from, to) in [(-2.0, 2.0), (-1e-3, 1e-3), (-100.0, 100.0), (-1e6, 1e6), (1e6, 1e9)] {
        let most = largest(from, to, |x| {
            let (sin, cos) = sin_cos(x);
            (sin - x.sin()).abs().max((cos - x.cos()).abs())
        });
        assert!(most < 2e-16, "{from}..{to}: {most:e}");
    }
    let most = largest(1e-12, 0.7, |x| relative(sin_cos(x).0, x.sin()));
    assert!(most < 3e-16, "relative, small angles: {most:e}");
    assert_eq!(sin_cos(0.0), (0.0, 1.0));
    assert!(sin_cos(f64::NAN).0.is_nan() && sin_cos(f64::INFINITY).1.is_nan());
}

#[test]
fn agreement_logarithm_and_power() {
    for (from, to) in [(1e-12, 1e-3), (1e-3, 0.5), (2.0, 1e6), (1e-300, 1e-290)] {
        let most = largest(from, to, |x| relative(ln(x), x.ln()));
        assert!(most < 3e-16, "ln, {from}..{to}: {most:e}");
    }
    let most = largest(0.5, 2.0, |x| (ln(x) - x.ln()).abs());
    assert!(most < 1.2e-16, "ln near 1: {most:e}");
    for n in [0.3, 0.5, 0.8, 1.1, 1.3, 2.0] {
        for (from, to) in [(1e-9, 1e-3), (1e-3, 0.5)] {
            let bound = |x: f64| 4e-16 * (1.0 + (n * x.ln()).abs());
            let most = largest(from, to, |x| relative(power(x, n), x.powf(n)) / bound(x));
            assert!(most < 1.0, "n = {n}, {from}..{to}: {most} of the bound");
        }
    }
    assert_eq!((power(0.0, 0.7), power(0.3, 1.0), power(0.0, 1.0)), (0.0, 0.3, 0.0));
}

#[test]
fn agreement_arcs() {
    let most = largest(-1.0, 1.0, |x| (acos(x) - x.acos()).abs());
    assert!(most < 5e-16, "acos: {most:e}");
    // What a wheel needs: 1 - z/r for small sinkages.
    let most = largest(0.5, 1.0 - 1e-9, |x| relative(acos(x), x.acos()));
    assert!(most < 5e-16, "acos, relative: {most:e}");
    assert!(acos(1.0) == 0.0 && acos(1.1).is_nan() && acos(-1.1).is_nan());
    for (from, to) in [(-1e-6, 1e-6), (-0.5, 0.5), (-3.0, 3.0), (-1e6, 1e6)] {
        let most = largest(from, to, |x| relative(atan(x), x.atan()));
        assert!(most < 4e-16, "atan, {from}..{to}: {most:e}");
    }
    assert_eq!((atan(0.0), atan(f64::INFINITY)), (0.0, std::f64::consts::FRAC_PI_2));
}
