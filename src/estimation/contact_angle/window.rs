//! The estimated vector with its covariance, over nodes of a path that move along with the rover.

use super::process::{Derivatives, ORDER, Process};
use super::shape::Layout;
use crate::snapshot::{Moving, Reader, SnapshotError, Writer};

/// Standard deviation of the slope's mean over that about the mean, and the way over which it changes by as much, in
/// correlation lengths.
const MEAN_DEVIATION: f64 = 1.0;
const MEAN_LASTS: f64 = 20.0;

/// The estimated vector and its covariance, row by row.
#[derive(Clone, Debug)]
pub(super) struct Window {
    layout: Layout,
    process: Process,
    /// Standard deviation of the mean slope at the start, rad, and the variance that it gains from node to node.
    mean_deviation: f64,
    mean_drift: f64,
    pub state: Vec<f64>,
    covariance: Vec<f64>,
    column: Vec<f64>,
    rows: Vec<f64>,
}

impl Moving for Window {
    fn save(&self, to: &mut Writer) {
        self.state.save(to);
        self.covariance.save(to);
    }

    fn load(&mut self, from: &mut Reader) -> Result<(), SnapshotError> {
        self.state.load(from)?;
        self.covariance.load(from)
    }
}

impl Window {
    /// Of a slope with standard deviation `deviation`, rad, and correlation length `length`, m, about its mean.
    pub fn new(layout: Layout, deviation: f64, length: f64) -> Self {
        let size = layout.size();
        let mean_deviation = MEAN_DEVIATION * deviation;
        Self {
            process: Process::new(deviation, length, layout.spacing),
            mean_deviation,
            mean_drift: mean_deviation * mean_deviation * layout.spacing / (MEAN_LASTS * length),
            state: vec![0.0; size],
            covariance: vec![0.0; size * size],
            column: vec![0.0; size],
            rows: vec![0.0; size * ORDER],
            layout,
        }
    }

    fn size(&self) -> usize {
        self.layout.size()
    }

    /// A ground of slope `mean`, known as well as the process has it; all else zero and certain.
    pub fn start(&mut self, mean: f64) {
        self.state.fill(0.0);
        self.covariance.fill(0.0);
        self.state[..self.layout.nodes].fill(mean);
        self.state[self.layout.mean()] = mean;
        self.add_variance(self.layout.mean(), self.mean_deviation * self.mean_deviation);
        self.first_node();
        for node in 1..self.layout.nodes {
            self.append(node);
        }
    }

    /// Adds to the variance of an entry.
    pub fn add_variance(&mut self, entry: usize, variance: f64) {
        let diagonal = entry * (self.size() + 1);
        self.covariance[diagonal] += variance;
    }

    pub fn variance(&self, entry: usize) -> f64 {
        self.covariance[entry * (self.size() + 1)]
    }

    /// An entry becomes `kept` times itself plus `factor` times another one, in the covariance.
    pub fn mix(&mut self, entry: usize, kept: f64, factor: f64, other: usize) {
        let size = self.size();
        for k in 0..size {
            let at = entry * size + k;
            self.covariance[at] = kept * self.covariance[at] + factor * self.covariance[other * size + k];
        }
        for k in 0..size {
            let at = k * size + entry;
            self.covariance[at] = kept * self.covariance[at] + factor * self.covariance[k * size + other];
        }
    }

    /// Covariance of a linear function of the entries with every one of them.
    pub fn column(&self, row: &[f64], column: &mut [f64]) {
        times(&self.covariance, row, column);
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
        self.add_variance(layout.mean(), self.mean_drift);
    }

    /// Makes the entries `target` the `factors` times the entries `source`, the first of each counted from the mean
    /// slope, with `news` added.
    fn replace(
        &mut self,
        source: [usize; ORDER],
        target: [usize; ORDER],
        factors: impl Fn(usize, usize) -> f64,
        news: Derivatives,
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
                self.rows[a * size + column] = map(a, &|entry| self.covariance[entry * size + column]);
            }
        }
        let rows = &self.rows;
        let corner: [[f64; ORDER]; ORDER] =
            std::array::from_fn(|a| std::array::from_fn(|b| news[(a, b)] + map(b, &|entry| rows[a * size + entry])));
        for a in 0..ORDER {
            self.state[target[a]] = values[a];
            for column in 0..size {
                let value = self.rows[a * size + column];
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

    /// Drops the first node and adds one behind the last, all others moving up by one place.
    pub fn move_on(&mut self) {
        self.shift(true);
        self.append(self.layout.nodes - 1);
    }

    /// Drops the last node and adds one before the first, all others moving down by one place.
    pub fn move_back(&mut self) {
        self.shift(false);
        self.prepend();
    }

    /// Moves the nodes up (or down) by one place.
    fn shift(&mut self, onwards: bool) {
        let (size, nodes) = (self.size(), self.layout.nodes);
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

    /// A new first node, as the process has it before the second one; at the node that is the last one now the derivatives are
    /// unknown.
    fn prepend(&mut self) {
        let layout = self.layout;
        let mut source = [1; ORDER];
        let mut target = [0; ORDER];
        for order in 1..ORDER {
            source[order] = layout.head(order);
            target[order] = layout.head(order);
        }
        let kept = self.process.correlation;
        let mut news = Derivatives::from_diagonal(&self.process.stationary.diagonal());
        news[(0, 0)] *= 1.0 - kept * kept;
        self.replace(source, target, |a, b| if a == 0 && b == 0 { kept } else { 0.0 }, news);
    }

    /// Takes a measurement in whose derivatives by the entries are `row`; its normalised innovation squared.
    pub fn absorb(&mut self, row: &[f64], innovation: f64, variance: f64) -> f64 {
        let size = self.size();
        let column = &mut self.column;
        times(&self.covariance, row, column);
        let total = variance + row.iter().zip(column.iter()).map(|(by, entry)| by * entry).sum::<f64>();
        for (k, entry) in column.iter().enumerate() {
            let gain = entry / total;
            self.state[k] += gain * innovation;
            for (place, other) in self.covariance[k * size..(k + 1) * size].iter_mut().zip(column.iter()) {
                *place -= gain * other;
            }
        }
        innovation * innovation / total
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
