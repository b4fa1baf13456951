//! The vehicle of 2.6.1: two points on a wave, with noisy pitch and speeds.

use super::MeanSquare;
use bekker::estimation::consistency::nees;
use bekker::estimation::contact_angle::{
    Innovation, Pair, PairFilter, PairModel, PairMotion, PairNoise, PairReading, Point, ProfileFilter, ProfileModel,
    ProfileReading, direct,
};
use nalgebra::{Matrix2, Vector2};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use rand_distr::{Distribution, StandardNormal};
use std::f64::consts::{FRAC_1_SQRT_2, TAU};

/// Waves that are driven over.
const WAVES: f64 = 2.0;
/// Share of the first wave that counts as initial transient.
const TRANSIENT: f64 = 0.25;
/// Noise as a share of a range (2.6.1), and instants a wave at which the range is looked for.
const NOISE_SHARE: f64 = 0.1;
const INSTANTS: f64 = 400.0;
/// Way over which the slope's autocorrelation falls to 1/e in the ground's filter, of the wavelength: its errors are as large
/// as it believes there (trials 1000 to 1009, which no result counts).
const SMOOTH: f64 = 0.4;
/// Error of the speeds in the ground's filter, share of the speed: the simulation's kinematics are exact.
const EXACT: f64 = 1e-4;
/// Newton's iterations for the front point; the error is far under rounding after five.
const ITERATIONS: usize = 8;

/// Two points at a fixed distance on the wave z = A sin(2 pi x/wavelength), their middle at constant speed, and what is
/// measured of them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wave {
    /// Distance of the points, m.
    pub distance: f64,
    /// Wavelength, m.
    pub wavelength: f64,
    /// Range of the pitch, from its least to its largest value, rad; the amplitude A follows.
    pub pitch_range: f64,
    /// Speed of the middle, m/s.
    pub speed: f64,
    /// Time between readings, s.
    pub period: f64,
    /// White noise of the pitch, rad.
    pub pitch_noise: f64,
    /// White noise of either speed, m/s.
    pub speed_noise: f64,
    /// Factor of R on the variances of the noise.
    pub covariance_factor: f64,
    /// Way over which the filters take contact angles to be correlated, over what the wave's number says.
    pub correlation_factor: f64,
}

impl Default for Wave {
    /// What 2.6.1 states, and wavelength, speed and rate of readings as assumed.
    fn default() -> Self {
        Self {
            distance: 1.0,
            wavelength: 4.0,
            pitch_range: 30.0_f64.to_radians(),
            speed: 0.005,
            period: 0.1,
            pitch_noise: 3.0_f64.to_radians(),
            speed_noise: 0.0005,
            covariance_factor: 1.5,
            correlation_factor: 1.0,
        }
    }
}

/// True motion at one reading; angles in rad, rear and front.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Truth {
    pub motion: PairMotion,
    pub angles: [f64; 2],
}

/// How well a filter tracked in one trial; rear and front.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Quality {
    /// RMS errors after the initial transient, rad.
    pub errors: [f64; 2],
    /// Mean normalised squared error of both angles; 2 where the covariance is that of the errors.
    pub nees: f64,
    /// Mean normalised innovation squared of a reading over its number of measurements; 1 in a consistent filter.
    pub nis: f64,
}

/// How well contact angles were tracked in one trial; rear and front.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Tracking {
    /// Of the filter of the ground that both wheels cross.
    pub ground: Quality,
    /// Of the filter of two unrelated angles, which is the thesis's.
    pub pair: Quality,
    /// RMS error of the direct solution of means over a quarter of the distance, where it has one, rad.
    pub direct: [f64; 2],
    /// Share of the instants at which that has a solution.
    pub direct_share: f64,
    /// Share of the readings for which the direct solution has one when the rate is the difference of two readings.
    pub raw_share: f64,
    /// Angles in time, rad: [true, of the ground's filter, direct], each rear and front; direct is NaN where it has no
    /// solution.
    pub course: Vec<[[f64; 2]; 3]>,
}

impl Wave {
    /// Amplitude A, m: the chord from -l/2 to l/2 about a zero of the wave has half the pitch's range.
    #[must_use]
    pub fn amplitude(&self) -> f64 {
        let half_turn = 0.5 * self.distance * TAU / self.wavelength;
        // The chord's horizontal part is l cos(pitch), nearly l; its rise 2 A sin(k l cos/2).
        let (sin, cos) = (0.5 * self.pitch_range).sin_cos();
        0.5 * self.distance * sin / (half_turn * cos).sin()
    }

    /// The same at a speed at which the points' speeds range, from the least to the largest, over ten times their noise: "10 %
    /// of their range of values" (2.6.1) as the pitch's 3 of 30 degrees are.
    #[must_use]
    pub fn speeds_in_range(&self) -> Self {
        let coarse = Self { period: self.wavelength / self.speed / INSTANTS, ..*self };
        let speeds = coarse.truth();
        let of_rear = || speeds.iter().map(|truth| truth.motion.speeds[0] / self.speed);
        let share = of_rear().fold(f64::MIN, f64::max) - of_rear().fold(f64::MAX, f64::min);
        Self { speed: self.speed_noise / (NOISE_SHARE * share), ..*self }
    }

    /// Slope of the wave at x, rad.
    pub(super) fn slope(&self, x: f64) -> f64 {
        let k = TAU / self.wavelength;
        (self.amplitude() * k * (k * x).cos()).atan()
    }

    /// Deviation of the wave's slope, rad.
    pub(super) fn angle_deviation(&self) -> f64 {
        (self.amplitude() * TAU / self.wavelength).atan() * FRAC_1_SQRT_2
    }

    /// The true motion, reading by reading.
    pub(super) fn truth(&self) -> Vec<Truth> {
        let (amplitude, k) = (self.amplitude(), TAU / self.wavelength);
        let ground = |x: f64| (amplitude * (k * x).sin(), amplitude * k * (k * x).cos());
        let readings = (WAVES * self.wavelength / (self.speed * self.period)) as usize;
        // Between readings the points move in ten steps of the midpoint rule.
        const STEPS: usize = 10;
        let h = self.period / STEPS as f64;
        let mut rear = 0.0;
        let mut course = Vec::with_capacity(readings);
        for _ in 0..readings {
            course.push(self.instant(rear, &ground));
            for _ in 0..STEPS {
                let half = rear + 0.5 * h * self.advance(rear, &ground);
                rear += h * self.advance(half, &ground);
            }
        }
        course
    }

    /// Rate of the rear point's x, m/s.
    fn advance(&self, rear: f64, ground: &impl Fn(f64) -> (f64, f64)) -> f64 {
        let Truth { motion, angles } = self.instant(rear, ground);
        motion.speeds[0] * angles[0].cos()
    }

    /// The motion when the rear point is at x = `rear`.
    fn instant(&self, rear: f64, ground: &impl Fn(f64) -> (f64, f64)) -> Truth {
        let l = self.distance;
        let (z1, slope1) = ground(rear);
        let mut front = rear + l;
        for _ in 0..ITERATIONS {
            let (z2, slope2) = ground(front);
            let (x, z) = (front - rear, z2 - z1);
            front -= (x * x + z * z - l * l) / (2.0 * (x + z * slope2));
        }
        let (z2, slope2) = ground(front);
        let inclination = (z2 - z1).atan2(front - rear);
        let angles = [slope1.atan(), slope2.atan()];
        let [beta, theta] = [inclination - angles[0], angles[1] - inclination];
        // (2.29); the middle's velocity is the mean of those of the points.
        let ratio = beta.cos() / theta.cos();
        let middle = 0.5 * (angles[0].cos() + ratio * angles[1].cos()).hypot(angles[0].sin() + ratio * angles[1].sin());
        let v1 = self.speed / middle;
        let v2 = v1 * ratio;
        let rate = (v2 * theta.sin() + v1 * beta.sin()) / l; // (2.30)
        Truth { motion: PairMotion { inclination, rate, speeds: [v1, v2] }, angles }
    }

    /// The filter's settings: contact angles with the deviation of the wave's slope, correlated over 1/k; speeds that
    /// may wander by their noise within that way; a rate that only the contact angles change.
    fn model(&self) -> PairModel {
        let k = TAU / self.wavelength;
        let length = self.correlation_factor / k;
        PairModel {
            distance: self.distance,
            rate_drift: 0.0,
            speed_drift: self.speed_noise / (length / self.speed).sqrt(),
            offset: 0.0,
            angle_deviation: self.angle_deviation(),
            correlation_length: length,
            kinematic_error: 0.001,
        }
    }

    /// One trial: the noise of `seed` on the course `truth`.
    pub(super) fn track(&self, truth: &[Truth], seed: u64) -> Tracking {
        let readings = self.readings(truth, seed);
        let mut tracking = Tracking::default();
        tracking.pair = self.follow_pair(truth, &readings);
        tracking.ground = self.follow_ground(truth, &readings, &mut tracking.course);
        self.solve_means(truth, &readings, &mut tracking);
        tracking.raw_share = self.raw_share(&readings);
        tracking
    }

    /// One trial from the beginning.
    #[must_use]
    pub fn trial(&self, seed: u64) -> Tracking {
        self.track(&self.truth(), seed)
    }

    /// Readings [pitch, v1, v2].
    fn readings(&self, truth: &[Truth], seed: u64) -> Vec<[f64; 3]> {
        let mut noise = ChaCha8Rng::seed_from_u64(seed);
        let mut draw = |deviation: f64| -> f64 {
            let unit: f64 = StandardNormal.sample(&mut noise);
            deviation * unit
        };
        let mut reading = |truth: &Truth| {
            let PairMotion { inclination, speeds: [v1, v2], .. } = truth.motion;
            let pitch = inclination + draw(self.pitch_noise);
            [pitch, v1 + draw(self.speed_noise), v2 + draw(self.speed_noise)]
        };
        truth.iter().map(&mut reading).collect()
    }

    /// Readings of the initial transient.
    pub(super) fn transient(&self) -> usize {
        (TRANSIENT * self.wavelength / (self.speed * self.period)) as usize
    }

    /// R's variances of pitch and speeds.
    fn variances(&self) -> [f64; 2] {
        [self.pitch_noise, self.speed_noise].map(|deviation| self.covariance_factor * deviation * deviation)
    }

    fn follow_pair(&self, truth: &[Truth], readings: &[[f64; 3]]) -> Quality {
        let [of_pitch, of_speed] = self.variances();
        let mut filter: Option<PairFilter> = None;
        let mut sums = Sums::default();
        for (k, (truth, [pitch, v1, v2])) in truth.iter().zip(readings).enumerate() {
            let reading =
                PairReading { inclination: [*pitch, of_pitch], rate: None, speeds: [[*v1, of_speed], [*v2, of_speed]] };
            let filter = filter.get_or_insert_with(|| PairFilter::new(self.model(), &reading));
            if k > 0 {
                sums.innovate(filter.step(self.period, &reading));
            }
            if k >= self.transient() {
                let angles = [filter.angle(0)[0], filter.angle(1)[0]];
                sums.add(truth.angles, angles, &filter.covariance().fixed_view::<2, 2>(4, 4).into());
            }
        }
        sums.quality()
    }

    /// The filter of the ground: slopes with the deviation of the wave's, speeds that may wander by their noise within the
    /// way over which slopes are correlated. That way is [`SMOOTH`] waves.
    fn ground(&self) -> ProfileModel {
        let correlation_length = self.correlation_factor * SMOOTH * self.wavelength;
        let points = [Point::Wheel(0), Point::Wheel(1)];
        ProfileModel {
            pairs: vec![Pair { body: 0, points, distance: self.distance, inclination: 0.0 }],
            places: vec![0.0, self.distance],
            angle_deviation: self.angle_deviation(),
            correlation_length,
            speed_drift: self.speed_noise / (correlation_length / self.speed).sqrt(),
            slip: 0.0,
            slip_deviation: 0.0,
            slip_length: 1.0,
            kinematic_error: EXACT,
            path_deviation: 0.0,
            rate_error: 0.0,
        }
    }

    fn follow_ground(&self, truth: &[Truth], readings: &[[f64; 3]], course: &mut Vec<[[f64; 2]; 3]>) -> Quality {
        // R as it is: the factor is the thesis's.
        let [of_pitch, of_speed] = [self.pitch_noise, self.speed_noise].map(|deviation| deviation * deviation);
        let mut filter = ProfileFilter::new(self.ground());
        let mut sums = Sums::default();
        for (k, (truth, [pitch, v1, v2])) in truth.iter().zip(readings).enumerate() {
            let speeds = [[*v1, of_speed], [*v2, of_speed]];
            let reading = ProfileReading { inclinations: &[[*pitch, of_pitch]], rates: None, speeds: &speeds };
            if k > 0 {
                sums.innovate(filter.step(self.period, &reading));
            } else {
                filter.start(&reading);
            }
            let angles = [filter.angle(0)[0], filter.angle(1)[0]];
            course.push([truth.angles, angles, [f64::NAN; 2]]);
            if k >= self.transient() {
                sums.add(truth.angles, angles, &Matrix2::from_fn(|a, b| filter.covariance(a, b)));
            }
        }
        sums.quality()
    }

    /// The direct solution of means of pitch and speeds, and of the line through the pitches, over a quarter of the
    /// distance; at the middle of each.
    fn solve_means(&self, truth: &[Truth], readings: &[[f64; 3]], tracking: &mut Tracking) {
        let half = (0.125 * self.distance / (self.speed * self.period)).round() as usize;
        let count = (2 * half + 1) as f64;
        let root = count.sqrt();
        // Sum of the squares of -half..=half.
        let squares = count * (count * count - 1.0) / 12.0;
        let noise = PairNoise {
            inclination: self.pitch_noise / root,
            rate: self.pitch_noise / (squares.sqrt() * self.period),
            speeds: [self.speed_noise / root; 2],
        };
        let (mut errors, mut instants) = ([MeanSquare::default(); 2], 0);
        for middle in self.transient().max(half)..truth.len().saturating_sub(half) {
            let window = &readings[middle - half..=middle + half];
            let mean = |k: usize| window.iter().map(|reading| reading[k]).sum::<f64>() / count;
            let along = window.iter().enumerate().map(|(j, reading)| (j as f64 - half as f64) * reading[0]);
            let rate = along.sum::<f64>() / (squares * self.period);
            let motion = PairMotion { inclination: mean(0), rate, speeds: [mean(1), mean(2)] };
            instants += 1;
            let Ok(solution) = direct(self.distance, &motion, &noise) else { continue };
            tracking.course[middle][2] = solution.angles;
            let true_angles = truth[middle].angles;
            errors.iter_mut().enumerate().for_each(|(k, sum)| sum.add(solution.angles[k] - true_angles[k]));
        }
        tracking.direct = errors.map(|error| error.root());
        tracking.direct_share = errors[0].count as f64 / f64::from(instants.max(1));
    }

    /// Share of the readings with a direct solution, the rate from the reading before and no doubt about noise.
    fn raw_share(&self, readings: &[[f64; 3]]) -> f64 {
        let solved = readings.windows(2).filter(|pair| {
            let ([before, ..], [pitch, v1, v2]) = (pair[0], pair[1]);
            let motion = PairMotion { inclination: pitch, rate: (pitch - before) / self.period, speeds: [v1, v2] };
            direct(self.distance, &motion, &PairNoise::default()).is_ok()
        });
        solved.count() as f64 / (readings.len() - 1) as f64
    }
}

/// Sums over a trial.
#[derive(Default)]
struct Sums {
    errors: [MeanSquare; 2],
    nees: f64,
    nis: f64,
    innovations: usize,
}

impl Sums {
    fn innovate(&mut self, innovation: Innovation) {
        self.nis += innovation.nis / innovation.count as f64;
        self.innovations += 1;
    }

    fn add(&mut self, truth: [f64; 2], angles: [f64; 2], covariance: &Matrix2<f64>) {
        let error = Vector2::from(angles) - Vector2::from(truth);
        self.errors.iter_mut().zip(error.iter()).for_each(|(sum, error)| sum.add(*error));
        self.nees += nees(&error, covariance).unwrap_or(f64::INFINITY);
    }

    fn quality(&self) -> Quality {
        Quality {
            errors: self.errors.map(|error| error.root()),
            nees: self.nees / self.errors[0].count as f64,
            nis: self.nis / self.innovations as f64,
        }
    }
}
