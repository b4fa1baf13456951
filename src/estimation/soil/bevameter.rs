//! The classical reduction of bevameter tests: plates pressed in, an annulus sheared (Bekker 1969; Wong 1980, J.
//! Terramechanics 17(1): weighted least squares).

use super::super::EstimationError;

/// Share of a record's end over which the shear stress counts as developed.
const TAIL: f64 = 0.2;

/// Passes over plateau and shear modulus, each of which the other corrects.
const PASSES: usize = 20;

/// A plate pressed into the soil.
#[derive(Clone, Debug, PartialEq)]
pub struct PlateTest {
    /// Smaller dimension b of the plate, m.
    pub width: f64,
    /// Sinkage (m) and pressure (Pa), point by point.
    pub points: Vec<[f64; 2]>,
}

/// The curve p = (k_c/b + k_phi) z^n.
#[derive(Clone, Debug, PartialEq)]
pub struct PressureSinkage {
    /// Exponent n.
    pub exponent: f64,
    /// Cohesive modulus k_c, N/m^(n+1).
    pub k_c: f64,
    /// Frictional modulus k_phi, N/m^(n+2).
    pub k_phi: f64,
}

/// An annulus sheared under one pressure.
#[derive(Clone, Debug, PartialEq)]
pub struct AnnulusTest {
    /// Normal pressure, Pa.
    pub pressure: f64,
    /// Shear displacement (m) and shear stress (Pa), point by point.
    pub points: Vec<[f64; 2]>,
}

/// What one annulus test gives.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShearStrength {
    /// Normal pressure, Pa.
    pub pressure: f64,
    /// Shear stress when developed, Pa.
    pub strength: f64,
    /// Shear modulus K, m.
    pub shear_modulus: f64,
    /// K by the classical least squares in logarithms (Wong 1980), which noise near the plateau lifts, m.
    pub classical_shear_modulus: f64,
}

/// Coulomb's line through the strengths, and their mean shear modulus.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StrengthLine {
    /// Cohesion c, Pa.
    pub cohesion: f64,
    /// Friction angle phi, rad.
    pub friction_angle: f64,
    /// Shear modulus K, m.
    pub shear_modulus: f64,
    /// K by the classical least squares in logarithms, m.
    pub classical_shear_modulus: f64,
}

/// n, k_c and k_phi from plates of at least two widths: each plate's n and k by least squares in ln p weighted with
/// p^2, the mean n, and the two moduli from the line of k over 1/b.
///
/// # Errors
/// [`EstimationError`] with fewer than two widths or three points of positive pressure and sinkage a plate.
pub fn pressure_sinkage(tests: &[PlateTest]) -> Result<PressureSinkage, EstimationError> {
    if tests.len() < 2 {
        return Err(EstimationError::TooFew { what: "a plate", expected: 2, found: tests.len() });
    }
    let sums = tests.iter().map(weighted_sums).collect::<Result<Vec<_>, _>>()?;
    let exponents = sums.iter().map(|s| (s.pz - s.p * s.z) / (s.zz - s.z * s.z));
    let exponent = exponents.sum::<f64>() / tests.len() as f64;
    let moduli = tests.iter().zip(&sums).map(|(test, s)| [1.0 / test.width, (s.p - exponent * s.z).exp()]);
    let [k_phi, k_c] = line(moduli).ok_or(EstimationError::Undetermined { what: "k_c and k_phi of one width" })?;
    Ok(PressureSinkage { exponent, k_c, k_phi })
}

/// Means of ln p, ln z and their products, weighted with p^2.
struct Sums {
    p: f64,
    z: f64,
    pz: f64,
    zz: f64,
}

fn weighted_sums(test: &PlateTest) -> Result<Sums, EstimationError> {
    let positive = || test.points.iter().filter(|[z, p]| *z > 0.0 && *p > 0.0);
    let found = positive().count();
    if found < 3 {
        return Err(EstimationError::TooFew { what: "a plate", expected: 3, found });
    }
    let weight: f64 = positive().map(|[_, p]| p * p).sum();
    let mean = |f: fn(f64, f64) -> f64| positive().map(|[z, p]| p * p * f(p.ln(), z.ln())).sum::<f64>() / weight;
    Ok(Sums { p: mean(|p, _| p), z: mean(|_, z| z), pz: mean(|p, z| p * z), zz: mean(|_, z| z * z) })
}

/// Developed strength and K of one annulus test. Classically the strength is that of the record's end and K follows by
/// least squares in ln(1 - tau/tau_max) weighted with (1 - tau/tau_max)^2; from there both are brought to the least
/// squares in tau itself, which noise does not bias.
///
/// # Errors
/// [`EstimationError`] with fewer than five points, or a record that never develops.
pub fn reduce_annulus(test: &AnnulusTest) -> Result<ShearStrength, EstimationError> {
    let found = test.points.len();
    if found < 5 {
        return Err(EstimationError::TooFew { what: "an annulus", expected: 5, found });
    }
    let tail = &test.points[found - (found as f64 * TAIL).ceil() as usize..];
    let plateau = |developed: &dyn Fn(f64) -> f64| {
        tail.iter().map(|[_, tau]| tau).sum::<f64>() / tail.iter().map(|[j, _]| developed(*j)).sum::<f64>()
    };
    let mut strength = plateau(&|_| 1.0);
    let mut shear_modulus = f64::NAN;
    for _ in 0..PASSES {
        let (mut above, mut below) = (0.0, 0.0);
        for [j, tau] in &test.points {
            let left = 1.0 - tau / strength;
            if left > 0.0 && *j > 0.0 {
                above += left * left * j * j;
                below -= left * left * j * left.ln();
            }
        }
        shear_modulus = above / below;
        strength = plateau(&|j| -(-j / shear_modulus).exp_m1());
    }
    let classical_shear_modulus = shear_modulus;
    for _ in 0..PASSES {
        let [ds, dk] = step_in_stress(&test.points, strength, shear_modulus);
        (strength, shear_modulus) = (strength + ds, (shear_modulus + dk).max(0.1 * shear_modulus));
    }
    if strength > 0.0 && shear_modulus > 0.0 && shear_modulus.is_finite() {
        Ok(ShearStrength { pressure: test.pressure, strength, shear_modulus, classical_shear_modulus })
    } else {
        Err(EstimationError::Undetermined { what: "developed shear strength" })
    }
}

/// Gauss-Newton step of sum (tau - s (1 - e^(-j/K)))^2 in s and K.
fn step_in_stress(points: &[[f64; 2]], strength: f64, shear_modulus: f64) -> [f64; 2] {
    let (mut ss, mut sk, mut kk, mut se, mut ke) = (0.0, 0.0, 0.0, 0.0, 0.0);
    for [j, tau] in points {
        let decay = (-j / shear_modulus).exp();
        let (by_s, by_k) = (1.0 - decay, -strength * decay * j / (shear_modulus * shear_modulus));
        let residual = tau - strength * by_s;
        ss += by_s * by_s;
        sk += by_s * by_k;
        kk += by_k * by_k;
        se += by_s * residual;
        ke += by_k * residual;
    }
    let determinant = ss * kk - sk * sk;
    [(kk * se - sk * ke) / determinant, (ss * ke - sk * se) / determinant]
}

/// c and phi from the line of strength over pressure, K as the mean.
///
/// # Errors
/// [`EstimationError`] with fewer than two pressures.
pub fn strength_line(tests: &[ShearStrength]) -> Result<StrengthLine, EstimationError> {
    let found = tests.len();
    if found < 2 {
        return Err(EstimationError::TooFew { what: "an annulus", expected: 2, found });
    }
    let [cohesion, tan_phi] = line(tests.iter().map(|test| [test.pressure, test.strength]))
        .ok_or(EstimationError::Undetermined { what: "c and phi of one pressure" })?;
    let mean = |f: fn(&ShearStrength) -> f64| tests.iter().map(f).sum::<f64>() / found as f64;
    Ok(StrengthLine {
        cohesion,
        friction_angle: tan_phi.atan(),
        shear_modulus: mean(|test| test.shear_modulus),
        classical_shear_modulus: mean(|test| test.classical_shear_modulus),
    })
}

/// Intercept and slope of the least-squares line; `None` where all abscissae are the same.
fn line(points: impl Iterator<Item = [f64; 2]> + Clone) -> Option<[f64; 2]> {
    let n = points.clone().count() as f64;
    let mean = |k: usize| points.clone().map(|point| point[k]).sum::<f64>() / n;
    let (x, y) = (mean(0), mean(1));
    let xx: f64 = points.clone().map(|p| (p[0] - x) * (p[0] - x)).sum();
    let xy: f64 = points.clone().map(|p| (p[0] - x) * (p[1] - y)).sum();
    (xx > 1e-12 * x * x * n).then(|| [y - xy / xx * x, xy / xx])
}
