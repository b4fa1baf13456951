//! One channel: from the truth to a reading.

use crate::snapshot::Moving;

/// Share of a sample period by which a reading may come early and still be the next sample's: rounding of its time.
const EARLY: f64 = 1e-6;

/// What a sensor does to one quantity; all 0: nothing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Channel {
    pub noise: f64,
    pub bias: f64,
    pub resolution: f64,
    pub period: f64,
}

impl Channel {
    /// The reading of `truth`, with `unit` drawn from the standard normal distribution.
    ///
    /// Noise is added also where its standard deviation is 0: the channels that have no parameter but `noise` use this
    /// function. Adding a zero can change the sign of a reading of zero, so these channels keep it for results of the same
    /// bits as before; [`reading_if_noisy`](Self::reading_if_noisy) leaves such a reading as it is.
    pub fn reading(&self, truth: f64, unit: f64) -> f64 {
        self.rounded(self.analogue(truth + self.noise * unit))
    }

    /// The reading of `truth`, which is the truth to the last bit where there is no noise.
    pub fn reading_if_noisy(&self, truth: f64, unit: f64) -> f64 {
        let noisy = if self.noise > 0.0 { truth + self.noise * unit } else { truth };
        self.rounded(self.analogue(noisy))
    }

    /// As [`reading`](Self::reading), in whole counts; `rest` is what the counts so far leave over.
    pub fn counted(&self, truth: f64, unit: f64, rest: &mut f64) -> f64 {
        let analogue = self.analogue(truth + self.noise * unit);
        if self.resolution > 0.0 {
            let due = analogue + *rest;
            let counted = self.rounded(due);
            *rest = due - counted;
            return counted;
        }
        analogue
    }

    fn analogue(&self, noisy: f64) -> f64 {
        if self.bias == 0.0 { noisy } else { noisy + self.bias }
    }

    fn rounded(&self, value: f64) -> f64 {
        if self.resolution > 0.0 { (value / self.resolution).round() * self.resolution } else { value }
    }
}

/// When a channel was sampled last.
#[derive(Clone, Copy, Debug, Default, PartialEq, Moving)]
pub(super) struct Clock {
    /// Number of the sample period that the last sample was taken in.
    last: Option<i64>,
}

impl Clock {
    /// Whether a reading at `time`, s, is a new sample of a channel with this period, s.
    pub fn due(&mut self, time: f64, period: f64) -> bool {
        if period <= 0.0 {
            return true;
        }
        let now = Some((time / period + EARLY).floor() as i64);
        let due = self.last != now;
        self.last = now;
        due
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn analytic_samples_are_a_period_apart() {
        let mut clock = Clock::default();
        let due: Vec<u32> = (0..100).filter(|k| clock.due(f64::from(*k) * 0.01, 0.25)).collect();
        assert_eq!(due, [0, 25, 50, 75]);
    }

    #[test]
    fn analytic_counts_lose_no_way() {
        let channel = Channel { noise: 0.0, bias: 0.0, resolution: 1.0, period: 0.0 };
        let mut rest = 0.0;
        let counted: f64 = (0..1000).map(|_| channel.counted(0.3, 0.0, &mut rest)).sum();
        // Less than half a count is left over.
        assert!((counted - 300.0).abs() <= 0.5, "{counted}");
        assert_eq!(channel.reading(0.3, 0.0), 0.0);
    }
}
