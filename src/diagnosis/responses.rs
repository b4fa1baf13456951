//! Models computed in advance along the strength of an effect, between which a page without a server interpolates.
//!
//! A [`Response`] holds the model at a few strengths from neutral to some times the fitted one, all other parameters as fitted. Between
//! them every value is a cubic through the four nearest strengths ([`interpolation_weights`]); what that misses is measured by simulations
//! half way between neighbours. Where it misses more than it may, those simulations become strengths of their own; where it still does,
//! as beside a strength at which a wheel breaks loose, the strengths end there.

use super::compare::CompareError;
use super::curves::{Axis, Curves};
use super::fit::Fit;
use super::workbench::{Trial, Workbench};
use std::collections::BTreeMap;

/// Values of parameters by name, SI units.
type Values = BTreeMap<String, f64>;

/// Strengths at first, from neutral to the end, the fitted one among them.
const STRENGTHS: usize = 6;
/// The end of the strengths, in fitted ones.
const REACH: f64 = 2.5;
/// A fitted strength below this share of one at which the effect shows is as good as none: the strengths then go to the latter.
const NOTHING: f64 = 0.2;
/// Largest difference from a simulation that is allowed, in multiples of the noise (of the error of the fitted model where the noise is
/// unknown): about as thick as the line of a plot.
const ALLOWED: f64 = 0.25;
/// How many times intervals that miss more are halved.
const ROUNDS: usize = 3;

/// The model along the strength of an effect.
#[derive(Clone, Debug)]
pub struct Response {
    /// The effects that act.
    pub effects: Vec<String>,
    /// Values of all parameters that were fitted with them, by name.
    pub values: Values,
    /// The parameter that is moved.
    pub parameter: String,
    /// Its values, rising.
    pub strengths: Vec<f64>,
    /// The model at each.
    pub models: Vec<Fit>,
    /// A wheel on a carriage: the model's curves at each, by axis.
    pub curves: Vec<Vec<Curves>>,
    /// Largest difference of the interpolation from simulations half way between the strengths, by signal.
    pub largest_error: BTreeMap<String, f64>,
}

/// Weights of the values at `strengths` (rising) for one at `at`: the cubic through the four nearest, of fewer what they give.
#[must_use]
pub fn interpolation_weights(strengths: &[f64], at: f64) -> Vec<f64> {
    let mut weights = vec![0.0; strengths.len()];
    let points = strengths.len().min(4);
    let above = strengths.iter().position(|strength| *strength >= at).unwrap_or(strengths.len());
    let first = above.saturating_sub(points / 2).min(strengths.len() - points);
    let own = &strengths[first..first + points];
    for (j, x) in own.iter().enumerate() {
        let others = own.iter().enumerate().filter(|(k, _)| *k != j);
        weights[first + j] = others.map(|(_, other)| (at - other) / (x - other)).product();
    }
    weights
}

/// A model at one strength.
struct Point {
    strength: f64,
    trial: Trial,
    curves: Vec<Curves>,
}

/// Points of rising strength, and one half way between each two neighbours.
struct Line {
    points: Vec<Point>,
    between: Vec<Point>,
    /// What errors are measured by, by signal.
    scales: BTreeMap<String, f64>,
}

impl Workbench {
    /// The model along the strength `parameter` of an effect, all other parameters at `values`. `None` where the model has no answer at
    /// one of the strengths, or the parameter cannot move. The values are fitted ones and not checked: the scatter of the soil may carry
    /// those of one of several experiments beyond the bounds of a calibration.
    ///
    /// # Errors
    /// [`CompareError`] where there is no such parameter.
    pub(crate) fn response(
        &self,
        effects: &[String],
        values: &Values,
        parameter: &str,
    ) -> Result<Option<Response>, CompareError> {
        let Some(strengths) = self.strengths(values, parameter)? else { return Ok(None) };
        let Some(points) = self.points(values, parameter, &strengths)? else { return Ok(None) };
        let Some(between) = self.points(values, parameter, &middles(&strengths))? else { return Ok(None) };
        let scales = self.scales(&points[0].trial.fit);
        let mut line = Line { points, between, scales };
        for _ in 0..ROUNDS {
            let missed = line.missed();
            if missed.is_empty() {
                break;
            }
            let Some(finer) = self.points(values, parameter, &line.quarters(&missed))? else { break };
            line.halve(&missed, finer);
        }
        line.end_where_missed(values.get(parameter).copied());
        let Line { points, between, .. } = line;
        Ok(Some(Response {
            effects: effects.to_vec(),
            values: values.clone(),
            parameter: parameter.to_owned(),
            largest_error: largest_errors(&points, &between),
            strengths: points.iter().map(|point| point.strength).collect(),
            curves: points.iter().map(|point| point.curves.clone()).collect(),
            models: points.into_iter().map(|point| point.trial.fit).collect(),
        }))
    }

    /// From neutral to some times the fitted strength, or to one at which the effect shows where the fit has none.
    fn strengths(&self, values: &Values, parameter: &str) -> Result<Option<Vec<f64>>, CompareError> {
        let known = self.parameters();
        let Some(own) = known.iter().find(|own| own.variable.name == parameter) else {
            // The names of all are checked here.
            self.trial(&[(parameter.to_owned(), 0.0)].into(), false)?;
            return Ok(None);
        };
        let (start, fitted) = (own.start, values.get(parameter).copied().unwrap_or(own.start));
        let shows = own.typical - start;
        let far = if (fitted - start).abs() < NOTHING * shows.abs() { shows } else { REACH * (fitted - start) };
        let end = (start + far).clamp(own.variable.min, own.variable.max);
        let mut strengths: Vec<f64> =
            (0..STRENGTHS).map(|k| start + (end - start) * k as f64 / (STRENGTHS - 1) as f64).collect();
        // The fitted one takes the place of its neighbour, so that no two lie close together.
        let inside =
            (1..STRENGTHS).min_by(|a, b| (strengths[*a] - fitted).abs().total_cmp(&(strengths[*b] - fitted).abs()));
        if let Some(nearest) = inside.filter(|_| fitted != start) {
            strengths[nearest] = fitted;
        }
        strengths.sort_by(f64::total_cmp);
        strengths.dedup();
        Ok((strengths.len() == STRENGTHS).then_some(strengths))
    }

    /// `None` where the model has no answer at one of them.
    fn points(&self, values: &Values, parameter: &str, strengths: &[f64]) -> Result<Option<Vec<Point>>, CompareError> {
        let mut points = Vec::new();
        for &strength in strengths {
            let mut own = values.clone();
            own.insert(parameter.to_owned(), strength);
            let trial = match self.tried(&own) {
                Err(CompareError::Prediction(_)) => return Ok(None),
                trial => trial?,
            };
            let curves = Axis::ALL.iter().filter_map(|axis| self.sketched(*axis, &own)).collect();
            points.push(Point { strength, trial, curves });
        }
        Ok(Some(points))
    }

    /// The noise of each signal, or its error in a model where the noise is unknown.
    fn scales(&self, fit: &Fit) -> BTreeMap<String, f64> {
        let floor = |signal: &String| self.noise_floor().get(signal).and_then(|floor| floor.value());
        let scale = |(signal, rmse): (&String, &f64)| {
            (signal.clone(), floor(signal).filter(|floor| *floor > 0.0).unwrap_or(*rmse))
        };
        fit.rmse.iter().map(scale).collect()
    }
}

impl Line {
    /// Intervals whose middle the interpolation misses by more than is allowed.
    fn missed(&self) -> Vec<usize> {
        let misses = |errors: BTreeMap<String, f64>| {
            errors
                .iter()
                .any(|(signal, error)| *error > ALLOWED * self.scales.get(signal).copied().unwrap_or(f64::INFINITY))
        };
        (0..self.between.len()).filter(|k| misses(largest_errors(&self.points, &self.between[*k..=*k]))).collect()
    }

    /// Strengths half way between the middles of these intervals and their ends.
    fn quarters(&self, intervals: &[usize]) -> Vec<f64> {
        let ends = |k: &usize| {
            let middle = self.between[*k].strength;
            [0.5 * (self.points[*k].strength + middle), 0.5 * (middle + self.points[*k + 1].strength)]
        };
        intervals.iter().flat_map(ends).collect()
    }

    /// Makes points of the middles of these intervals; `quarters` are the new middles.
    fn halve(&mut self, intervals: &[usize], quarters: Vec<Point>) {
        let old = std::mem::take(&mut self.between);
        for (k, middle) in old.into_iter().enumerate() {
            let to = if intervals.contains(&k) { &mut self.points } else { &mut self.between };
            to.push(middle);
        }
        self.between.extend(quarters);
        self.points.sort_by(|a, b| a.strength.total_cmp(&b.strength));
        self.between.sort_by(|a, b| a.strength.total_cmp(&b.strength));
    }

    /// Takes away what lies behind intervals that are still missed, seen from the fitted strength.
    fn end_where_missed(&mut self, fitted: Option<f64>) {
        let fitted = fitted.unwrap_or(self.points[0].strength);
        while let Some(missed) = self.missed().first().copied() {
            // The side on which the fitted strength lies stays, and with it at least that.
            if self.points[missed + 1].strength <= fitted {
                self.points.drain(..=missed);
                self.between.drain(..=missed);
            } else {
                self.points.truncate(missed + 1);
                self.between.truncate(missed);
            }
        }
    }
}

fn middles(strengths: &[f64]) -> Vec<f64> {
    strengths.windows(2).map(|pair| 0.5 * (pair[0] + pair[1])).collect()
}

/// By signal, where the interpolation differs most from what was simulated between the points.
fn largest_errors(points: &[Point], between: &[Point]) -> BTreeMap<String, f64> {
    let strengths: Vec<f64> = points.iter().map(|point| point.strength).collect();
    let mut largest = BTreeMap::new();
    for simulated in between {
        let weights = interpolation_weights(&strengths, simulated.strength);
        for (number, run) in simulated.trial.fit.runs.iter().enumerate() {
            for (place, signal) in run.signals.iter().enumerate() {
                let worst: &mut f64 = largest.entry(signal.signal.clone()).or_insert(0.0);
                for (row, truth) in signal.modelled.iter().enumerate() {
                    // Rows that do not count, or without an answer, tell nothing.
                    if signal.residual[row].is_nan() {
                        continue;
                    }
                    let at = |point: &Point| point.trial.fit.runs[number].signals[place].modelled[row];
                    let value: f64 = points.iter().zip(&weights).map(|(point, weight)| weight * at(point)).sum();
                    if value.is_finite() {
                        *worst = worst.max((value - truth).abs());
                    }
                }
            }
        }
    }
    largest
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn analytic_cubics_are_met_everywhere_and_values_at_their_places() {
        let strengths = [0.0, 0.1, 0.35, 0.4, 0.8, 1.0];
        let cubic = |x: f64| 1.0 - 2.0 * x + 3.0 * x * x - 4.0 * x * x * x;
        for at in [0.0, 0.03, 0.2, 0.37, 0.4, 0.6, 0.93, 1.0] {
            let weights = interpolation_weights(&strengths, at);
            let value: f64 = strengths.iter().zip(&weights).map(|(x, weight)| weight * cubic(*x)).sum();
            assert!((value - cubic(at)).abs() < 1e-13, "{at}: {value}");
        }
        assert_eq!(interpolation_weights(&strengths, 0.35), [0.0, 0.0, 1.0, 0.0, 0.0, 0.0]);
        assert_eq!(interpolation_weights(&[2.0, 4.0], 3.0), [0.5, 0.5]);
    }
}
