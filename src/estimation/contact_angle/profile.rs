//! An extended Kalman filter of the ground that all wheels of a rover cross one after the other.
//!
//! Wheels of one radius that follow each other on firm ground move their centres along one path. Estimated are the path's
//! slope at nodes between the wheels and a little beyond, a smooth random process of the way (Matern, smoothness 5/2); place s and speed u
//! of one wheel along the path; and every wheel's slip i. All else follows from these: the other wheels' places, inclinations
//! and rates of the lines between the points of pairs, and speeds:
//!
//! ```text
//! p(s)  = integral of (cos gamma, sin gamma) along the path
//! |p(s_b) - p(s_a)| = l                    where the other wheel of a pair is: (2.29) integrated
//! alpha = atan2(p(s_b) - p(s_a))           inclination of the pair's line, measured: (2.30) integrated
//! alpha' = u d alpha/d s                   its rate, where it is measured
//! v_k = u (d s_k/d s) / (1 - i_k)          speed of wheel k's rim, measured
//! ```
//!
//! So what a reading tells of the ground stays with the ground, and serves again when the next wheel gets there. At rest
//! no reading but the inclination tells of the ground, and a translation is no special case. Speed and rate are products of
//! what is estimated: of their second order the mean is counted, and the variance as an error that lasts as long as the
//! ground's does.

mod model;
mod second_order;

pub use model::{ProfileModel, ProfileReading};

use super::filter::Innovation;
use super::shape::{Layout, Quantity, Shape};
use super::window::Window;
use crate::snapshot::{Moving, Reader, SnapshotError, Writer};

/// Nodes a correlation length, and between first and last wheel, at least.
const PER_LENGTH: f64 = 4.0;
const PER_ROVER: f64 = 12.0;
/// Most nodes; a longer rover has a coarser path.
const MOST_NODES: usize = 48;
/// Longest way along the path from the first to the last wheel, of their distance.
const DETOUR: f64 = 1.35;
/// Nodes beyond the foremost wheel.
const AHEAD: f64 = 2.0;
/// Standard deviation of the first speed, of the speed and its noise.
const FIRST_SPEED: f64 = 3.0;
/// Least share of the rim's speed that a wheel moves at: beyond, it spins in place.
const LEAST_GRIP: f64 = 0.05;
/// Way to either side over which a rate is differentiated, in spacings of the nodes.
const DIFFERENCE: f64 = 0.05;
/// Readings over which the inclinations' innovations are averaged, and deviations of that mean beyond which the
/// estimate is lost. Chance does that once in a million independent means.
const WINDOW: f64 = 32.0;
const BIASED: f64 = 5.0;

/// The filter. A step allocates nothing.
#[derive(Clone, Debug)]
pub struct ProfileFilter {
    model: ProfileModel,
    layout: Layout,
    window: Window,
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
}

impl Moving for ProfileFilter {
    fn save(&self, to: &mut Writer) {
        self.window.save(to);
        self.bias.save(to);
        self.turning.save(to);
        self.places.save(to);
        self.angles.save(to);
        self.restarts.save(to);
    }

    fn load(&mut self, from: &mut Reader) -> Result<(), SnapshotError> {
        self.window.load(from)?;
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
    ///
    /// The first of the model's pairs is of two wheels, and every later one has one wheel that is in none before it.
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
            window: Window::new(layout, model.angle_deviation, model.correlation_length),
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
            },
            layout,
            model,
        }
    }

    /// Begins anew at a reading, on a straight path along the lines of the pairs.
    pub fn start(&mut self, reading: &ProfileReading) {
        let (model, layout) = (&self.model, self.layout);
        let (mut sum, mut count) = (0.0, 0.0);
        for (pair, [inclination, _]) in model.pairs.iter().zip(reading.inclinations) {
            sum += inclination - pair.inclination;
            count += 1.0;
        }
        self.window.start(sum / count);
        self.bias.fill(0.0);
        self.turning.fill(0.0);
        let span = model.places.iter().copied().fold(0.0, f64::max);
        let rearmost = (layout.nodes as f64 - 1.0 - AHEAD) * layout.spacing - span;
        let first = self.scratch.shape.first();
        for (wheel, place) in model.places.iter().enumerate() {
            self.places[wheel] = rearmost + place;
            let slip = layout.slip(wheel);
            self.window.state[slip] = model.slip;
            self.window.add_variance(slip, model.slip_deviation.powi(2));
        }
        self.window.state[layout.place()] = self.places[first];
        let [speed, variance] = reading.speeds[first];
        self.window.state[layout.speed()] = speed;
        self.window.add_variance(layout.speed(), FIRST_SPEED * FIRST_SPEED * (speed * speed + variance));
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
                self.window.move_on();
                self.relabel(-layout.spacing);
            } else if rear < 0.5 * layout.spacing && front < end - 2.5 * layout.spacing {
                self.window.move_back();
                self.relabel(layout.spacing);
            } else {
                break;
            }
        }
    }

    /// Places count from the first node, which has changed.
    fn relabel(&mut self, by: f64) {
        self.window.state[self.layout.place()] += by;
        self.places.iter_mut().for_each(|place| *place += by);
    }

    /// The first wheel moves on, its speed walks randomly, and slips tend to their mean along the way.
    fn predict(&mut self, dt: f64) {
        let layout = self.layout;
        let (place, speed) = (layout.place(), layout.speed());
        let way = self.window.state[speed] * dt;
        self.window.state[place] += way;
        self.places.iter_mut().for_each(|place| *place += way);
        self.window.mix(place, 1.0, dt, speed);
        self.window.add_variance(speed, self.model.speed_drift.powi(2) * dt);
        let kept = (-way.abs() / self.model.slip_length).exp();
        for slip in (0..layout.wheels).map(|wheel| layout.slip(wheel)) {
            self.window.state[slip] = self.model.slip + kept * (self.window.state[slip] - self.model.slip);
            self.window.mix(slip, kept, 0.0, slip);
            self.window.add_variance(slip, self.model.slip_deviation.powi(2) * (1.0 - kept * kept));
        }
        self.evaluate();
        self.keep_places();
    }

    fn evaluate(&mut self) {
        self.scratch.shape.evaluate(&self.model.pairs, &self.window.state, 0.0, &self.places);
    }

    fn keep_places(&mut self) {
        self.places.iter_mut().zip(&self.scratch.shape.places).for_each(|(place, found)| *place = found.value);
    }

    fn keep_angles(&mut self) {
        let Self { window, scratch, angles, .. } = self;
        let Scratch { shape, row, column, .. } = scratch;
        for (wheel, angle) in angles.iter_mut().enumerate() {
            shape.slope(wheel, row);
            window.column(&row.by, column);
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
        let way = self.window.state[self.layout.speed()].abs() * dt;
        // An error that is correlated over a way has the density of white noise twice that way over a reading's way.
        let lasting = if way > 0.0 { (2.0 * self.model.correlation_length / way).max(1.0) } else { 1.0 };
        for (wheel, [speed, variance]) in reading.speeds.iter().enumerate() {
            self.rim_speed(wheel);
            let [mean, spread] = self.speed_beyond_first_order(wheel);
            let error = self.model.kinematic_error * speed;
            let lasting = lasting * (error * error + spread * speed * speed);
            add(self.absorb(speed - self.scratch.row.value - mean * speed, variance + lasting));
        }
        for k in 0..self.model.pairs.len() {
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
            if let Some(rates) = reading.rates {
                self.rate(k);
                let [value, variance] = rates[k];
                let error = self.model.rate_error;
                let [mean, spread] = self.rate_beyond_first_order();
                let tilt = self.model.path_deviation / self.model.pairs[k].distance;
                let tilting = tilt * self.window.state[self.layout.speed()] / self.model.correlation_length;
                let lasting = lasting * (tilting * tilting + spread);
                add(self.absorb(value - mean - self.scratch.row.value, variance + error * error + lasting));
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
        let Self { layout, model, window, scratch, places, .. } = self;
        let state = &window.state;
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
        let grip = (1.0 - self.window.state[slip]).max(LEAST_GRIP);
        let row = &mut self.scratch.row;
        row.value /= grip;
        row.by.iter_mut().for_each(|by| *by /= grip);
        row.by[slip] = row.value / grip;
    }

    /// Takes a measurement in whose derivatives are in the row; its normalised innovation squared.
    fn absorb(&mut self, innovation: f64, variance: f64) -> f64 {
        self.window.absorb(&self.scratch.row.by, innovation, variance)
    }

    /// Whether the inclinations do not go the estimate's way.
    fn lost(&self) -> bool {
        let biased = self.bias.iter().any(|bias| bias.abs() * (2.0 * WINDOW).sqrt() > BIASED);
        biased || self.window.state.iter().any(|entry| !entry.is_finite())
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
        self.window.column(&two.by, &mut column);
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
        [self.window.state[entry], self.window.variance(entry).max(0.0).sqrt()]
    }

    /// How often it has lost its way and started anew.
    #[must_use]
    pub fn restarts(&self) -> u32 {
        self.restarts
    }
}
