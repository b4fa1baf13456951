//! A smooth through scattered samples: local straight lines (LOESS of degree 1, Cleveland 1979).

/// A local line is fitted to at least this many samples.
const FEWEST: usize = 4;
/// The scatter about the smooth is taken at about this many samples, evenly by rank: enough for a standard error.
const PROBES: usize = 200;

/// A smooth of y over x.
#[derive(Clone, Debug)]
pub(crate) struct LocalLine {
    /// Samples in rising order of x.
    samples: Vec<(f64, f64)>,
    reach: usize,
    /// Variance of one sample about the smooth; `None` where there are too few samples to tell.
    variance: Option<f64>,
    /// Mean of y.
    mean: f64,
}

/// Value of a smooth at a place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Smoothed {
    pub value: f64,
    /// Standard error, as if the samples scattered independently about the smooth; `None` where there are too few.
    pub error: Option<f64>,
}

/// A local line's value and how it depends on the samples.
struct Local {
    value: f64,
    /// Sum of the squared weights with which samples enter the value: its variance in units of that of one sample.
    gain: f64,
    /// Weight with which a sample at the place itself enters the value.
    own: f64,
}

impl LocalLine {
    /// Each local line is fitted to the share `span` of the samples. `None` where there are no samples; NaN is left out.
    pub fn new(samples: impl IntoIterator<Item = (f64, f64)>, span: f64) -> Option<Self> {
        let mut samples: Vec<(f64, f64)> = samples.into_iter().filter(|(x, y)| !x.is_nan() && !y.is_nan()).collect();
        if samples.is_empty() {
            return None;
        }
        samples.sort_by(|a, b| a.0.total_cmp(&b.0));
        let reach = ((span * samples.len() as f64).ceil() as usize).max(FEWEST).min(samples.len());
        let mean = samples.iter().map(|(_, y)| y).sum::<f64>() / samples.len() as f64;
        let mut smooth = Self { samples, reach, variance: None, mean };
        smooth.variance = smooth.scatter();
        Some(smooth)
    }

    /// Places of the samples, rising, at most about `most` of them, at least a `most`-th of the range apart, the first and
    /// the last always. Only places of samples: between samples far apart a local line would only continue one side.
    pub fn places(&self, most: usize) -> Vec<f64> {
        let (first, last) = (self.samples[0].0, self.samples[self.samples.len() - 1].0);
        let apart = (last - first) / most.max(1) as f64;
        let mut places = vec![first];
        for (x, _) in &self.samples {
            let previous = places[places.len() - 1];
            let between = *x > previous && *x < last;
            if between && x - previous >= apart && last - x >= apart {
                places.push(*x);
            }
        }
        if last > first {
            places.push(last);
        }
        places
    }

    /// The smooth at `x`.
    pub fn at(&self, x: f64) -> Smoothed {
        let local = self.local(x);
        Smoothed { value: local.value, error: self.variance.map(|variance| (variance * local.gain).sqrt()) }
    }

    /// Share of the variance of y that the smooth accounts for, corrected for the freedom that it has (adjusted R^2); 0
    /// where there are too few samples to tell or y does not vary.
    pub fn explained(&self) -> f64 {
        let squares: f64 = self.samples.iter().map(|(_, y)| (y - self.mean).powi(2)).sum();
        let whole = squares / (self.samples.len() as f64 - 1.0);
        self.variance.filter(|_| whole > 0.0).map_or(0.0, |left| 1.0 - left / whole)
    }

    /// Variance of one sample about the smooth.
    fn scatter(&self) -> Option<f64> {
        let count = self.samples.len();
        let probes = self.samples.iter().step_by(count.div_ceil(PROBES));
        let (mut squares, mut freedom, mut probed) = (0.0, 0.0, 0.0);
        for (x, y) in probes {
            let local = self.local(*x);
            squares += (y - local.value).powi(2);
            freedom += local.own;
            probed += 1.0;
        }
        let left = 1.0 - freedom / probed;
        (left * count as f64 >= 1.0).then(|| squares / probed / left)
    }

    /// The weighted straight line through the nearest samples, at `x`.
    fn local(&self, x: f64) -> Local {
        let nearest = self.nearest(x);
        let width = nearest.iter().map(|(at, _)| (at - x).abs()).fold(0.0, f64::max);
        // A little wider than the farthest sample, whose weight would be nothing.
        let weight = |at: f64| {
            let share = if width > 0.0 { (at - x).abs() / (1.001 * width) } else { 0.0 };
            (1.0 - share.powi(3)).powi(3)
        };
        let (mut sum, mut first, mut second) = (0.0, 0.0, 0.0);
        for (at, _) in nearest {
            let (w, d) = (weight(*at), at - x);
            sum += w;
            first += w * d;
            second += w * d * d;
        }
        let spread = second - first * first / sum;
        // Samples at one place have no slope.
        let straight = spread > 1e-9 * width * width * sum;
        let share = |at: f64| {
            let slope = if straight { first / sum * ((at - x) - first / sum) / spread * sum } else { 0.0 };
            weight(at) * (1.0 - slope) / sum
        };
        let (mut value, mut gain) = (0.0, 0.0);
        for (at, y) in nearest {
            let l = share(*at);
            value += l * y;
            gain += l * l;
        }
        Local { value, gain, own: share(x) }
    }

    /// The samples nearest to `x`, at least `reach` of them; samples as near as the last of these are among them.
    fn nearest(&self, x: f64) -> &[(f64, f64)] {
        let all = &self.samples;
        let mut low = all.partition_point(|(at, _)| *at < x);
        let mut high = low;
        while high - low < self.reach {
            let below = low.checked_sub(1).map(|k| x - all[k].0);
            let above = all.get(high).map(|(at, _)| at - x);
            match (below, above) {
                (Some(below), Some(above)) if below < above => low -= 1,
                (Some(_), None) => low -= 1,
                (_, Some(_)) => high += 1,
                (None, None) => break,
            }
        }
        let farthest = (x - all[low].0).max(all[high - 1].0 - x);
        while low > 0 && x - all[low - 1].0 <= farthest {
            low -= 1;
        }
        while high < all.len() && all[high].0 - x <= farthest {
            high += 1;
        }
        &all[low..high]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rounding of sums of some ten terms of size one.
    const ROUNDING: f64 = 1e-12;

    #[test]
    fn analytic_a_straight_line_is_met_exactly() {
        let line = LocalLine::new((0..20).map(|k| f64::from(k * k)).map(|x| (x, 3.0 - 0.5 * x)), 0.5).expect("points");
        for x in [0.0, 7.5, 200.0, 361.0] {
            let error = (line.at(x).value - (3.0 - 0.5 * x)).abs();
            assert!(error < 361.0 * ROUNDING, "{x}: {error}");
        }
        assert!((line.explained() - 1.0).abs() < ROUNDING);
    }

    #[test]
    fn analytic_samples_at_one_place_give_their_mean_and_its_standard_error() {
        let line = LocalLine::new([1.0, 2.0, 4.0, 5.0].map(|y| (0.3, y)), 0.5).expect("points");
        let smoothed = line.at(0.3);
        assert!((smoothed.value - 3.0).abs() < ROUNDING);
        // Variance 10/3 with three degrees of freedom, over four samples.
        let expected = (10.0_f64 / 3.0 / 4.0).sqrt();
        assert!((smoothed.error.expect("points") - expected).abs() < ROUNDING, "{smoothed:?}");
    }

    #[test]
    fn property_scatter_without_a_trend_is_not_explained_and_nothing_gives_nothing() {
        // +1, -1 in turn has no trend over any stretch.
        let line =
            LocalLine::new((0..40).map(|k| (f64::from(k), if k % 2 == 0 { 1.0 } else { -1.0 })), 0.5).expect("points");
        assert!(line.explained() < 0.1, "{}", line.explained());
        assert!(line.at(20.0).value.abs() < 0.2);
        assert!(LocalLine::new([(f64::NAN, 1.0)], 0.5).is_none());
        assert!(LocalLine::new([(0.0, 1.0)], 0.5).expect("points").at(5.0).error.is_none());
    }

    #[test]
    fn property_places_are_those_of_samples_and_not_crowded() {
        let crowded = (0..500).map(|k| (1e-3 * f64::from(k), 0.0)).chain([(4.0, 0.0), (10.0, 0.0)]);
        let line = LocalLine::new(crowded, 0.5).expect("points");
        assert_eq!(line.places(20), [0.0, 4.0, 10.0]);
        assert_eq!(LocalLine::new([(2.0, 1.0), (2.0, 3.0)], 0.5).expect("points").places(20), [2.0]);
    }
}
