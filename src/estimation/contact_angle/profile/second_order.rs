//! What speeds and rates say less of the ground, since both are products of what is estimated.

use super::{ProfileFilter, Scratch};

impl ProfileFilter {
    /// Mean and variance of the second-order part of the rate in the row, which is a product of the speed and of what a line
    /// turns by along the way: an unknown speed makes a known rate tell less of the ground.
    pub(super) fn rate_beyond_first_order(&mut self) -> [f64; 2] {
        let at = self.layout.speed();
        let speed = self.window.state[at];
        if speed == 0.0 {
            return [0.0; 2];
        }
        let Self { window, scratch, .. } = self;
        let Scratch { row, column, apart: [bend, _], .. } = scratch;
        bend.by.iter_mut().zip(&row.by).for_each(|(by, of_rate)| *by = of_rate / speed);
        bend.by[at] = 0.0;
        window.column(&bend.by, column);
        let of_bend: f64 = bend.by.iter().zip(column.iter()).map(|(by, entry)| by * entry).sum();
        let joint = column[at];
        [joint, window.variance(at) * of_bend + joint * joint]
    }
}
