//! The filter of the ground that all wheels cross: consistent on ground that is as it believes, the rear wheel knows what the
//! front wheel read, steady at rest and in reverse.

use bekker::estimation::consistency::{chi_square_interval, nees};
use bekker::estimation::contact_angle::{Pair, Point, ProfileFilter, ProfileModel, ProfileReading};
use nalgebra::{Matrix2, Vector2};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use rand_distr::{Distribution, StandardNormal};

/// Distance of the wheels, m; time between readings, s; speed of the rear wheel, m/s.
const DISTANCE: f64 = 0.4;
const DT: f64 = 0.02;
const SPEED: f64 = 0.1;
/// Standard deviation of the slope, rad, and way over which its autocorrelation falls to 1/e, m.
const DEVIATION: f64 = 8.0 * std::f64::consts::PI / 180.0;
const LENGTH: f64 = 0.3;
/// Spacing of the ground's points, m.
const FINE: f64 = 0.001;
/// First place of the rear wheel, m.
const START: f64 = 0.5;

/// Ground by its slope at equally spaced places along it.
struct Ground {
    slope: Vec<f64>,
    points: Vec<[f64; 2]>,
}

impl Ground {
    fn new(slope: Vec<f64>) -> Self {
        let mut at = [0.0; 2];
        let points = slope.iter().map(|slope| {
            let now = at;
            at = [at[0] + FINE * slope.cos(), at[1] + FINE * slope.sin()];
            now
        });
        Self { points: points.collect(), slope }
    }

    /// White noise behind three equal first-order filters in a row has the autocorrelation (1 + u + u^2/3) exp(-u).
    fn random(way: f64, unit: &mut impl FnMut() -> f64) -> Self {
        let lambda = 2.904_6 / LENGTH;
        let density = 16.0 / 3.0 * DEVIATION * DEVIATION * lambda.powi(5);
        let mut filters = [0.0; 3];
        let mut step = || {
            filters[2] += FINE * (filters[1] - lambda * filters[2]);
            filters[1] += FINE * (filters[0] - lambda * filters[1]);
            filters[0] += (density * FINE).sqrt() * unit() - FINE * lambda * filters[0];
            filters[2]
        };
        // A start in which the filters forget.
        (0..(5.0 * LENGTH / FINE) as usize).for_each(|_| {
            step();
        });
        Self::new((0..(way / FINE) as usize).map(|_| step()).collect())
    }

    fn wave(way: f64) -> Self {
        Self::new((0..(way / FINE) as usize).map(|k| 0.2 * (4.0 * FINE * k as f64).sin()).collect())
    }

    fn interpolate(&self, place: f64, of: impl Fn(usize) -> f64) -> f64 {
        let node = (place / FINE) as usize;
        let share = place / FINE - node as f64;
        of(node) + share * (of(node + 1) - of(node))
    }

    fn point(&self, place: f64) -> [f64; 2] {
        [0, 1].map(|axis| self.interpolate(place, |node| self.points[node][axis]))
    }

    fn slope(&self, place: f64) -> f64 {
        self.interpolate(place, |node| self.slope[node])
    }

    /// The front wheel's place with the rear wheel at `rear`, and the inclination of their line.
    fn stand(&self, rear: f64) -> (f64, f64) {
        let [x, z] = self.point(rear);
        let (mut low, mut high) = (rear, rear + 2.0 * DISTANCE);
        for _ in 0..50 {
            let middle = 0.5 * (low + high);
            let [a, b] = self.point(middle);
            if (a - x).hypot(b - z) < DISTANCE { low = middle } else { high = middle }
        }
        let [a, b] = self.point(low);
        (low, (b - z).atan2(a - x))
    }
}

/// Sensors' standard deviations.
#[derive(Clone, Copy)]
struct Noise {
    pitch: f64,
    speed: f64,
    rate: Option<f64>,
}

const NOISE: Noise = Noise { pitch: 0.01, speed: 0.005, rate: None };

fn model() -> ProfileModel {
    ProfileModel {
        pairs: vec![Pair { body: 0, points: [Point::Wheel(0), Point::Wheel(1)], distance: DISTANCE, inclination: 0.0 }],
        places: vec![0.0, DISTANCE],
        angle_deviation: DEVIATION,
        correlation_length: LENGTH,
        speed_drift: 0.001,
        slip: 0.0,
        slip_deviation: 0.0,
        slip_length: 1.0,
        kinematic_error: 0.001,
        path_deviation: 0.0,
        rate_error: 0.0,
    }
}

/// A rover on a ground.
struct Drive<'a> {
    ground: &'a Ground,
    noise: Noise,
    rear: f64,
    filter: Option<ProfileFilter>,
}

impl<'a> Drive<'a> {
    fn new(ground: &'a Ground, noise: Noise) -> Self {
        Self { ground, noise, rear: START, filter: None }
    }

    /// Drives for a number of readings; the errors of the angles after the last, rear and front, rad.
    fn go(&mut self, speed: f64, readings: usize, unit: &mut impl FnMut() -> f64) -> [f64; 2] {
        for _ in 0..readings {
            self.rear += speed * DT;
            self.read(speed, unit);
        }
        self.errors()
    }

    fn read(&mut self, speed: f64, unit: &mut impl FnMut() -> f64) {
        let half = 0.5 * FINE;
        let (_, inclination) = self.ground.stand(self.rear);
        let ((front, before), (beyond, after)) =
            (self.ground.stand(self.rear - half), self.ground.stand(self.rear + half));
        let mut noisy = |value: f64, deviation: f64| [value + deviation * unit(), deviation * deviation];
        let inclinations = [noisy(inclination, self.noise.pitch)];
        let speeds = [noisy(speed, self.noise.speed), noisy(speed * (beyond - front) / FINE, self.noise.speed)];
        let rates = self.noise.rate.map(|deviation| [noisy(speed * (after - before) / FINE, deviation)]);
        let reading = ProfileReading {
            inclinations: &inclinations,
            rates: rates.as_ref().map(|r| r.as_slice()),
            speeds: &speeds,
        };
        if let Some(filter) = &mut self.filter {
            filter.step(DT, &reading);
        } else {
            let mut filter = ProfileFilter::new(model());
            filter.start(&reading);
            self.filter = Some(filter);
        }
    }

    fn filter(&self) -> &ProfileFilter {
        self.filter.as_ref().expect("it has driven")
    }

    fn errors(&self) -> [f64; 2] {
        let (front, _) = self.ground.stand(self.rear);
        let truth = [self.ground.slope(self.rear), self.ground.slope(front)];
        [0, 1].map(|wheel| self.filter().angle(wheel)[0] - truth[wheel])
    }
}

fn random(seed: u64) -> impl FnMut() -> f64 {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    move || StandardNormal.sample(&mut rng)
}

const SEEDS: usize = 120;
/// Readings of a drive of 1.6 m: four times the distance of the wheels.
const READINGS: usize = 800;

/// How far errors may be under what the filter believes: the second order of speeds and rates counts as an error that lasts, which
/// is more than it is.
const CAUTIOUS: f64 = 0.6;

#[test]
fn property_the_filter_is_consistent_on_ground_that_is_as_it_believes() {
    for rate in [None, Some(0.02)] {
        let (mut normalised, mut squares) = (0.0, [0.0; 2]);
        for seed in 0..SEEDS {
            let mut unit = random(seed as u64);
            let ground = Ground::random(4.0, &mut unit);
            let mut drive = Drive::new(&ground, Noise { rate, ..NOISE });
            let errors = drive.go(SPEED, READINGS, &mut unit);
            let covariance = Matrix2::from_fn(|a, b| drive.filter().covariance(a, b));
            normalised += nees(&Vector2::from(errors), &covariance).expect("positive definite") / SEEDS as f64;
            squares.iter_mut().zip(errors).for_each(|(sum, error)| *sum += error * error / SEEDS as f64);
            assert_eq!(drive.filter().restarts(), 0);
        }
        let [low, high] = chi_square_interval(2, SEEDS);
        let [rear, front] = squares.map(|square: f64| square.sqrt().to_degrees());
        println!("gyroscope {rate:?}: {normalised} of {low} .. {high}; rear {rear} deg, front {front} deg");
        assert!(normalised < high && normalised > CAUTIOUS * low, "{normalised}, expected {low} .. {high}");
        // The rear wheel crosses what the front wheel has read.
        assert!(rear < 0.8 * front, "rear {rear}, front {front} deg");
    }
}

/// Without noise inclination and rate give the difference of the slopes at once; what is the same under both wheels, of the length
/// of their distance, only the speeds tell, and slowly. The path between two nodes is not a straight line of slopes.
const OF_THE_DIFFERENCE: f64 = 0.2 * std::f64::consts::PI / 180.0;
const OF_A_SLOPE: f64 = 2.5 * std::f64::consts::PI / 180.0;

#[test]
fn agreement_without_noise_the_filter_gives_the_slopes() {
    let ground = Ground::wave(5.0);
    let mut drive = Drive::new(&ground, Noise { pitch: 1e-5, speed: 1e-6, rate: Some(1e-5) });
    let mut unit = random(1);
    drive.go(SPEED, 300, &mut unit);
    for _ in 0..20 {
        let [rear, front] = drive.go(SPEED, 40, &mut unit);
        assert!((front - rear).abs() < OF_THE_DIFFERENCE, "{rear} and {front} rad off at {} m", drive.rear);
        assert!(rear.abs() < OF_A_SLOPE, "{rear} rad off at {} m", drive.rear);
    }
}

#[test]
fn property_at_rest_a_filter_keeps_what_it_knows() {
    let mut unit = random(2);
    let ground = Ground::random(4.0, &mut unit);
    let mut drive = Drive::new(&ground, Noise { rate: Some(0.02), ..NOISE });
    drive.go(SPEED, READINGS, &mut unit);
    drive.go(0.0, 50, &mut unit);
    let known = [0, 1].map(|wheel| drive.filter().angle(wheel));
    // A minute, in which the inclination is measured ever better and nothing else.
    drive.go(0.0, 3000, &mut unit);
    for (wheel, [angle, deviation]) in known.into_iter().enumerate() {
        let [now, uncertainty] = drive.filter().angle(wheel);
        assert!((now - angle).abs() < deviation, "wheel {wheel}: {now}, {angle} before");
        assert!(uncertainty > 0.3 * deviation, "wheel {wheel}: {uncertainty}, {deviation} before");
    }
}

#[test]
fn property_in_reverse_the_ground_is_known_already() {
    let (mut there, mut back) = (0.0, 0.0);
    for seed in 10..30 {
        let mut unit = random(seed);
        let ground = Ground::random(4.0, &mut unit);
        let mut drive = Drive::new(&ground, Noise { rate: Some(0.02), ..NOISE });
        there += drive.go(SPEED, READINGS, &mut unit)[1].powi(2);
        // Back by half of the wheels' distance: under the front wheel is what it has read before and after.
        back += drive.go(-SPEED, 100, &mut unit)[1].powi(2);
        // And far beyond all that the filter keeps.
        let errors = drive.go(-SPEED, 500, &mut unit);
        assert!(errors.iter().all(|error| error.abs() < 3.0 * DEVIATION), "{errors:?}");
    }
    assert!(back < there, "{back} after {there}");
}

#[test]
fn property_a_filter_that_is_misled_starts_anew() {
    let mut filter = ProfileFilter::new(model());
    let speeds = [[SPEED, 1e-5]; 2];
    let reading =
        |inclination: &'static [[f64; 2]]| ProfileReading { inclinations: inclination, rates: None, speeds: &speeds };
    filter.start(&reading(&[[0.0, 1e-4]]));
    (0..50).for_each(|_| {
        filter.step(DT, &reading(&[[0.0, 1e-4]]));
    });
    assert_eq!(filter.restarts(), 0);
    // Set down elsewhere: the line points up at once.
    (0..200).for_each(|_| {
        filter.step(DT, &reading(&[[0.6, 1e-4]]));
    });
    assert!(filter.restarts() >= 1);
    for wheel in [0, 1] {
        assert!((filter.angle(wheel)[0] - 0.6).abs() < 0.05, "{:?}", filter.angle(wheel));
    }
}
