//! How well contact angles can be known from the readings of 2.6.1 at all: a Cramer-Rao bound.

use super::MeanSquare;
use super::wave::{Truth, Wave};
use nalgebra::{Cholesky, DMatrix, DVector, Dyn};

/// Way between two instants, of the knots' distance; the readings in between count as so many at one instant.
const FINE: f64 = 0.04;
/// Instants a knot at which a bound is taken.
const CHECKS: f64 = 2.0;
/// Deviation of the speed's coefficients, of the speed.
const SPEED_DEVIATION: f64 = 0.1;
/// Parts of the ground under the vehicle for its integrals.
const PARTS: usize = 200;
/// Cubic splines that are not zero at a place.
const BASES: usize = 4;

/// Least RMS errors of the contact angles, rear and front, rad.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bound {
    /// From the readings up to an instant, as a filter has them.
    pub filter: [f64; 2],
    /// From all readings of the drive.
    pub smoother: [f64; 2],
}

/// What the rear wheel's ground has to do with the front one's.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Grounds {
    /// Nothing: two unknown courses of the slope.
    Two,
    /// It is the same, a wheelbase later.
    One,
}

impl Wave {
    /// The bound where both contact angles and the speed are known to be smooth: cubic splines along the way whose knots are
    /// `knots` (m) apart, each coefficient normally distributed, those of the angles with the deviation of the wave's
    /// slope, those of the speed with a tenth of it.
    ///
    /// It is the posterior Cramer-Rao bound (Van Trees 1968, 2.4) about the true course: the inverse of the information of
    /// prior and readings, with the line's inclination as the kinematics (2.30) turn it and v_2 by (2.29). Nothing is
    /// said of the ground under one wheel having been under the other. Noise is as it is, without R's factor.
    /// `None` where rounding leaves no definite matrix.
    #[must_use]
    pub fn bound(&self, knots: f64) -> Option<Bound> {
        self.bound_on(Grounds::Two, knots)
    }

    /// The same bound where both wheels are known to cross one ground: a single spline of the slope, at which the rear wheel
    /// reads where the front one was. The wheels' places along it are taken as known.
    #[must_use]
    pub fn ground_bound(&self, knots: f64) -> Option<Bound> {
        self.bound_on(Grounds::One, knots)
    }

    fn bound_on(&self, grounds: Grounds, knots: f64) -> Option<Bound> {
        let step = FINE * knots / self.speed;
        let truth = Self { period: step, ..*self }.truth();
        let ways = self.ways(grounds, &truth, step);
        let furthest = ways.last().map_or(0.0, |[rear, front]| rear.max(*front));
        let splines = Splines::new(knots, furthest + knots);
        let mut information = Information::new(self, &splines, grounds);
        if let (Grounds::One, Some(first), Some([_, front])) = (grounds, truth.first(), ways.first()) {
            information.lay(self, first, &splines, *front);
        }
        let transient = (self.transient() as f64 * self.period / step) as usize;
        let every = (1.0 / (FINE * CHECKS)) as usize;
        let checked = |k: usize| k >= transient && k.is_multiple_of(every);
        let mut filter = [MeanSquare::default(); 2];
        for (k, (instant, ways)) in truth.iter().zip(&ways).enumerate() {
            let rows = ways.map(|way| splines.at(way));
            information.read(self, instant, &rows, step / self.period);
            if checked(k) {
                information.factor()?.add(&rows, &mut filter);
            }
            information.turn(self, instant, &rows, step);
        }
        let known = information.factor()?;
        let mut smoother = [MeanSquare::default(); 2];
        (0..truth.len()).filter(|&k| checked(k)).for_each(|k| {
            known.add(&ways[k].map(|way| splines.at(way)), &mut smoother);
        });
        Some(Bound { filter: filter.map(|sum| sum.root()), smoother: smoother.map(|sum| sum.root()) })
    }

    /// Places of both wheels along the splines, m: on one ground along its arc, from the rear wheel's first place on.
    fn ways(&self, grounds: Grounds, truth: &[Truth], step: f64) -> Vec<[f64; 2]> {
        match grounds {
            Grounds::Two => (0..truth.len()).map(|k| [k as f64 * step * self.speed; 2]).collect(),
            Grounds::One => {
                let mut way = [0.0, self.arc(truth)];
                let along = |instant: &Truth| {
                    let now = way;
                    way.iter_mut().zip(instant.motion.speeds).for_each(|(way, speed)| *way += speed * step);
                    now
                };
                truth.iter().map(along).collect()
            }
        }
    }

    /// Arc of the wave under the vehicle at the first instant, m.
    fn arc(&self, truth: &[Truth]) -> f64 {
        let width = truth.first().map_or(0.0, |first| self.distance * first.motion.inclination.cos());
        (0..PARTS).map(|k| width / PARTS as f64 / self.slope((k as f64 + 0.5) * width / PARTS as f64).cos()).sum()
    }
}

/// Uniform cubic B-splines along the way.
struct Splines {
    knots: f64,
    count: usize,
}

/// The four splines that are not zero at a place: the first one's number, and their values.
struct Row {
    first: usize,
    values: [f64; BASES],
}

impl Splines {
    fn new(knots: f64, way: f64) -> Self {
        Self { knots, count: (way / knots).ceil() as usize + BASES }
    }

    fn at(&self, way: f64) -> Row {
        let place = way / self.knots;
        let first = (place as usize).min(self.count - BASES);
        let u = place - first as f64;
        let w = 1.0 - u;
        let values = [w * w * w, 3.0 * u * u * u - 6.0 * u * u + 4.0, 3.0 * w * w * w - 6.0 * w * w + 4.0, u * u * u];
        Row { first, values: values.map(|value| value / 6.0) }
    }
}

/// Information on the coefficients of gamma_1, gamma_2 (on one ground the same) and v_1, and on the first inclination, which
/// comes last.
struct Information {
    matrix: DMatrix<f64>,
    /// Derivatives of the present inclination by all of them.
    inclination: DVector<f64>,
    /// Where the coefficients of gamma_1, gamma_2 and v_1 begin.
    places: [usize; 3],
}

/// Partial derivatives of rate alpha' and speed v_2 by gamma_1, gamma_2, v_1 and alpha.
fn derivatives(distance: f64, truth: &Truth) -> [[f64; 4]; 2] {
    let alpha = truth.motion.inclination;
    let v1 = truth.motion.speeds[0];
    let [(sin1, cos1), (sin2, cos2)] = truth.angles.map(|gamma| (gamma - alpha).sin_cos());
    // v_2 = v_1 cos_1/cos_2 (2.29); alpha' = (v_2 sin_2 - v_1 sin_1)/l = v_1 (cos_1 tan_2 - sin_1)/l (2.30).
    let tan2 = sin2 / cos2;
    let by_first = -v1 * (sin1 * tan2 + cos1) / distance;
    let by_second = v1 * cos1 / (cos2 * cos2) / distance;
    let rate = [by_first, by_second, (cos1 * tan2 - sin1) / distance, -by_first - by_second];
    let (of_first, of_second) = (-v1 * sin1 / cos2, v1 * cos1 * tan2 / cos2);
    [rate, [of_first, of_second, cos1 / cos2, -of_first - of_second]]
}

impl Information {
    fn new(wave: &Wave, splines: &Splines, grounds: Grounds) -> Self {
        let count = splines.count;
        let places = match grounds {
            Grounds::Two => [0, count, 2 * count],
            Grounds::One => [0, 0, count],
        };
        let size = places[2] + count + 1;
        let mut matrix = DMatrix::zeros(size, size);
        let (angle, speed) = (wave.angle_deviation(), SPEED_DEVIATION * wave.speed);
        for k in 0..size {
            let deviation = if (places[2]..size - 1).contains(&k) { speed } else { angle };
            matrix[(k, k)] = 1.0 / (deviation * deviation);
        }
        let mut inclination = DVector::zeros(size);
        inclination[size - 1] = 1.0;
        Self { matrix, inclination, places }
    }

    /// The first inclination follows from the ground up to the way `front`: the line spans it, l d alpha is the integral of
    /// cos(gamma - alpha) d gamma.
    fn lay(&mut self, wave: &Wave, first: &Truth, splines: &Splines, front: f64) {
        self.inclination.fill(0.0);
        let mut x = 0.0;
        for part in 0..PARTS {
            let gamma = wave.slope(x);
            x += front / PARTS as f64 * gamma.cos();
            let row = splines.at((part as f64 + 0.5) * front / PARTS as f64);
            let weight = (gamma - first.motion.inclination).cos() * front / PARTS as f64 / wave.distance;
            for (k, value) in row.values.iter().enumerate() {
                self.inclination[row.first + k] += weight * value;
            }
        }
    }

    /// A linear function of the coefficients: `parts` of gamma_1, gamma_2, v_1 and the inclination. The speed is a spline of
    /// the rear wheel's way.
    fn combine(&self, parts: [f64; 4], rows: &[Row; 2]) -> DVector<f64> {
        let mut sum = &self.inclination * parts[3];
        for (which, part) in parts.iter().take(3).enumerate() {
            let row = if which == 1 { &rows[1] } else { &rows[0] };
            for (k, value) in row.values.iter().enumerate() {
                sum[self.places[which] + row.first + k] += part * value;
            }
        }
        sum
    }

    /// Adds `readings` readings of inclination, v_1 and v_2.
    fn read(&mut self, wave: &Wave, truth: &Truth, rows: &[Row; 2], readings: f64) {
        let [_, second] = derivatives(wave.distance, truth);
        let seen = [
            ([0.0, 0.0, 0.0, 1.0], wave.pitch_noise),
            ([0.0, 0.0, 1.0, 0.0], wave.speed_noise),
            (second, wave.speed_noise),
        ];
        for (parts, noise) in seen {
            let row = self.combine(parts, rows);
            self.matrix.syger(readings / (noise * noise), &row, &row, 1.0);
        }
    }

    /// The line turns for `step` s.
    fn turn(&mut self, wave: &Wave, truth: &Truth, rows: &[Row; 2], step: f64) {
        let [rate, _] = derivatives(wave.distance, truth);
        self.inclination = self.combine([rate[0] * step, rate[1] * step, rate[2] * step, 1.0 + rate[3] * step], rows);
    }

    fn factor(&self) -> Option<Known> {
        // `syger` fills the lower triangle, which is all that the factorisation reads.
        Some(Known { factor: Cholesky::new(self.matrix.clone())?, places: [self.places[0], self.places[1]] })
    }
}

/// What is known of the coefficients.
struct Known {
    factor: Cholesky<f64, Dyn>,
    /// Where those of gamma_1 and gamma_2 begin.
    places: [usize; 2],
}

impl Known {
    /// Adds the standard deviations of gamma_1 and gamma_2 at their places, rad.
    fn add(&self, rows: &[Row; 2], sums: &mut [MeanSquare; 2]) {
        for ((start, row), sum) in self.places.iter().zip(rows).zip(sums) {
            let mut function = DVector::zeros(self.factor.l_dirty().nrows());
            for (k, value) in row.values.iter().enumerate() {
                function[start + row.first + k] = *value;
            }
            sum.add(function.dot(&self.factor.solve(&function)).max(0.0).sqrt());
        }
    }
}
