//! The Kalman filter of a pair: consistent with its own model, the direct solution without noise, steady at rest.

use bekker::estimation::consistency::{chi_square_interval, nees};
use bekker::estimation::contact_angle::{PairFilter, PairModel, PairMotion, PairNoise, PairReading, direct};
use nalgebra::{Matrix2, Matrix4, Vector2, Vector4};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use rand_distr::{Distribution, StandardNormal};

/// A pair on ground that is as the filter believes, and its sensors' deviations.
#[derive(Clone, Copy)]
struct Case {
    model: PairModel,
    speed: f64,
    pitch_noise: f64,
    rate_noise: f64,
    speed_noise: f64,
    dt: f64,
    gyroscope: bool,
}

/// True motion of a [`Case`].
#[derive(Clone, Copy)]
struct Truth {
    alpha: f64,
    v1: f64,
    gamma: [f64; 2],
}

impl Truth {
    fn v2(&self) -> f64 {
        self.v1 * (self.gamma[0] - self.alpha).cos() / (self.gamma[1] - self.alpha).cos() // (2.29)
    }

    fn rate(&self, distance: f64) -> f64 {
        let [g1, g2] = self.gamma.map(|gamma| (gamma - self.alpha).sin());
        (self.v2() * g2 - self.v1 * g1) / distance // (2.30)
    }
}

impl Case {
    fn new(deviation: f64, length: f64, distance: f64) -> Self {
        let model = PairModel {
            distance,
            rate_drift: 0.0,
            speed_drift: 0.01,
            offset: 0.0,
            angle_deviation: deviation.to_radians(),
            correlation_length: length,
            kinematic_error: 0.001,
        };
        let speed_noise = 0.002;
        let pitch_noise = 0.3_f64.to_radians();
        Self { model, speed: 0.1, pitch_noise, rate_noise: 0.01, speed_noise, dt: 0.02, gyroscope: true }
    }

    fn reading(&self, truth: &Truth, unit: &mut impl FnMut() -> f64) -> PairReading {
        let noisy = |value: f64, deviation: f64, unit: f64| [value + deviation * unit, deviation * deviation];
        let rate = noisy(truth.rate(self.model.distance), self.rate_noise, unit());
        PairReading {
            inclination: noisy(truth.alpha, self.pitch_noise, unit()),
            rate: self.gyroscope.then_some(rate),
            speeds: [noisy(truth.v1, self.speed_noise, unit()), noisy(truth.v2(), self.speed_noise, unit())],
        }
    }

    /// Contact angles as Gauss-Markov processes about the line, the line as the kinematics turn it.
    fn advance(&self, truth: &mut Truth, unit: &mut impl FnMut() -> f64) {
        let before = *truth;
        let PairModel { angle_deviation, correlation_length, speed_drift, distance, .. } = self.model;
        for (gamma, speed) in truth.gamma.iter_mut().zip([before.v1, before.v2()]) {
            let kept = (-speed.abs() * self.dt / correlation_length).exp();
            *gamma = before.alpha + kept * (*gamma - before.alpha);
            *gamma += angle_deviation * (1.0 - kept * kept).sqrt() * unit();
        }
        truth.alpha += before.rate(distance) * self.dt;
        truth.v1 += speed_drift * self.dt.sqrt() * unit();
    }
}

const SEEDS: usize = 200;
const STEPS: usize = 300;

/// What the linearisation adds to the mean of the squares of four entries, beyond the 95 % interval: of angles that scatter by 12
/// degrees the term of second order is sigma^2/2 = 2.2 % of the speed at each of the two wheels. Of the two angles alone the
/// interval holds as it is.
const LINEARISED: f64 = 1.05;

#[test]
fn property_the_filter_is_consistent_on_ground_that_is_as_it_believes() {
    let cases = [Case::new(12.0, 0.1, 0.2), Case::new(10.0, 0.5, 0.5)];
    for case in cases.into_iter().flat_map(|case| [case, Case { gyroscope: false, ..case }]) {
        let (mut angles, mut entries, mut innovations, mut count) = (0.0, 0.0, 0.0, 0);
        for seed in 0..SEEDS {
            let mut rng = ChaCha8Rng::seed_from_u64(seed as u64);
            let mut unit = || -> f64 { StandardNormal.sample(&mut rng) };
            let deviation = case.model.angle_deviation;
            let gamma = [0.1 + deviation * unit(), 0.1 + deviation * unit()];
            let mut truth = Truth { alpha: 0.1, v1: case.speed, gamma };
            let mut filter = PairFilter::new(case.model, &case.reading(&truth, &mut unit));
            for _ in 0..STEPS {
                case.advance(&mut truth, &mut unit);
                let innovation = filter.step(case.dt, &case.reading(&truth, &mut unit));
                innovations += innovation.nis;
                count = innovation.count;
            }
            let (x, p) = (filter.state(), filter.covariance());
            let error = Vector2::new(x[4] - truth.gamma[0], x[5] - truth.gamma[1]);
            let covariance: Matrix2<f64> = p.fixed_view::<2, 2>(4, 4).into();
            angles += nees(&error, &covariance).expect("positive definite") / SEEDS as f64;
            // The entries that the equations leave free.
            let free = [0, 2, 4, 5];
            let error = Vector4::new(x[0] - truth.alpha, x[2] - truth.v1, error[0], error[1]);
            let covariance = Matrix4::from_fn(|i, j| p[(free[i], free[j])]);
            entries += nees(&error, &covariance).expect("positive definite") / SEEDS as f64;
        }
        let ([low, high], [low4, high4]) = (chi_square_interval(2, SEEDS), chi_square_interval(4, SEEDS));
        assert!(angles > low && angles < high, "angles: {angles}, expected {low} .. {high}");
        assert!(entries > low4 && entries < LINEARISED * high4, "entries: {entries}, expected {low4} .. {high4}");
        // The equations' second-order terms make innovations smaller than believed, never larger.
        let nis = innovations / (SEEDS * STEPS) as f64;
        let [_, most] = chi_square_interval(count, SEEDS * STEPS);
        assert!(nis < most && nis > 0.5 * count as f64, "innovations: {nis} of {count}");
    }
}

/// Of a course in which both angles differ, sampled finely; the filter's ground lags behind by a part of a reading's change.
const WITHOUT_NOISE: f64 = 0.1 * std::f64::consts::PI / 180.0;

#[test]
fn agreement_without_noise_the_filter_gives_the_direct_solution() {
    let mut case = Case::new(15.0, 0.1, 0.3);
    (case.pitch_noise, case.rate_noise, case.speed_noise, case.dt) = (1e-6, 1e-6, 1e-6, 0.005);
    case.model.kinematic_error = 1e-6;
    let course = |t: f64, alpha: f64| Truth {
        alpha,
        v1: 0.1 * (1.0 + 0.2 * t.sin()),
        gamma: [alpha - 0.3 - 0.2 * (2.0 * t).sin(), alpha + 0.2 + 0.1 * (3.0 * t).cos()],
    };
    let mut truth = course(0.0, 0.05);
    let mut filter = PairFilter::new(case.model, &case.reading(&truth, &mut || 0.0));
    for k in 1..=1000 {
        let alpha = truth.alpha + truth.rate(case.model.distance) * case.dt;
        truth = course(f64::from(k) * case.dt, alpha);
        filter.step(case.dt, &case.reading(&truth, &mut || 0.0));
        if k < 50 {
            continue;
        }
        let motion = PairMotion {
            inclination: truth.alpha,
            rate: truth.rate(case.model.distance),
            speeds: [truth.v1, truth.v2()],
        };
        let solved = direct(case.model.distance, &motion, &PairNoise::default()).expect("a solution").angles;
        for point in [0, 1] {
            let difference = filter.angle(point)[0] - solved[point];
            assert!(difference.abs() < WITHOUT_NOISE, "reading {k}, point {point}: {difference} rad");
        }
    }
    assert_eq!(filter.restarts(), 0);
}

#[test]
fn property_at_rest_a_filter_keeps_what_it_knows() {
    let case = Case::new(15.0, 0.1, 0.2);
    let mut rng = ChaCha8Rng::seed_from_u64(4);
    let mut unit = || -> f64 { StandardNormal.sample(&mut rng) };
    let mut truth = Truth { alpha: 0.1, v1: 0.1, gamma: [0.0, 0.3] };
    let mut filter = PairFilter::new(case.model, &case.reading(&truth, &mut unit));
    for _ in 0..100 {
        filter.step(case.dt, &case.reading(&truth, &mut unit));
        truth.alpha += truth.rate(case.model.distance) * case.dt;
    }
    truth.v1 = 0.0;
    // A second, in which the estimated speeds come to rest.
    for _ in 0..50 {
        filter.step(case.dt, &case.reading(&truth, &mut unit));
    }
    let known = [filter.angle(0), filter.angle(1)];
    for _ in 0..3000 {
        filter.step(case.dt, &case.reading(&truth, &mut unit));
    }
    for (point, [angle, deviation]) in known.into_iter().enumerate() {
        let [now, uncertainty] = filter.angle(point);
        // A minute of noise is no information about directions, and takes little of what was there.
        assert!((now - angle).abs() < deviation, "{now}, {angle} before");
        assert!(
            uncertainty > 0.5 * deviation && uncertainty < case.model.angle_deviation * 1.2,
            "{uncertainty}, {deviation} before"
        );
    }
}

#[test]
fn property_a_filter_that_is_misled_starts_anew() {
    let case = Case::new(10.0, 0.1, 0.2);
    let flat = Truth { alpha: 0.0, v1: 0.1, gamma: [0.0; 2] };
    let mut filter = PairFilter::new(case.model, &case.reading(&flat, &mut || 0.0));
    (0..50).for_each(|_| {
        filter.step(case.dt, &case.reading(&flat, &mut || 0.0));
    });
    assert_eq!(filter.restarts(), 0);
    // Set down elsewhere: the line points up at once.
    let tilted = Truth { alpha: 0.5, gamma: [0.5; 2], ..flat };
    (0..200).for_each(|_| {
        filter.step(case.dt, &case.reading(&tilted, &mut || 0.0));
    });
    assert!(filter.restarts() >= 1);
    for point in [0, 1] {
        assert!((filter.angle(point)[0] - 0.5).abs() < 0.02, "{:?}", filter.angle(point));
    }
}

/// What a jerk of two readings may turn an angle by, that is not known within 15 degrees.
const BY_A_JERK: f64 = 10.0 * std::f64::consts::PI / 180.0;

#[test]
fn property_a_jerk_from_rest_turns_no_angle() {
    let mut case = Case::new(15.0, 0.1, 0.3);
    case.model.kinematic_error = 0.1;
    case.speed_noise = 0.004;
    for seed in 0..50 {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let mut unit = || -> f64 { StandardNormal.sample(&mut rng) };
        let rest = Truth { alpha: 0.0, v1: 0.0, gamma: [0.0; 2] };
        let mut filter = PairFilter::new(case.model, &case.reading(&rest, &mut unit));
        // The soil gives way under the starting drives: a rate that no ground makes.
        for rate in [0.11, 0.14] {
            let moving = case.reading(&Truth { v1: 0.067, ..rest }, &mut unit);
            filter.step(0.01, &PairReading { rate: Some([rate, case.rate_noise.powi(2)]), ..moving });
        }
        for point in [0, 1] {
            let [angle, _] = filter.angle(point);
            assert!(angle.abs() < BY_A_JERK, "seed {seed}, point {point}: {angle} rad");
        }
    }
}

/// Arithmetic of a dozen operations.
const ROUNDING: f64 = 1e-12;

#[test]
fn analytic_another_point_of_the_body_moves_with_it() {
    let case = Case::new(10.0, 0.1, 0.4);
    let truth = Truth { alpha: 0.4, v1: 0.1, gamma: [0.2, 0.5] };
    let mut filter = PairFilter::new(case.model, &case.reading(&truth, &mut || 0.0));
    filter.step(case.dt, &case.reading(&truth, &mut || 0.0));
    let x = filter.state();
    // The drawing has the line inclined by 0.15 rad: the body has turned by alpha - 0.15 since.
    let (place, inclination) = ([0.13, 0.05], 0.15);
    let (sin, cos) = (x[0] - inclination).sin_cos();
    let (dx, dz) = (cos * place[0] - sin * place[1], sin * place[0] + cos * place[1]);
    let velocity = Vector2::new(x[2] * x[4].cos() - x[1] * dz, x[2] * x[4].sin() + x[1] * dx);
    let [speed, variance] = filter.speed_of(place, inclination);
    assert!((speed - velocity.norm()).abs() < ROUNDING, "{speed}, {velocity}");
    assert!(variance > 0.0 && variance.sqrt() < 0.1 * speed, "{variance}");
    let [rear, of_rear] = filter.speed_of([0.0; 2], inclination);
    assert!((rear - x[2]).abs() < ROUNDING && (of_rear - filter.covariance()[(2, 2)]).abs() < ROUNDING);
}

#[test]
fn analytic_normalised_errors_are_sums_of_squares() {
    let covariance = Matrix2::new(4.0, 0.0, 0.0, 9.0);
    assert_eq!(nees(&Vector2::new(2.0, 6.0), &covariance), Some(5.0));
    assert_eq!(nees(&Vector2::new(2.0, 6.0), &Matrix2::zeros()), None);
    // Tables: 2.5 % and 97.5 % quantiles of chi-square with 10 and with 100 degrees of freedom.
    for (degrees, samples, table) in [(10, 1, [3.247, 20.483]), (4, 25, [74.222 / 25.0, 129.561 / 25.0])] {
        let found = chi_square_interval(degrees, samples);
        assert!(found.iter().zip(table).all(|(a, b)| (a / b - 1.0).abs() < 0.01), "{found:?}, {table:?}");
    }
}
