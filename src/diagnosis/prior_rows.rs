//! What is known of the free parameters before an experiment, as rows of a least-squares problem: one a parameter with a prior of its
//! own, (p - p_0)/sigma_p, and as many as a known soil has parameters, R (t - t_0), where R^T R is the inverse of its covariance
//! and t the parameter or its logarithm.

use super::free::Free;
use crate::known_soil::{KnownSoil, Scale};
use crate::measurement::Prior;
use nalgebra::DMatrix;

/// A known soil ready for fits.
#[derive(Clone, Debug)]
pub(crate) struct JointPrior {
    /// What of the soil is used.
    pub soil: KnownSoil,
    /// How it is called in messages.
    pub label: String,
    /// R.
    root: DMatrix<f64>,
}

impl JointPrior {
    /// `None` where nothing is left of the soil.
    pub fn new(soil: KnownSoil, label: String) -> Option<Self> {
        if soil.parameters.is_empty() {
            return None;
        }
        let lower = soil.covariance().cholesky()?.unpack();
        let root = lower.try_inverse()?;
        Some(Self { soil, label, root })
    }

    /// Mean and standard deviation of one parameter by itself.
    pub fn of(&self, name: &str) -> Option<Prior> {
        let parameter = self.soil.parameters.iter().find(|parameter| parameter.name == name)?;
        Some(Prior { mean: parameter.value, deviation: parameter.sd })
    }

    /// What a value of one parameter adds to row `i`.
    fn off(&self, i: usize, name: &str, value: f64) -> f64 {
        let Some(k) = self.soil.parameters.iter().position(|parameter| parameter.name == name) else { return 0.0 };
        let parameter = &self.soil.parameters[k];
        self.root[(i, k)] * (parameter.scale.coordinate(value) - parameter.scale.coordinate(parameter.value))
    }

    /// Chi-square of values, by name, and the number of parameters among them; those that are missing count as at their means.
    pub fn distance(&self, value: impl Fn(&str) -> Option<f64>) -> (f64, usize) {
        let mut count = 0;
        let off: Vec<f64> = self
            .soil
            .parameters
            .iter()
            .map(|parameter| {
                value(&parameter.name).map_or(0.0, |value| {
                    count += 1;
                    parameter.scale.coordinate(value) - parameter.scale.coordinate(parameter.value)
                })
            })
            .collect();
        let rows = (0..self.root.nrows()).map(|i| (0..off.len()).map(|j| self.root[(i, j)] * off[j]).sum::<f64>());
        (rows.map(|row| row * row).sum(), count)
    }
}

/// One row.
#[derive(Clone, Debug)]
enum Row {
    /// A parameter's own prior.
    Own(usize, Prior),
    /// One of a known soil's, and what parameters that are held add to it.
    Joint(Vec<Term>, f64),
}

#[derive(Clone, Debug)]
struct Term {
    free: usize,
    scale: Scale,
    /// Coordinate of the mean.
    mean: f64,
    weight: f64,
}

/// All rows of a fit.
#[derive(Clone, Debug)]
pub(crate) struct PriorRows(Vec<Row>);

impl PriorRows {
    /// `factor` on the standard deviations of a known soil: 1, or large to see what the data say by themselves. `held` is a parameter
    /// of the known soil that is not free, and its value; others that are not free count as at their means.
    pub fn new(free: &[Free], joint: Option<&JointPrior>, factor: f64, held: Option<(&str, f64)>) -> Self {
        let own = |(k, free): (usize, &Free)| Some(Row::Own(k, free.prior?));
        let mut rows: Vec<Row> = free.iter().enumerate().filter_map(own).collect();
        if let Some(joint) = joint {
            let place = |name: &str| free.iter().position(|free| free.variable.name == name);
            let places: Vec<Option<usize>> = joint.soil.parameters.iter().map(|p| place(&p.name)).collect();
            for i in 0..joint.root.nrows() {
                let terms =
                    joint.soil.parameters.iter().zip(&places).enumerate().filter_map(|(j, (parameter, place))| {
                        let weight = joint.root[(i, j)] / factor;
                        let mean = parameter.scale.coordinate(parameter.value);
                        (weight != 0.0).then_some(Term { free: (*place)?, scale: parameter.scale, mean, weight })
                    });
                let constant = held.map_or(0.0, |(name, value)| joint.off(i, name, value) / factor);
                rows.push(Row::Joint(terms.collect(), constant));
            }
        }
        Self(rows)
    }

    /// Number of rows.
    pub fn len(&self) -> usize {
        self.0.len()
    }

    /// The residuals at values of the free parameters.
    pub fn residual<'a>(&'a self, values: &'a [f64]) -> impl Iterator<Item = f64> + 'a {
        self.0.iter().map(|row| match row {
            Row::Own(k, prior) => (values[*k] - prior.mean) / prior.deviation,
            Row::Joint(terms, constant) => {
                let of = |term: &Term| term.weight * (term.scale.coordinate(values[term.free]) - term.mean);
                terms.iter().map(of).sum::<f64>() + constant
            }
        })
    }

    /// Their derivatives in the search coordinate of parameter `k`.
    pub fn column<'a>(&'a self, free: &'a [Free], values: &'a [f64], k: usize) -> impl Iterator<Item = f64> + 'a {
        let slope = free[k].slope(values[k]);
        self.0.iter().map(move |row| match row {
            Row::Own(j, prior) => {
                if *j == k {
                    slope / prior.deviation
                } else {
                    0.0
                }
            }
            Row::Joint(terms, _) => {
                let own = terms.iter().filter(|term| term.free == k);
                own.map(|term| term.weight * term.scale.slope(values[k]) * slope).sum()
            }
        })
    }
}
