//! A parameter that a fit may move, and the coordinate in which it is searched.

use super::linear_algebra::Reach;
use crate::measurement::{Experiment, Prior, SensorError};
use bekker_modeldescription::Variable;

/// Ratio of the bounds from which a positive parameter is searched in logarithms.
const DECADES: f64 = 100.0;

/// Share of its range by which an effect that is all but neutral differs from neutral.
const NEARLY: f64 = 0.002;

/// A free parameter: its bounds (those of `variable`), where it starts, what is known of it.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Free {
    pub variable: Variable,
    pub start: f64,
    pub prior: Option<Prior>,
    /// What a known soil says of it by itself; in a fit it counts with the others of that soil, see `prior_rows`.
    pub shared: Option<Prior>,
    /// Where it acts, of several experiments that are fitted together; `None` where it acts in all of them.
    pub within: Option<Within>,
}

/// The parts of a joint experiment in which a parameter acts.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Within {
    /// Their numbers, rising.
    pub parts: Vec<usize>,
    /// Name of the parameter in the model of each of them.
    pub name: String,
    /// Parameters of these models that it multiplies; none where it is one itself.
    pub factor_of: Vec<String>,
}

impl Free {
    /// Errors of the sensors of an experiment, which every fit moves within their priors.
    pub fn of_sensors(experiment: &Experiment) -> impl Iterator<Item = Self> {
        let known = experiment.sensor_parameters().into_iter();
        known.map(|(variable, prior)| Self {
            start: prior.mean,
            prior: Some(prior),
            shared: None,
            within: None,
            variable,
        })
    }

    /// The same as part number `part` of a joint experiment knows it; `None` where it does not act there.
    pub fn in_part(&self, part: usize) -> Option<Self> {
        let Some(within) = &self.within else { return Some(self.clone()) };
        let variable = Variable { name: within.name.clone(), ..self.variable.clone() };
        (within.factor_of.is_empty() && within.parts.contains(&part)).then(|| Self {
            variable,
            within: None,
            ..self.clone()
        })
    }

    /// Parameters of part number `part` that it multiplies.
    pub fn factor_in(&self, part: usize) -> &[String] {
        match &self.within {
            Some(within) if within.parts.contains(&part) => &within.factor_of,
            _ => &[],
        }
    }

    /// Whether it is a factor on other parameters: the scatter of the soil from one experiment to the next.
    pub fn is_factor(&self) -> bool {
        self.within.as_ref().is_some_and(|within| !within.factor_of.is_empty())
    }

    /// Whether it is an error of a sensor rather than a parameter of the model.
    pub fn is_of_a_sensor(&self) -> bool {
        SensorError::is_named(&self.variable.name)
    }

    /// Whether its search coordinate is its logarithm.
    pub fn is_logarithmic(&self) -> bool {
        self.variable.min > 0.0 && self.variable.max / self.variable.min >= DECADES
    }

    /// Width of the wider side of the start, with its sign.
    pub fn span(&self) -> f64 {
        let (up, down) = (self.variable.max - self.start, self.start - self.variable.min);
        if up >= down { up } else { -down }
    }

    /// A parameter of an effect at its neutral value, moved off a bound on which that may lie: a search cannot leave a corner.
    pub fn nearly_neutral(&self) -> f64 {
        self.start + NEARLY * self.span()
    }

    /// Coordinate of the search: ln p, or p over its range.
    pub fn coordinate(&self, value: f64) -> f64 {
        if self.is_logarithmic() { value.ln() } else { value / (self.variable.max - self.variable.min) }
    }

    /// Value at a coordinate, within the bounds.
    pub fn value(&self, coordinate: f64) -> f64 {
        let value =
            if self.is_logarithmic() { coordinate.exp() } else { coordinate * (self.variable.max - self.variable.min) };
        value.clamp(self.variable.min, self.variable.max)
    }

    /// dp/du.
    pub fn slope(&self, value: f64) -> f64 {
        if self.is_logarithmic() { value } else { self.variable.max - self.variable.min }
    }

    /// How far the coordinate may go from that of `value`.
    pub fn reach(&self, value: f64) -> Reach {
        let (low, high) = self.bounds();
        let here = self.coordinate(value);
        Reach { low: (low - here).min(0.0), high: (high - here).max(0.0) }
    }

    /// Bounds of the coordinate.
    pub fn bounds(&self) -> (f64, f64) {
        (self.coordinate(self.variable.min), self.coordinate(self.variable.max))
    }
}
