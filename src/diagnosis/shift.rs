//! A signal some time ago, between rows.
//!
//! Between two rows the signal is the cubic through both with slopes that are, at each row, those of the parabola through it and
//! its neighbours; before the first row and after the last it goes on straight. That is continuous with its derivative
//! in the delay, and linear in the signal: derivatives in a parameter are shifted as the signal is. Where a signal jumps
//! (torques do with a new command) the cubic bends over the rows beside the jump.

use std::ops::Range;

/// The value between rows as a sum over four of them.
#[derive(Clone, Copy, Debug, Default)]
struct Weights {
    first: usize,
    value: [f64; 4],
    /// Of the derivative in time, 1/s.
    rate: [f64; 4],
}

/// A delay over a stretch of rows.
#[derive(Clone, Debug)]
pub(super) struct Shift {
    rows: Range<usize>,
    weights: Vec<Weights>,
}

impl Shift {
    /// A delay of `delay` (s, positive where the record is late) over `rows` at `time` (s, rising).
    pub fn new(time: &[f64], rows: Range<usize>, delay: f64) -> Self {
        let own = &time[rows.clone()];
        let weights = own.iter().map(|t| Weights::at(own, t - delay)).collect();
        Self { rows, weights }
    }

    /// The rows.
    pub fn rows(&self) -> Range<usize> {
        self.rows.clone()
    }

    /// The delayed values of the stretch, from `values` of all rows.
    pub fn late(&self, values: &[f64]) -> Vec<f64> {
        self.sums(values, |weights| &weights.value)
    }

    /// The derivatives of the delayed values in time.
    pub fn rate(&self, values: &[f64]) -> Vec<f64> {
        self.sums(values, |weights| &weights.rate)
    }

    fn sums(&self, values: &[f64], of: impl Fn(&Weights) -> &[f64; 4]) -> Vec<f64> {
        let own = &values[self.rows.clone()];
        let sum = |weights: &Weights| {
            own[weights.first..].iter().zip(of(weights)).map(|(value, weight)| value * weight).sum()
        };
        self.weights.iter().map(sum).collect()
    }
}

impl Weights {
    /// Of the signal at `t` among rows at `time`.
    fn at(time: &[f64], t: f64) -> Self {
        let rows = time.len();
        if rows < 2 {
            return Self { first: 0, value: [1.0, 0.0, 0.0, 0.0], rate: [0.0; 4] };
        }
        let left = time.partition_point(|own| *own <= t).saturating_sub(1).min(rows - 2);
        let mut weights = Self { first: left.saturating_sub(1), ..Self::default() };
        if t < time[0] {
            weights.straight(time, 0, t - time[0]);
        } else if t >= time[rows - 1] {
            weights.straight(time, rows - 1, t - time[rows - 1]);
        } else {
            weights.cubic(time, left, t);
        }
        weights
    }

    /// Straight on from a row.
    fn straight(&mut self, time: &[f64], row: usize, beyond: f64) {
        self.value[row - self.first] += 1.0;
        for (at, slope) in slope(time, row) {
            self.value[at - self.first] += beyond * slope;
            self.rate[at - self.first] += slope;
        }
    }

    /// Hermite's cubic from row `left` to the next.
    fn cubic(&mut self, time: &[f64], left: usize, t: f64) {
        let width = time[left + 1] - time[left];
        let s = (t - time[left]) / width;
        let bend = s * s * (3.0 - 2.0 * s);
        let bend_rate = 6.0 * s * (1.0 - s) / width;
        for (row, value, rate) in [(left, 1.0 - bend, -bend_rate), (left + 1, bend, bend_rate)] {
            self.value[row - self.first] += value;
            self.rate[row - self.first] += rate;
        }
        let start = (width * s * (1.0 - s) * (1.0 - s), 1.0 - s * (4.0 - 3.0 * s));
        let end = (width * s * s * (s - 1.0), s * (3.0 * s - 2.0));
        for (row, (value, rate)) in [(left, start), (left + 1, end)] {
            for (at, slope) in slope(time, row) {
                self.value[at - self.first] += value * slope;
                self.rate[at - self.first] += rate * slope;
            }
        }
    }
}

/// Slope at a row as a sum over rows: of the parabola through it and its neighbours, at an end of the straight line to its
/// neighbour.
fn slope(time: &[f64], row: usize) -> Vec<(usize, f64)> {
    let last = time.len() - 1;
    if row == 0 || row == last {
        let from = if row == 0 { 0 } else { last - 1 };
        let steep = (time[from + 1] - time[from]).recip();
        return vec![(from, -steep), (from + 1, steep)];
    }
    let (before, after) = (time[row] - time[row - 1], time[row + 1] - time[row]);
    let both = before + after;
    let (early, late) = (after / (before * both), before / (after * both));
    vec![(row - 1, -early), (row, early - late), (row + 1, late)]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rows of unequal distance, s.
    fn time() -> Vec<f64> {
        (0..30).map(|k| 0.1 * f64::from(k) + 0.03 * f64::from(k).sin()).collect()
    }

    /// Rounding of sums of four products of order ten.
    const ROUNDING: f64 = 1e-12;

    #[test]
    fn analytic_without_delay_the_signal_stays_bit_for_bit() {
        let time = time();
        let values: Vec<f64> = time.iter().map(|t| (3.0 * t).sin()).collect();
        assert_eq!(Shift::new(&time, 0..30, 0.0).late(&values), values);
        let single = Shift::new(&time, 4..5, 0.3);
        assert_eq!((single.late(&values), single.rate(&values)), (vec![values[4]], vec![0.0]));
    }

    #[test]
    fn analytic_a_parabola_is_delayed_exactly_between_its_rows() {
        let time = time();
        let parabola = |t: f64| 1.0 - 2.0 * t + 3.0 * t * t;
        let values: Vec<f64> = time.iter().map(|t| parabola(*t)).collect();
        for delay in [0.04, -0.04, 0.25] {
            let shift = Shift::new(&time, 0..30, delay);
            for (k, (late, rate)) in shift.late(&values).iter().zip(shift.rate(&values)).enumerate() {
                let at = time[k] - delay;
                // The outermost rows have no neighbour for the slope of a parabola.
                if at > time[1] && at < time[28] {
                    assert!((late - parabola(at)).abs() < ROUNDING, "{late} at {at} s");
                    assert!((rate - (6.0 * at - 2.0)).abs() < 1e2 * ROUNDING, "{rate} at {at} s");
                }
            }
        }
    }

    #[test]
    fn analytic_a_straight_line_goes_on_beyond_its_rows() {
        let time = time();
        let values: Vec<f64> = time.iter().map(|t| 2.0 - 0.5 * t).collect();
        for delay in [0.9, -0.9, 5.0] {
            let shift = Shift::new(&time, 0..30, delay);
            for (k, late) in shift.late(&values).iter().enumerate() {
                assert!((late - (2.0 - 0.5 * (time[k] - delay))).abs() < ROUNDING, "{late}");
            }
        }
    }

    #[test]
    fn property_the_rate_is_the_derivative_in_the_delay() {
        let time = time();
        let values: Vec<f64> = time.iter().map(|t| (3.0 * t).sin()).collect();
        // Central differences of 1e-6 s, whose rounding is 1e-10.
        let h = 1e-6;
        for delay in [0.0, 0.013, 0.1, -0.37] {
            let at = |delay: f64| Shift::new(&time, 0..30, delay).late(&values);
            let (below, above) = (at(delay - h), at(delay + h));
            for (k, rate) in Shift::new(&time, 0..30, delay).rate(&values).iter().enumerate() {
                let difference = (below[k] - above[k]) / (2.0 * h);
                // At a row the second derivative jumps: half of it times h.
                assert!((rate - difference).abs() < 1e-4, "{rate} and {difference} with {delay} s in row {k}");
            }
        }
    }
}
