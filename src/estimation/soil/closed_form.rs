//! Strength by the thesis's closed form (2.24)-(2.26), from readings on one soil.
//!
//! Each reading gives one equation tan phi (h_8 - c h_9) = h_1 h_6 - c h_0 h_1. It inverts the simplified integrals
//! (B.5), (B.7) exactly; on the soil itself phi is biased by +1.8 degrees on average over the thesis's ranges with c
//! known (`tests/linear_stress_error.rs`), and c by what the linear stresses leave to it.
//! [`StrengthFilter`](super::StrengthFilter) has no such bias.

use super::super::EstimationError;
use super::reading::Reading;
use crate::linear_stress::{DrivenWheel, LinearStress, OutsideClosedForms, StrengthEquation};
use crate::soil::Soil;
use crate::wheel::Wheel;

/// Steps of the least squares; it converges in 3 to 10.
const STEPS: usize = 50;

/// The equations (2.24) of several readings.
#[derive(Clone, Debug, PartialEq)]
pub struct ClosedForm {
    equations: Vec<StrengthEquation>,
}

/// Cohesion and friction angle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FrictionAndCohesion {
    /// Cohesion, Pa.
    pub cohesion: f64,
    /// Friction angle, rad.
    pub friction_angle: f64,
}

/// The mean cohesion of pairs of readings.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CohesionByPairs {
    /// Cohesion and friction angle.
    pub strength: FrictionAndCohesion,
    /// Pairs that gave a cohesion.
    pub used: usize,
    /// Pairs there are: one fewer than readings (errata 6).
    pub pairs: usize,
}

impl ClosedForm {
    /// The equations of `readings` with one wheel on a soil of shear modulus K (m).
    ///
    /// # Errors
    /// [`EstimationError`] where a reading makes no sense or there is none.
    pub fn new(wheel: &Wheel, shear_modulus: f64, readings: &[Reading]) -> Result<Self, EstimationError> {
        if readings.is_empty() {
            return Err(EstimationError::TooFew { what: "a driven wheel", expected: 1, found: 0 });
        }
        let equation = |reading: &Reading| -> Result<StrengthEquation, EstimationError> {
            reading.check(wheel)?;
            let driven = DrivenWheel::new(wheel, shear_modulus, reading.sinkage, reading.slip)?;
            Ok(driven.strength_equation(reading.load, reading.torque))
        };
        Ok(Self { equations: readings.iter().map(equation).collect::<Result<_, _>>()? })
    }

    /// Friction angle (rad) with the cohesion (Pa) known: the mean of tan phi over the readings (2.26).
    #[must_use]
    pub fn friction_angle(&self, cohesion: f64) -> f64 {
        let sum: f64 = self.equations.iter().map(|equation| equation.tan_phi(cohesion)).sum();
        (sum / self.equations.len() as f64).atan()
    }

    /// Cohesion as the mean of the reasonable roots of (2.25) over consecutive pairs, and the friction angle by (2.26).
    ///
    /// A root is reasonable where it is not negative and tan phi is positive with it; of two the smaller is taken. A
    /// pair without any is left out, which the thesis does not mention and which lifts the mean where c is small.
    ///
    /// # Errors
    /// [`EstimationError::TooFew`] under two readings, [`EstimationError::Undetermined`] where no pair has a root.
    pub fn by_pairs(&self) -> Result<CohesionByPairs, EstimationError> {
        self.at_least_two()?;
        let roots = self.equations.windows(2).filter_map(|pair| cohesion_of_pair(&pair[0], &pair[1]));
        let (sum, used) = roots.fold((0.0, 0), |(sum, used), root| (sum + root, used + 1));
        if used == 0 {
            return Err(EstimationError::Undetermined { what: "reasonable cohesion" });
        }
        let cohesion = sum / used as f64;
        let strength = FrictionAndCohesion { cohesion, friction_angle: self.friction_angle(cohesion) };
        Ok(CohesionByPairs { strength, used, pairs: self.equations.len() - 1 })
    }

    /// Cohesion and friction angle by linear least squares in (c, tan phi) on all equations, each over its h_8; the one
    /// product c tan phi is taken at the last step (Gauss-Newton). Where that makes c or phi negative, c = 0 and phi by
    /// (2.26) are given instead.
    ///
    /// # Errors
    /// [`EstimationError::TooFew`] under two readings, [`EstimationError::Undetermined`] where they are all alike.
    pub fn least_squares(&self) -> Result<FrictionAndCohesion, EstimationError> {
        self.at_least_two()?;
        let mut at = [0.0, self.friction_angle(0.0).tan()];
        for _ in 0..STEPS {
            let step = self.step(at).ok_or(EstimationError::Undetermined { what: "cohesion and friction angle" })?;
            at = [at[0] + step[0], at[1] + step[1]];
            if step[0].abs() <= 1e-9 * (1.0 + at[0].abs()) && step[1].abs() <= 1e-12 {
                break;
            }
        }
        if !(at[0] >= 0.0 && at[1] > 0.0 && at[1].is_finite()) {
            at = [0.0, self.friction_at_zero_cohesion()];
        }
        Ok(FrictionAndCohesion { cohesion: at[0], friction_angle: at[1].atan() })
    }

    /// Gauss-Newton step of sum ((h_1 h_6 - c h_0 h_1 - t (h_8 - c h_9))/h_8)^2; `None` where the readings are alike.
    fn step(&self, [c, t]: [f64; 2]) -> Option<[f64; 2]> {
        let (mut cc, mut ct, mut tt, mut ce, mut te) = (0.0, 0.0, 0.0, 0.0, 0.0);
        for &StrengthEquation { h_0, h_1, h_6, h_8, h_9 } in &self.equations {
            let residual = (h_1 * h_6 - c * h_0 * h_1 - t * (h_8 - c * h_9)) / h_8;
            let (by_c, by_t) = ((-h_0 * h_1 + t * h_9) / h_8, -(h_8 - c * h_9) / h_8);
            cc += by_c * by_c;
            ct += by_c * by_t;
            tt += by_t * by_t;
            ce += by_c * residual;
            te += by_t * residual;
        }
        let determinant = cc * tt - ct * ct;
        // Readings that are alike but for rounding leave no determinant.
        (determinant > 1e-12 * cc * tt)
            .then(|| [-(tt * ce - ct * te) / determinant, -(cc * te - ct * ce) / determinant])
    }

    fn friction_at_zero_cohesion(&self) -> f64 {
        let sum: f64 = self.equations.iter().map(|equation| equation.tan_phi(0.0)).sum();
        sum / self.equations.len() as f64
    }

    fn at_least_two(&self) -> Result<(), EstimationError> {
        let found = self.equations.len();
        if found >= 2 { Ok(()) } else { Err(EstimationError::TooFew { what: "a driven wheel", expected: 2, found }) }
    }
}

/// The physically reasonable cohesion (Pa) of two readings (2.25), if there is one.
fn cohesion_of_pair(a: &StrengthEquation, b: &StrengthEquation) -> Option<f64> {
    // (p_a - c q_a)(h_8b - c h_9b) = (p_b - c q_b)(h_8a - c h_9a)
    let (p_a, q_a, p_b, q_b) = (a.h_1 * a.h_6, a.h_0 * a.h_1, b.h_1 * b.h_6, b.h_0 * b.h_1);
    let square = q_a * b.h_9 - q_b * a.h_9;
    let linear = -(p_a * b.h_9 + q_a * b.h_8) + (p_b * a.h_9 + q_b * a.h_8);
    let constant = p_a * b.h_8 - p_b * a.h_8;
    let root = (linear * linear - 4.0 * square * constant).sqrt();
    // Without cancellation: one root over the square, the other over the constant.
    let larger = -0.5 * (linear + linear.signum() * root);
    let roots = [larger / square, constant / larger];
    let reasonable = |c: &f64| *c >= 0.0 && c.is_finite() && a.tan_phi(*c) > 0.0 && b.tan_phi(*c) > 0.0;
    roots.into_iter().filter(reasonable).min_by(f64::total_cmp)
}

/// Drawbar pull (N) that a strength predicts for a measured load, with linear stresses: by (B.2), (B.3) and by the
/// simplified groups (B.6). The peak stress follows from the load by (B.1) and (B.5). Of `soil` the strength, K, c1
/// and c2 are used.
///
/// # Errors
/// [`OutsideClosedForms`] as [`DrivenWheel::new`].
pub fn drawbar_pull(wheel: &Wheel, soil: &Soil, reading: &Reading) -> Result<[f64; 2], OutsideClosedForms> {
    let driven = DrivenWheel::new(wheel, soil.shear_modulus, reading.sinkage, reading.slip)?;
    let theta_m = (soil.c1 + soil.c2 * reading.slip).clamp(0.05, 0.95) * driven.theta_1();
    let at = |sigma_m: f64| LinearStress::new(driven, theta_m, sigma_m, soil);
    // Loads and pulls are affine in the peak stress.
    let (none, some) = (at(0.0)?, at(1e4)?);
    let share = |forces: fn(&LinearStress) -> crate::contact::Forces| {
        let (none, some) = (forces(&none), forces(&some));
        let share = (reading.load - none.normal) / (some.normal - none.normal);
        none.drawbar + share * (some.drawbar - none.drawbar)
    };
    Ok([share(LinearStress::forces), share(LinearStress::simplified)])
}
