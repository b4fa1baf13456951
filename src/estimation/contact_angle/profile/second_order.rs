//! What speeds and rates say less of the ground, since both are products of what is estimated.

use super::{ProfileFilter, Scratch};

/// Way over which squares of the slope's errors last, over that of the errors: 3.5/lambda of the correlation's square against twice
/// the correlation length.
const SQUARES_LAST: f64 = 0.6;

impl ProfileFilter {
    /// Mean and lasting variance of the second-order part of a wheel's speed, shares of it. A speed goes with the cosines of the angles
    /// between travel and line at both ends of a pair (2.29), and the error of a cosine is half the square of that of its
    /// angle: known angles make a speed tell of the ground, unknown ones would make it tell too much.
    pub(super) fn speed_beyond_first_order(&mut self, wheel: usize) -> [f64; 2] {
        let first = self.scratch.shape.first();
        if wheel == first {
            return [0.0; 2];
        }
        let Self { window, scratch, .. } = self;
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
                window.column(&right.by, column);
            }
            // The third product takes the second column: of the first wheel.
            variances[which] = left.by.iter().zip(column.iter()).map(|(by, entry)| by * entry).sum();
        }
        let [of_own, of_first, joint] = variances;
        let variance = 0.5 * (of_own * of_own + of_first * of_first - 2.0 * joint * joint).max(0.0);
        [0.5 * (of_own - of_first), SQUARES_LAST * variance]
    }

    /// Mean and lasting variance of the second-order part of the rate in the row, which is a product of the speed and of what a line
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
        [joint, SQUARES_LAST * (window.variance(at) * of_bend + joint * joint)]
    }
}
