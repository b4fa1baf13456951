//! An extended Kalman filter of the ground that all wheels of a rover cross one after the other.
//!
//! Wheels of one radius that follow each other on firm ground move their centres along one path. Estimated are the path's
//! slope at nodes between the wheels and a little beyond, a smooth random process of the way ([`Process`]), the place of
//! every wheel along the path, and every wheel's slip:
//!
//! ```text
//! d s_k = (1 - i_k) r (omega_k - rate of the body) dt          place of wheel k; encoders drive it, with their noise
//! |p(s_b) - p(s_a)| = l                                        (2.29) integrated: the points of a pair are l apart
//! atan2(p(s_b) - p(s_a)) = alpha                               (2.30) integrated: inclination of the pair, measured
//! ```
//!
//! with p(s) the integral of (cos gamma, sin gamma) along the path. The inclination is no state: it follows from the
//! path. So what a reading tells of the ground stays with the ground, and serves again when the next wheel gets
//! there. At rest nothing but the noise of the encoders moves, and a translation is no special case.

use super::filter::Innovation;
use super::pairs::Pair;
use super::process::{ORDER, Process};
use super::shape::{Layout, Quantity, Shape};
use crate::snapshot::Moving;

/// Nodes a correlation length, and between first and last wheel, at least.
const PER_LENGTH: f64 = 4.0;
const PER_ROVER: f64 = 12.0;
/// Most nodes; a longer rover has a coarser path.
const MOST_NODES: usize = 48;
/// Longest way along the path from the first to the last wheel, of their distance.
const DETOUR: f64 = 1.35;
/// Nodes beyond the foremost wheel.
const AHEAD: f64 = 2.0;
/// Standard deviation of the slope's mean over that about the mean, and the way over which it changes by as much, in
/// correlation lengths.
const MEAN_DEVIATION: f64 = 1.0;
const MEAN_LASTS: f64 = 20.0;
/// Standard deviation of the first speed, of the speed and its noise.
const FIRST_SPEED: f64 = 3.0;
/// Way over which squares of the slope's errors last, over that of the errors: 3.5/lambda of the correlation's square against twice
/// the correlation length.
const SQUARES_LAST: f64 = 0.6;
/// Least share of the rim's speed that a wheel moves at: beyond, it spins in place.
const LEAST_GRIP: f64 = 0.05;
/// Way to either side over which a rate is differentiated, in spacings of the nodes.
const DIFFERENCE: f64 = 0.05;
/// Readings over which the inclinations' innovations are averaged, and deviations of that mean beyond which the
/// estimate is lost. Chance does that once in a million independent means.
const WINDOW: f64 = 32.0;
const BIASED: f64 = 5.0;

/// What the filter of a ground believes.
#[derive(Clone, Debug, PartialEq)]
pub struct ProfileModel {
    /// Pairs of points that the wheels are in, each after those that it builds on.
    pub pairs: Vec<Pair>,
    /// Distance of every wheel's centre from the rearmost one, along the drawing, m.
    pub places: Vec<f64>,
    /// Standard deviation of the slope about its mean, rad.
    pub angle_deviation: f64,
    /// Way over which the autocorrelation of the slope falls to 1/e, m.
    pub correlation_length: f64,
    /// Standard deviation of the change of the speed within a second, a random walk, m/s.
    pub speed_drift: f64,
    /// Mean of the slips, their standard deviation, and the way over which they last, m.
    pub slip: f64,
    pub slip_deviation: f64,
    pub slip_length: f64,
    /// Other error of the speeds, share of the speed, which lasts as long as a slope does.
    pub kinematic_error: f64,
    /// Standard deviation of the height of a wheel's centre over the path that the others take, m; it lasts as long.
    pub path_deviation: f64,
    /// White error of the rates that the path makes, standard deviation, rad/s.
    pub rate_error: f64,
}

/// A reading of all wheels and pairs, each a value with its variance.
#[derive(Clone, Copy, Debug)]
pub struct ProfileReading<'a> {
    /// Inclination of every pair, rad.
    pub inclinations: &'a [[f64; 2]],
    /// Rate of every pair, rad/s, where it is measured.
    pub rates: Option<&'a [[f64; 2]]>,
    /// Speed of every wheel's rim past its centre, m/s.
    pub speeds: &'a [[f64; 2]],
}

/// The filter. A step allocates nothing.
#[derive(Clone, Debug)]
pub struct ProfileFilter {
    model: ProfileModel,
    layout: Layout,
    process: Process,
    state: Vec<f64>,
    covariance: Vec<f64>,
    /// Running means of the inclinations' normalised innovations.
    bias: Vec<f64>,
    /// Rates of the pairs' lines, rad/s; places of the wheels along the path, m.
    turning: Vec<f64>,
    places: Vec<f64>,
    /// Slopes under the wheels with their standard deviations, rad.
    angles: Vec<[f64; 2]>,
    restarts: u32,
    scratch: Scratch,
}

#[derive(Clone, Debug)]
struct Scratch {
    shape: Shape,
    beyond: Shape,
    row: Quantity,
    /// Of two wheels: travel less the line of the pair.
    apart: [Quantity; 2],
    column: Vec<f64>,
    rows: Vec<f64>,
}

impl Moving for ProfileFilter {
    fn save(&self, to: &mut crate::snapshot::Writer) {
        self.state.save(to);
        self.covariance.save(to);
        self.bias.save(to);
        self.turning.save(to);
        self.places.save(to);
        self.angles.save(to);
        self.restarts.save(to);
    }

    fn load(&mut self, from: &mut crate::snapshot::Reader) -> Result<(), crate::snapshot::SnapshotError> {
        self.state.load(from)?;
        self.covariance.load(from)?;
        self.bias.load(from)?;
        self.turning.load(from)?;
        self.places.load(from)?;
        self.angles.load(from)?;
        self.restarts.load(from)?;
        self.evaluate();
        Ok(())
    }
}

impl ProfileFilter {
    /// A filter that knows nothing but its model; its first reading is to be given to [`start`](Self::start).
    #[must_use]
    pub fn new(model: ProfileModel) -> Self {
        let span = model.places.iter().copied().fold(0.0, f64::max);
        let reach = DETOUR * span;
        let finest = (model.correlation_length / PER_LENGTH).min(span / PER_ROVER);
        let spacing = finest.max(reach / (MOST_NODES as f64 - 2.0 * AHEAD));
        let nodes = (reach / spacing).ceil() as usize + 1 + 2 * AHEAD as usize;
        let layout = Layout { nodes, wheels: model.places.len(), spacing };
        let (size, pairs) = (layout.size(), model.pairs.len());
        Self {
            process: Process::new(model.angle_deviation, model.correlation_length, spacing),
            state: vec![0.0; size],
            covariance: vec![0.0; size * size],
            bias: vec![0.0; pairs],
            turning: vec![0.0; pairs],
            places: vec![0.0; layout.wheels],
            angles: vec![[0.0; 2]; layout.wheels],
            restarts: 0,
            scratch: Scratch {
                shape: Shape::new(&layout, &model.pairs),
                beyond: Shape::new(&layout, &model.pairs),
                row: Quantity::new(size),
                apart: [Quantity::new(size), Quantity::new(size)],
                column: vec![0.0; size],
                rows: vec![0.0; size * ORDER],
            },
            layout,
            model,
        }
    }

    /// Begins anew at a reading, on a straight path along the lines of the pairs.
    pub fn start(&mut self, reading: &ProfileReading) {
        let (model, layout) = (&self.model, self.layout);
        let (mut sum, mut count) = (0.0, 0.0);
        for (pair, [inclination, _]) in model.pairs.iter().zip(reading.inclinations).filter(|(pair, _)| pair.carries) {
            sum += inclination - pair.inclination;
            count += 1.0;
        }
        let mean = sum / count;
        self.state.fill(0.0);
        self.covariance.fill(0.0);
        self.bias.fill(0.0);
        self.turning.fill(0.0);
        self.state[..layout.nodes].fill(mean);
        let (size, at) = (layout.size(), layout.mean());
        self.state[at] = mean;
        self.covariance[at * size + at] = (MEAN_DEVIATION * model.angle_deviation).powi(2);
        let span = model.places.iter().copied().fold(0.0, f64::max);
        let rearmost = (layout.nodes as f64 - 1.0 - AHEAD) * layout.spacing - span;
        let first = self.scratch.shape.first();
        for (wheel, place) in model.places.iter().enumerate() {
            self.places[wheel] = rearmost + place;
            let slip = layout.slip(wheel);
            self.state[slip] = model.slip;
            self.covariance[slip * (size + 1)] = model.slip_deviation.powi(2);
        }
        self.state[layout.place()] = self.places[first];
        let [speed, variance] = reading.speeds[first];
        self.state[layout.speed()] = speed;
        self.covariance[layout.speed() * (size + 1)] = FIRST_SPEED * FIRST_SPEED * (speed * speed + variance);
        self.first_node();
        for node in 1..layout.nodes {
            self.append(node);
        }
        self.read(0.0, reading);
    }

    /// Prediction over `dt` seconds and update by a reading.
    pub fn step(&mut self, dt: f64, reading: &ProfileReading) -> Innovation {
        self.predict(dt);
        self.slide();
        let innovation = self.read(dt, reading);
        if self.lost() {
            let restarts = self.restarts.saturating_add(1);
            self.start(reading);
            self.restarts = restarts;
        }
        innovation
    }

    fn size(&self) -> usize {
        self.layout.size()
    }

    /// The covariance of the first node with the derivatives there; the other nodes follow.
    fn first_node(&mut self) {
        let (size, layout) = (self.size(), self.layout);
        let entry = |order: usize| if order == 0 { 0 } else { layout.head(order) };
        for a in 0..ORDER {
            for b in 0..ORDER {
                self.covariance[entry(a) * size + entry(b)] = self.process.stationary[(a, b)];
            }
        }
        let mean = layout.mean();
        let of_mean = self.covariance[mean * size + mean];
        self.covariance[0] += of_mean;
        self.covariance[mean] = of_mean;
        self.covariance[mean * size] = of_mean;
    }

    /// Node `node` from the one before it, and the derivatives from those there.
    fn append(&mut self, node: usize) {
        let layout = self.layout;
        let mut source = [node - 1; ORDER];
        let mut target = [node; ORDER];
        for order in 1..ORDER {
            source[order] = layout.head(order);
            target[order] = layout.head(order);
        }
        let transition = self.process.transition;
        self.replace(source, target, |a, b| transition[(a, b)], self.process.news);
        let mean = layout.mean() * (self.size() + 1);
        let drift = MEAN_DEVIATION * self.model.angle_deviation;
        self.covariance[mean] += drift * drift * layout.spacing / (MEAN_LASTS * self.model.correlation_length);
    }

    /// Makes the entries `target` the `factors` times the entries `source`, the first of each counted from the mean
    /// slope, with `news` added.
    fn replace(
        &mut self,
        source: [usize; ORDER],
        target: [usize; ORDER],
        factors: impl Fn(usize, usize) -> f64,
        news: super::process::Derivatives,
    ) {
        let (size, mean) = (self.size(), self.layout.mean());
        // A row of the linear map: source[b] has factors(a, b), the mean what the slope's part leaves.
        let of_mean = |a: usize| if a == 0 { 1.0 - factors(0, 0) } else { -factors(a, 0) };
        let map = |a: usize, of: &dyn Fn(usize) -> f64| {
            of_mean(a) * of(mean) + (0..ORDER).map(|b| factors(a, b) * of(source[b])).sum::<f64>()
        };
        let values: [f64; ORDER] = std::array::from_fn(|a| map(a, &|entry| self.state[entry]));
        for a in 0..ORDER {
            for column in 0..size {
                self.scratch.rows[a * size + column] = map(a, &|entry| self.covariance[entry * size + column]);
            }
        }
        let rows = &self.scratch.rows;
        let corner: [[f64; ORDER]; ORDER] = std::array::from_fn(|a| {
            std::array::from_fn(|b| news[(a, b)] + map(b, &|entry| rows[a * size + entry]))
        });
        for a in 0..ORDER {
            self.state[target[a]] = values[a];
            for column in 0..size {
                let value = self.scratch.rows[a * size + column];
                self.covariance[target[a] * size + column] = value;
                self.covariance[column * size + target[a]] = value;
            }
        }
        for a in 0..ORDER {
            for b in 0..ORDER {
                self.covariance[target[a] * size + target[b]] = 0.5 * (corner[a][b] + corner[b][a]);
            }
        }
    }

    /// Moves the nodes on so that the foremost wheel is before the last of them, or back so that the rearmost is behind the
    /// first.
    fn slide(&mut self) {
        let layout = self.layout;
        let end = (layout.nodes - 1) as f64 * layout.spacing;
        // Further than all nodes a reading takes no wheel.
        for _ in 0..layout.nodes {
            let rear = self.places.iter().copied().fold(f64::MAX, f64::min);
            let front = self.places.iter().copied().fold(f64::MIN, f64::max);
            if front > end - layout.spacing {
                self.shift(true);
                self.append(layout.nodes - 1);
            } else if rear < 0.5 * layout.spacing && front < end - 2.5 * layout.spacing {
                self.shift(false);
                self.prepend();
            } else {
                break;
            }
        }
    }

    /// Drops the first node (or the last), all others moving up (or down) by one place.
    fn shift(&mut self, onwards: bool) {
        let (size, nodes) = (self.size(), self.layout.nodes);
        let by = if onwards { -self.layout.spacing } else { self.layout.spacing };
        self.state[self.layout.place()] += by;
        self.places.iter_mut().for_each(|place| *place += by);
        let from = |k: usize| if k < nodes { if onwards { k + 1 } else { k - 1 } } else { k };
        let moved = |k: usize| k >= nodes || if onwards { k + 1 < nodes } else { k > 0 };
        let order = |k: usize| if onwards { k } else { size - 1 - k };
        for a in (0..size).map(order).filter(|&a| moved(a)) {
            if a < nodes {
                self.state[a] = self.state[from(a)];
            }
            for b in (0..size).map(order).filter(|&b| moved(b)) {
                self.covariance[a * size + b] = self.covariance[from(a) * size + from(b)];
            }
        }
    }

    /// A new first node, and derivatives at the node that is the last one now.
    fn prepend(&mut self) {
        let layout = self.layout;
        let (last, h) = (layout.nodes - 1, layout.spacing);
        let zero = super::process::Derivatives::zeros();
        let mut source = [1; ORDER];
        let mut target = [0; ORDER];
        for order in 1..ORDER {
            source[order] = layout.head(order);
            target[order] = layout.head(order);
        }
        let (kept, variance) = (self.process.correlation, self.process.stationary[(0, 0)]);
        let mut news = zero;
        news[(0, 0)] = variance * (1.0 - kept * kept);
        // Derivatives of a slope that is known at the last two nodes: their difference, and what it was not known by.
        for order in 1..ORDER {
            news[(order, order)] = self.process.stationary[(order, order)];
        }
        self.replace(source, target, |a, b| if a == 0 && b == 0 { kept } else { 0.0 }, news);
        let _ = (last, h);
    }

    /// The first wheel moves on, its speed walks randomly, and slips tend to their mean along the way.
    fn predict(&mut self, dt: f64) {
        let (size, layout) = (self.size(), self.layout);
        let (place, speed) = (layout.place(), layout.speed());
        let way = self.state[speed] * dt;
        self.state[place] += way;
        self.places.iter_mut().for_each(|place| *place += way);
        for k in 0..size {
            self.covariance[place * size + k] += dt * self.covariance[speed * size + k];
        }
        for k in 0..size {
            self.covariance[k * size + place] += dt * self.covariance[k * size + speed];
        }
        self.covariance[speed * (size + 1)] += self.model.speed_drift.powi(2) * dt;
        let kept = (-way.abs() / self.model.slip_length).exp();
        for slip in (0..layout.wheels).map(|wheel| layout.slip(wheel)) {
            self.state[slip] = self.model.slip + kept * (self.state[slip] - self.model.slip);
            for k in 0..size {
                self.covariance[slip * size + k] *= kept;
            }
            for k in 0..size {
                self.covariance[k * size + slip] *= kept;
            }
            self.covariance[slip * (size + 1)] += self.model.slip_deviation.powi(2) * (1.0 - kept * kept);
        }
        self.evaluate();
        self.keep_places();
    }

    fn evaluate(&mut self) {
        self.scratch.shape.evaluate(&self.model.pairs, &self.state, 0.0, &self.places);
    }

    fn keep_places(&mut self) {
        self.places.iter_mut().zip(&self.scratch.shape.places).for_each(|(place, found)| *place = found.value);
    }

    fn keep_angles(&mut self) {
        let Self { covariance, scratch, angles, .. } = self;
        let Scratch { shape, row, column, .. } = scratch;
        for (wheel, angle) in angles.iter_mut().enumerate() {
            shape.slope(wheel, row);
            times(covariance, &row.by, column);
            let variance: f64 = row.by.iter().zip(column.iter()).map(|(by, entry)| by * entry).sum();
            *angle = [row.value, variance.max(0.0).sqrt()];
        }
    }

    /// Takes a reading in.
    fn read(&mut self, dt: f64, reading: &ProfileReading) -> Innovation {
        let mut innovation = Innovation::default();
        let mut add = |nis: f64| {
            innovation.nis += nis;
            innovation.count += 1;
        };
        let way = self.state[self.layout.speed()].abs() * dt;
        // An error that is correlated over a way has the density of white noise twice that way over a reading's way.
        let lasting = if way > 0.0 { (2.0 * self.model.correlation_length / way).max(1.0) } else { 1.0 };
        for (wheel, [speed, variance]) in reading.speeds.iter().enumerate() {
            self.rim_speed(wheel);
            let [mean, spread] = self.beyond_first_order(wheel);
            let error = self.model.kinematic_error * speed;
            let lasting = lasting * (error * error + SQUARES_LAST * spread * speed * speed);
            add(self.absorb(speed - self.scratch.row.value - mean * speed, variance + lasting));
        }
        for k in 0..self.model.pairs.len() {
            if !self.model.pairs[k].carries {
                continue;
            }
            self.evaluate();
            let [value, variance] = reading.inclinations[k];
            let tilt = self.model.path_deviation / self.model.pairs[k].distance;
            let line = &self.scratch.shape.inclinations[k];
            self.scratch.row.by.copy_from_slice(&line.by);
            let innovation = value - line.value;
            let normalised = self.absorb(innovation, variance + lasting * tilt * tilt);
            self.bias[k] += (normalised.sqrt().copysign(innovation) - self.bias[k]) / WINDOW;
            add(normalised);
        }
        for k in 0..self.model.pairs.len() {
            if let (Some(rates), true) = (reading.rates, self.model.pairs[k].carries) {
                self.rate(k);
                let [value, variance] = rates[k];
                let error = self.model.rate_error;
                add(self.absorb(value - self.scratch.row.value, variance + error * error));
            }
            self.rate(k);
            self.turning[k] = self.scratch.row.value;
        }
        self.evaluate();
        self.keep_places();
        self.keep_angles();
        innovation
    }

    /// What a function of the path changes by within a second, with its derivatives, into the row.
    fn change(&mut self, of: impl Fn(&Shape) -> &Quantity) {
        let Self { layout, model, state, scratch, places, .. } = self;
        let Scratch { shape, beyond, row, .. } = scratch;
        let step = DIFFERENCE * layout.spacing;
        shape.evaluate(&model.pairs, state, -step, places);
        beyond.evaluate(&model.pairs, state, step, places);
        let (before, after) = (of(shape), of(beyond));
        let speed = state[layout.speed()];
        let by_way = (after.value - before.value) / (2.0 * step);
        row.value = speed * by_way;
        for (entry, by) in row.by.iter_mut().enumerate() {
            *by = speed * (after.by[entry] - before.by[entry]) / (2.0 * step);
        }
        row.by[layout.speed()] = by_way;
    }

    /// Rate of a pair's line.
    fn rate(&mut self, k: usize) {
        self.change(|shape| &shape.inclinations[k]);
    }

    /// Speed of a wheel's rim past its centre.
    fn rim_speed(&mut self, wheel: usize) {
        self.change(|shape| &shape.places[wheel]);
        let slip = self.layout.slip(wheel);
        let grip = (1.0 - self.state[slip]).max(LEAST_GRIP);
        let row = &mut self.scratch.row;
        row.value /= grip;
        row.by.iter_mut().for_each(|by| *by /= grip);
        row.by[slip] = row.value / grip;
    }

    /// Mean and variance of the second-order part of a wheel's speed, shares of it. A speed goes with the cosines of the angles
    /// between travel and line at both ends of a pair (2.29), and the error of a cosine is half the square of that of its
    /// angle: known angles make a speed tell of the ground, unknown ones would make it tell too much.
    fn beyond_first_order(&mut self, wheel: usize) -> [f64; 2] {
        let first = self.scratch.shape.first();
        if wheel == first {
            return [0.0; 2];
        }
        let Self { covariance, scratch, .. } = self;
        let Scratch { shape, column, apart, .. } = scratch;
        for (row, wheel) in apart.iter_mut().zip([wheel, first]) {
            shape.slope(wheel, row);
            let line = &shape.inclinations[shape.pair_of(wheel)];
            row.by.iter_mut().zip(&line.by).for_each(|(by, of_line)| *by -= of_line);
        }
        let [own, others] = &*apart;
        let mut variances = [0.0; 3];
        for (which, (left, right)) in [(own, own), (others, others), (own, others)].into_iter().enumerate() {
            if which != 2 {
                times(covariance, &right.by, column);
            }
            // The third product takes the second column: of the first wheel.
            variances[which] = left.by.iter().zip(column.iter()).map(|(by, entry)| by * entry).sum();
        }
        let [of_own, of_first, joint] = variances;
        [0.5 * (of_own - of_first), 0.5 * (of_own * of_own + of_first * of_first - 2.0 * joint * joint).max(0.0)]
    }

    /// Takes a measurement in whose derivatives are in the row; its normalised innovation squared.
    fn absorb(&mut self, innovation: f64, variance: f64) -> f64 {
        let size = self.size();
        let Scratch { row, column, .. } = &mut self.scratch;
        times(&self.covariance, &row.by, column);
        let total = variance + row.by.iter().zip(column.iter()).map(|(by, entry)| by * entry).sum::<f64>();
        for (k, entry) in column.iter().enumerate() {
            let gain = entry / total;
            self.state[k] += gain * innovation;
            for (place, other) in self.covariance[k * size..(k + 1) * size].iter_mut().zip(column.iter()) {
                *place -= gain * other;
            }
        }
        innovation * innovation / total
    }

    fn lost(&self) -> bool {
        let biased = self.bias.iter().any(|bias| bias.abs() * (2.0 * WINDOW).sqrt() > BIASED);
        biased || self.state.iter().any(|entry| !entry.is_finite())
    }

    /// Slope under a wheel with its standard deviation, rad.
    #[must_use]
    pub fn angle(&self, wheel: usize) -> [f64; 2] {
        self.angles[wheel]
    }

    /// Covariance of the slopes under two wheels, rad^2.
    #[must_use]
    pub fn covariance(&self, a: usize, b: usize) -> f64 {
        let size = self.size();
        let (mut one, mut two, mut column) = (Quantity::new(size), Quantity::new(size), vec![0.0; size]);
        self.scratch.shape.slope(a, &mut one);
        self.scratch.shape.slope(b, &mut two);
        times(&self.covariance, &two.by, &mut column);
        one.by.iter().zip(&column).map(|(by, entry)| by * entry).sum()
    }

    /// What the line of a pair turns at, rad/s.
    #[must_use]
    pub fn turning(&self, pair: usize) -> f64 {
        self.turning[pair]
    }

    /// Estimated slip of a wheel and its standard deviation.
    #[must_use]
    pub fn slip(&self, wheel: usize) -> [f64; 2] {
        let entry = self.layout.slip(wheel);
        [self.state[entry], self.covariance[entry * (self.size() + 1)].max(0.0).sqrt()]
    }

    /// How often it has lost its way and started anew.
    #[must_use]
    pub fn restarts(&self) -> u32 {
        self.restarts
    }
}

/// Product of a symmetric matrix with a vector that is mostly zero.
fn times(matrix: &[f64], vector: &[f64], product: &mut [f64]) {
    product.fill(0.0);
    let size = product.len();
    for (k, factor) in vector.iter().enumerate().filter(|(_, factor)| **factor != 0.0) {
        for (sum, entry) in product.iter_mut().zip(&matrix[k * size..(k + 1) * size]) {
            *sum += factor * entry;
        }
    }
}
