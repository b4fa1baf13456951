//! Replanning while the rover drives and its map changes: D* Lite (Koenig and Likhachev 2002), which section 5.2 of the thesis
//! suggests for its kind (Stentz 1994). A search is repaired where costs have changed, not made again.

use std::cmp::{Ordering, Reverse};
use std::collections::BinaryHeap;

const STEPS: [(isize, isize); 8] = [(1, 0), (1, 1), (0, 1), (-1, 1), (-1, 0), (-1, -1), (0, -1), (1, -1)];

/// Order of the queue: first by the estimate of the whole way, then by that of the rest.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Key(f64, f64);

impl Eq for Key {}

impl Ord for Key {
    fn cmp(&self, other: &Self) -> Ordering {
        self.0.total_cmp(&other.0).then(self.1.total_cmp(&other.1))
    }
}

impl PartialOrd for Key {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

/// Why a grid cannot be planned on.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum IncrementalError {
    /// The number of costs is wrong.
    #[error("{got} costs were given for {columns} x {rows} nodes")]
    Count {
        /// Costs given.
        got: usize,
        /// Nodes along x.
        columns: usize,
        /// Nodes along y.
        rows: usize,
    },
    /// A node is off the grid.
    #[error("node ({column}, {row}) is off the grid")]
    OffGrid {
        /// Column.
        column: usize,
        /// Row.
        row: usize,
    },
    /// A cost is too small.
    #[error("a cost of {cost}; expected at least the smallest cost {least}, by which the way left is estimated")]
    Cost {
        /// The cost.
        cost: f64,
        /// The smallest allowed.
        least: f64,
    },
}

/// The cheapest way of a moving rover to a goal over a grid whose costs change.
///
/// A step between neighbours (eight directions) costs its length in spacings times the mean of both nodes' costs.
#[derive(Clone, Debug)]
pub struct IncrementalSearch {
    columns: usize,
    rows: usize,
    cost: Vec<f64>,
    least: f64,
    rover: usize,
    goal: usize,
    /// Cost to the goal as the queue last settled it, and one step ahead of that.
    settled: Vec<f64>,
    ahead: Vec<f64>,
    /// Key under which a node waits in the queue.
    waiting: Vec<Option<Key>>,
    queue: BinaryHeap<Reverse<(Key, usize)>>,
    /// What the rover's moves have taken from the estimates.
    moved: f64,
    expanded: usize,
}

impl IncrementalSearch {
    /// A search over `costs` (row by row; infinite where the rover cannot go), each at least `least` > 0, from `rover` to `goal`
    /// (column, row).
    ///
    /// # Errors
    /// [`IncrementalError`] where the numbers do not fit.
    pub fn new(
        [columns, rows]: [usize; 2],
        costs: Vec<f64>,
        least: f64,
        rover: (usize, usize),
        goal: (usize, usize),
    ) -> Result<Self, IncrementalError> {
        if costs.len() != columns * rows {
            return Err(IncrementalError::Count { got: costs.len(), columns, rows });
        }
        let allowed = |cost: &f64| least > 0.0 && *cost >= least;
        if let Some(&cost) = costs.iter().find(|cost| !allowed(cost)) {
            return Err(IncrementalError::Cost { cost, least });
        }
        let nodes = costs.len();
        let mut search = Self {
            columns,
            rows,
            cost: costs,
            least,
            rover: 0,
            goal: 0,
            settled: vec![f64::INFINITY; nodes],
            ahead: vec![f64::INFINITY; nodes],
            waiting: vec![None; nodes],
            queue: BinaryHeap::new(),
            moved: 0.0,
            expanded: 0,
        };
        search.rover = search.node(rover)?;
        search.goal = search.node(goal)?;
        search.ahead[search.goal] = 0.0;
        search.put(search.goal);
        Ok(search)
    }

    /// The rover is now at this node.
    ///
    /// # Errors
    /// [`IncrementalError::OffGrid`].
    pub fn move_to(&mut self, rover: (usize, usize)) -> Result<(), IncrementalError> {
        let rover = self.node(rover)?;
        self.moved += self.estimate(self.rover, rover);
        self.rover = rover;
        Ok(())
    }

    /// A node's cost has become `cost`.
    ///
    /// # Errors
    /// [`IncrementalError`] where node or cost do not fit.
    pub fn change(&mut self, node: (usize, usize), cost: f64) -> Result<(), IncrementalError> {
        let node = self.node(node)?;
        if cost.is_nan() || cost < self.least {
            return Err(IncrementalError::Cost { cost, least: self.least });
        }
        self.cost[node] = cost;
        self.update(node);
        self.neighbours(node).into_iter().flatten().for_each(|(near, _)| self.update(near));
        Ok(())
    }

    /// The cheapest way from the rover to the goal, nodes (column, row) with both ends, and its cost; `None` where there is none.
    pub fn path(&mut self) -> Option<(Vec<(usize, usize)>, f64)> {
        self.repair();
        let cost = self.ahead[self.rover];
        if !cost.is_finite() {
            return None;
        }
        let mut path = vec![self.rover];
        let mut at = self.rover;
        while at != self.goal {
            let steps = self.neighbours(at).into_iter().flatten();
            let next = steps.min_by(|a, b| {
                (self.step(at, *a) + self.settled[a.0]).total_cmp(&(self.step(at, *b) + self.settled[b.0]))
            });
            at = next?.0;
            path.push(at);
        }
        Some((path.into_iter().map(|node| (node % self.columns, node / self.columns)).collect(), cost))
    }

    /// Nodes taken from the queue since the beginning.
    #[must_use]
    pub fn expanded(&self) -> usize {
        self.expanded
    }

    fn node(&self, (column, row): (usize, usize)) -> Result<usize, IncrementalError> {
        let inside = column < self.columns && row < self.rows;
        if inside { Ok(row * self.columns + column) } else { Err(IncrementalError::OffGrid { column, row }) }
    }

    /// Neighbours and the lengths of the steps to them.
    fn neighbours(&self, node: usize) -> [Option<(usize, f64)>; 8] {
        let (column, row) = (node % self.columns, node / self.columns);
        STEPS.map(|(dc, dr)| {
            let column = column.checked_add_signed(dc).filter(|column| *column < self.columns)?;
            let row = row.checked_add_signed(dr).filter(|row| *row < self.rows)?;
            Some((row * self.columns + column, if dc * dr == 0 { 1.0 } else { std::f64::consts::SQRT_2 }))
        })
    }

    fn step(&self, from: usize, (to, length): (usize, f64)) -> f64 {
        length * 0.5 * (self.cost[from] + self.cost[to])
    }

    /// A lower bound of the cost between two nodes.
    fn estimate(&self, a: usize, b: usize) -> f64 {
        let columns = (a % self.columns).abs_diff(b % self.columns);
        let rows = (a / self.columns).abs_diff(b / self.columns);
        let (long, short) = (columns.max(rows) as f64, columns.min(rows) as f64);
        self.least * (long + (std::f64::consts::SQRT_2 - 1.0) * short)
    }

    fn key(&self, node: usize) -> Key {
        let rest = self.settled[node].min(self.ahead[node]);
        Key(rest + self.estimate(self.rover, node) + self.moved, rest)
    }

    fn put(&mut self, node: usize) {
        let key = self.key(node);
        self.waiting[node] = Some(key);
        self.queue.push(Reverse((key, node)));
    }

    /// Looks one step ahead of a node again; it waits in the queue where that has changed what was settled.
    fn update(&mut self, node: usize) {
        if node != self.goal {
            let steps = self.neighbours(node).into_iter().flatten();
            self.ahead[node] =
                steps.map(|near| self.step(node, near) + self.settled[near.0]).fold(f64::INFINITY, f64::min);
        }
        if self.settled[node] == self.ahead[node] {
            self.waiting[node] = None;
        } else {
            self.put(node);
        }
    }

    /// Settles nodes until the rover's is, and no waiting one could improve it.
    fn repair(&mut self) {
        while let Some(&Reverse((key, node))) = self.queue.peek() {
            if self.waiting[node] != Some(key) {
                // An entry that a later one has replaced.
                self.queue.pop();
                continue;
            }
            if key >= self.key(self.rover) && self.settled[self.rover] == self.ahead[self.rover] {
                break;
            }
            self.queue.pop();
            self.waiting[node] = None;
            let fresh = self.key(node);
            if key < fresh {
                // The rover has moved since the node was put in.
                self.put(node);
                continue;
            }
            self.expanded += 1;
            if self.settled[node] > self.ahead[node] {
                self.settled[node] = self.ahead[node];
            } else {
                self.settled[node] = f64::INFINITY;
                self.update(node);
            }
            self.neighbours(node).into_iter().flatten().for_each(|(near, _)| self.update(near));
        }
    }
}
