//! The extended Kalman filter of 2.5.1 for one pair of points at a fixed distance.
//!
//! State x = [alpha, alpha', v1, v2, gamma1, gamma2]: inclination of the line from the rear to the front point and its
//! rate, speeds of the points, directions in which they travel. Measured are alpha, v1, v2 and, where there is a
//! gyroscope, alpha'; the kinematic equations
//!
//! ```text
//! v1 cos(gamma1 - alpha) - v2 cos(gamma2 - alpha)            = 0                (2.29)
//! v2 sin(gamma2 - alpha) - v1 sin(gamma1 - alpha) - l alpha' = 0                (2.30)
//! ```
//!
//! are taken as two more measurements, of zero. That is what the thesis's pseudo-measurements of the angles by the direct
//! solution are, without the singularity where that solution has none: at rest and in translation the rows of the
//! angles vanish or coincide, and the filter keeps what it knew.

use super::equation::Equation;
use crate::snapshot::Moving;
use nalgebra::{Matrix2, SMatrix, SVector};

pub(super) const ALPHA: usize = 0;
const RATE: usize = 1;
pub(super) const SPEED: [usize; 2] = [2, 3];
pub(super) const GAMMA: [usize; 2] = [4, 5];

/// Error of the kinematic equations that is always left, m/s: far under any speed, so that no variance vanishes.
const LEAST_ERROR: f64 = 1e-6;

/// Deviations of a speed within which a point counts as standing: noise goes no way.
const STANDING: f64 = 4.0;

/// Factor by which the rate may change faster than contact angles let it: the kinematic equations say so already, and the
/// same knowledge is not to count twice.
const FREE: f64 = 10.0;

/// Deviations of the ground's own angle, and angle between travel and ground's mean, beyond which an estimate is lost.
const LOST: f64 = 4.0;
const STEEPEST: f64 = 80.0 * std::f64::consts::PI / 180.0;

/// Readings over which the inclination's innovations are averaged, and deviations of that mean beyond which the
/// estimate is lost. Chance does that once in a million independent means.
const WINDOW: f64 = 32.0;
const BIASED: f64 = 5.0;

/// [alpha, alpha', v1, v2, gamma1, gamma2], SI.
pub type State = SVector<f64, 6>;
/// Covariance of a [`State`].
pub type Covariance = SMatrix<f64, 6, 6>;

/// The filter's model of a pair of points: geometry and process noise.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PairModel {
    /// Distance l of the points, m.
    pub distance: f64,
    /// Standard deviation of the change of the rate within a second (a random walk), rad/s, beyond the change that comes
    /// with those of the contact angles.
    pub rate_drift: f64,
    /// Standard deviation of the change of a speed within a second (a random walk), m/s.
    pub speed_drift: f64,
    /// Inclination of the line to the ground's mean, rad: 0 between two wheels, that of the drawing to a pivot.
    pub offset: f64,
    /// Standard deviation of the contact angles about the ground's mean, rad.
    pub angle_deviation: f64,
    /// Distance over which the autocorrelation of a contact angle falls to 1/e, m.
    pub correlation_length: f64,
    /// Error of either speed in the kinematic equations, share of the speed: slip, radii, distances. It lasts as long as a
    /// contact angle does, and counts as white noise of the same density.
    pub kinematic_error: f64,
}

/// One reading of a pair, with variances.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PairReading {
    /// Inclination alpha, rad, and its variance.
    pub inclination: [f64; 2],
    /// Rate alpha', rad/s, and its variance, where it is measured.
    pub rate: Option<[f64; 2]>,
    /// Speeds v1, v2, m/s, each with its variance.
    pub speeds: [[f64; 2]; 2],
}

/// Normalised innovation squared of one update, and how many measurements it sums up.
#[derive(Clone, Copy, Debug, Default, PartialEq, Moving)]
pub struct Innovation {
    /// Sum of innovation^2/variance; chi-square distributed with `count` degrees of freedom in a consistent filter.
    pub nis: f64,
    /// Number of measurements.
    pub count: usize,
}

/// The filter of one pair; a value of fixed size.
#[derive(Clone, Copy, Debug, PartialEq, Moving)]
pub struct PairFilter {
    #[not_moving]
    model: PairModel,
    state: State,
    covariance: Covariance,
    /// Running mean of the inclination's normalised innovations.
    bias: f64,
    restarts: u32,
}

impl PairFilter {
    /// A filter that starts at a reading, its angles along the ground's mean.
    #[must_use]
    pub fn new(model: PairModel, first: &PairReading) -> Self {
        let [alpha, alpha_variance] = first.inclination;
        let [rate, rate_variance] = first
            .rate
            .unwrap_or([0.0, model.rate_spread(first.speeds.map(|[speed, variance]| speed.abs() + variance.sqrt()))]);
        let [[v1, v1_variance], [v2, v2_variance]] = first.speeds;
        let mean = alpha - model.offset;
        let angle_variance = model.angle_deviation * model.angle_deviation + alpha_variance;
        let mut covariance = Covariance::from_diagonal(
            &[alpha_variance, rate_variance, v1_variance, v2_variance, angle_variance, angle_variance].into(),
        );
        // The angles start at the measured inclination, error and all.
        for gamma in GAMMA {
            covariance[(gamma, ALPHA)] = alpha_variance;
            covariance[(ALPHA, gamma)] = alpha_variance;
        }
        covariance[(GAMMA[0], GAMMA[1])] = alpha_variance;
        covariance[(GAMMA[1], GAMMA[0])] = alpha_variance;
        let mut filter =
            Self { model, state: [alpha, rate, v1, v2, mean, mean].into(), covariance, bias: 0.0, restarts: 0 };
        // At rest the equations tie the angles to the noise of the speeds and of the rate, and the first jerk would turn them.
        if !filter.stands() {
            filter.constrain(0.0);
        }
        filter
    }

    /// Prediction over `dt` seconds and update by a reading, (D.4)-(D.8). Measurements come one after the other, which
    /// for a diagonal R is the same as together and needs no inverse; the two equations come last, about the state that
    /// the readings have led to. At rest they are left out, since they say nothing there (2.5), and noise of the speeds would
    /// pass for knowledge. A filter that has lost its way starts anew at the reading.
    pub fn step(&mut self, dt: f64, reading: &PairReading) -> Innovation {
        self.predict(dt);
        self.watch(reading.inclination);
        let mut nis = self.absorb_entry(ALPHA, reading.inclination);
        nis += reading.rate.map_or(0.0, |rate| self.absorb_entry(RATE, rate));
        nis += self.absorb_entry(SPEED[0], reading.speeds[0]) + self.absorb_entry(SPEED[1], reading.speeds[1]);
        let moving = !self.stands();
        nis += if moving { self.constrain(dt) } else { 0.0 };
        if self.lost() {
            let restarts = self.restarts.saturating_add(1);
            *self = Self { restarts, ..Self::new(self.model, reading) };
        }
        Innovation { nis, count: 3 + usize::from(reading.rate.is_some()) + 2 * usize::from(moving) }
    }

    /// (D.4), (D.5): the line turns at its rate, rate and speeds walk randomly, and a contact angle is a Gauss-Markov
    /// process along the way about the ground's mean, so that without information it tends to that.
    fn predict(&mut self, dt: f64) {
        let going = SPEED.map(|speed| self.beyond_noise(speed));
        let model = &self.model;
        let x = &mut self.state;
        let mut f = Covariance::identity();
        let mut q = [0.0; 6];
        f[(ALPHA, RATE)] = dt;
        let speeds = [x[SPEED[0]], x[SPEED[1]]];
        // A contact angle takes its correlation length to change by all of its deviation.
        let memory = 2.0 * mean_speed(speeds) / model.correlation_length;
        q[RATE] = (model.rate_drift * model.rate_drift + FREE * memory * model.rate_spread(speeds)) * dt;
        for k in [0, 1] {
            let gamma = GAMMA[k];
            let forgets = dt / model.correlation_length;
            let kept = (-going[k] * forgets).exp();
            let mean = x[ALPHA] - model.offset;
            let apart = x[gamma] - mean;
            f[(gamma, ALPHA)] = 1.0 - kept;
            f[(gamma, gamma)] = kept;
            if going[k] > 0.0 {
                f[(gamma, SPEED[k])] = -x[SPEED[k]].signum() * forgets * kept * apart;
            }
            x[gamma] = mean + kept * apart;
            q[SPEED[k]] = model.speed_drift * model.speed_drift * dt;
            q[gamma] = model.angle_deviation * model.angle_deviation * (1.0 - kept * kept);
        }
        x[ALPHA] += x[RATE] * dt;
        self.covariance = f * self.covariance * f.transpose();
        q.iter().enumerate().for_each(|(k, q)| self.covariance[(k, k)] += q);
    }

    /// Takes a measurement [value, variance] of one entry of the state in; its normalised innovation squared.
    fn absorb_entry(&mut self, entry: usize, [value, variance]: [f64; 2]) -> f64 {
        let column: State = self.covariance.column(entry).into();
        self.absorb(column, value - self.state[entry], column[entry] + variance)
    }

    /// (D.6)-(D.8) for one measurement: `column` is P h^T, `total` h P h^T + R.
    fn absorb(&mut self, column: State, innovation: f64, total: f64) -> f64 {
        let scaled = column / total;
        self.state += scaled * innovation;
        // A product with itself: stays symmetric.
        self.covariance -= column * scaled.transpose();
        innovation * innovation / total
    }

    /// Takes (2.30) and (2.29) in, in this order: the first is nearly linear and gives the difference of the two directions, on
    /// which the slope of the second depends.
    fn constrain(&mut self, dt: f64) -> f64 {
        self.absorb_equation(true, dt) + self.absorb_equation(false, dt)
    }

    /// Whether both points may be standing.
    fn stands(&self) -> bool {
        SPEED.iter().all(|speed| self.beyond_noise(*speed) == 0.0)
    }

    /// A speed's size beyond its own noise, m/s.
    fn beyond_noise(&self, speed: usize) -> f64 {
        let (value, variance) = (self.state[speed], self.covariance[(speed, speed)]);
        (value * value - STANDING * STANDING * variance).max(0.0).sqrt()
    }

    fn absorb_equation(&mut self, turning: bool, dt: f64) -> f64 {
        let Equation { mut value, mut row, bends } = Equation::of(&self.state, turning);
        if turning {
            value -= self.model.distance * self.state[RATE];
            row[RATE] = -self.model.distance;
        }
        let speed = mean_speed([self.state[SPEED[0]], self.state[SPEED[1]]]);
        let error = self.model.kinematic_error;
        // An error that is correlated over the time tau has the density of white noise 2 tau/dt times its variance.
        let way = speed * dt;
        let lasting = if way > 0.0 { (2.0 * self.model.correlation_length / way).max(1.0) } else { 1.0 };
        let (mean, spread) = self.beyond_first_order(&bends);
        let parts = self.parts_squared(&row);
        let column = self.covariance * row;
        let total = row.dot(&column) + lasting * error * error * parts + LEAST_ERROR * LEAST_ERROR + spread;
        self.absorb(column, -(value + mean), total)
    }

    /// Averages the normalised innovations of the inclination.
    fn watch(&mut self, [alpha, variance]: [f64; 2]) {
        let deviation = (self.covariance[(ALPHA, ALPHA)] + variance).sqrt();
        self.bias += ((alpha - self.state[ALPHA]) / deviation - self.bias) / WINDOW;
    }

    /// Whether the estimate is where no ground is, or the inclination does not go its way: with both directions nearly
    /// across the line (2.29) says nothing, and a linearised filter can stay there, sure of itself.
    fn lost(&self) -> bool {
        let most = (LOST * self.model.angle_deviation).min(STEEPEST);
        let mean = self.state[ALPHA] - self.model.offset;
        let biased = self.bias.abs() * (2.0 * WINDOW).sqrt() > BIASED;
        biased || GAMMA.iter().any(|gamma| (self.state[*gamma] - mean).abs() > most)
    }

    /// Sum of the squares of v cos or v sin of both points, which errors of the speeds are shares of; the directions with
    /// their uncertainty.
    fn parts_squared(&self, row: &State) -> f64 {
        let p = &self.covariance;
        let square = |k: usize| {
            let (part, by_angle, gamma) = (row[SPEED[k]] * self.state[SPEED[k]], row[GAMMA[k]], GAMMA[k]);
            let of_angle = p[(gamma, gamma)] - 2.0 * p[(gamma, ALPHA)] + p[(ALPHA, ALPHA)];
            part * part + by_angle * by_angle * of_angle
        };
        square(0) + square(1)
    }

    /// Mean and variance of the second-order part of an equation, tr(H P)/2 and tr(H P H P)/2: without them the filter
    /// is overconfident in the directions of points that hardly move.
    fn beyond_first_order(&self, bends: &[Matrix2<f64>; 2]) -> (f64, f64) {
        let p = &self.covariance;
        let joint = |a: usize, b: usize| {
            let (va, vb, ga, gb) = (SPEED[a], SPEED[b], GAMMA[a], GAMMA[b]);
            Matrix2::new(
                p[(va, vb)],
                p[(va, gb)] - p[(va, ALPHA)],
                p[(ga, vb)] - p[(ALPHA, vb)],
                p[(ga, gb)] - p[(ga, ALPHA)] - p[(ALPHA, gb)] + p[(ALPHA, ALPHA)],
            )
        };
        let own = [bends[0] * joint(0, 0), bends[1] * joint(1, 1)];
        let cross = [bends[0] * joint(0, 1), bends[1] * joint(1, 0)];
        let mean = 0.5 * (own[0].trace() + own[1].trace());
        let squares = (own[0] * own[0]).trace() + (own[1] * own[1]).trace();
        (mean, 0.5 * squares + (cross[0] * cross[1]).trace())
    }

    /// The estimated state.
    #[must_use]
    pub fn state(&self) -> &State {
        &self.state
    }

    /// Estimated rate of the line, rad/s, and its variance.
    #[must_use]
    pub fn rate(&self) -> [f64; 2] {
        [self.state[RATE], self.covariance[(RATE, RATE)].max(0.0)]
    }

    /// Speed along its path, m/s, signed as the rear point's, and its variance, of a point of the same body: `place` is
    /// where it lies from the rear point in the drawing, m, `inclination` that of the pair's line there, rad.
    #[must_use]
    pub fn speed_of(&self, place: [f64; 2], inclination: f64) -> [f64; 2] {
        let (turned_sin, turned_cos) = (self.state[ALPHA] - inclination).sin_cos();
        let (rate, speed) = (self.state[RATE], self.state[SPEED[0]]);
        let (sin, cos) = self.state[GAMMA[0]].sin_cos();
        let (x, z) = (turned_cos * place[0] - turned_sin * place[1], turned_sin * place[0] + turned_cos * place[1]);
        // Nose up turns (x, z) into (-z, x).
        let velocity = [speed * cos - rate * z, speed * sin + rate * x];
        let size = velocity[0].hypot(velocity[1]);
        let along = if size > 0.0 { velocity.map(|v| v / size) } else { [cos, sin] };
        let mut row = State::zeros();
        row[ALPHA] = -rate * (along[0] * x + along[1] * z);
        row[RATE] = along[1] * x - along[0] * z;
        row[SPEED[0]] = along[0] * cos + along[1] * sin;
        row[GAMMA[0]] = speed * (along[1] * cos - along[0] * sin);
        [size.copysign(speed), row.dot(&(self.covariance * row)).max(0.0)]
    }

    /// How often it has lost its way and started anew.
    #[must_use]
    pub fn restarts(&self) -> u32 {
        self.restarts
    }

    /// Its covariance.
    #[must_use]
    pub fn covariance(&self) -> &Covariance {
        &self.covariance
    }

    /// Estimated contact angle and its standard deviation, rad, of the rear (0) or front (1) point.
    #[must_use]
    pub fn angle(&self, point: usize) -> [f64; 2] {
        let gamma = GAMMA[point.min(1)];
        [self.state[gamma], self.covariance[(gamma, gamma)].max(0.0).sqrt()]
    }
}

impl PairModel {
    /// Variance of the rate that goes with independent contact angles at the two points, (2.30), rad^2/s^2.
    fn rate_spread(&self, speeds: [f64; 2]) -> f64 {
        let spread = mean_speed(speeds) * self.angle_deviation / self.distance;
        2.0 * spread * spread
    }
}

fn mean_speed([rear, front]: [f64; 2]) -> f64 {
    0.5 * (rear.abs() + front.abs())
}
