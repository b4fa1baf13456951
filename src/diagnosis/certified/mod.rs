//! The search of a calibration on public problems of nonlinear regression with certified answers: the 27 of NIST's
//! Statistical Reference Datasets (`tests/nist_strd`), each from both of NIST's starts and in both coordinates that a calibration
//! has: logarithms, here of the parameters with two positive starts, and values over their range.

mod models;

use super::calibrate::variances;
use super::free::Free;
use super::least_squares::{LeastSquares, Minimum, Pace};
use bekker_modeldescription::{Role, Unit, Variable};
use models::{MODELS, ModelFunction};
use nalgebra::DMatrix;
use num_dual::Dual64;
use serde::Deserialize;
use std::collections::BTreeMap;
use std::path::Path;

/// Factor by which the bounds lie beyond the starts: wider than those of any calibration, so that they do not lead the search.
const BEYOND_THE_STARTS: f64 = 1e3;

/// Share by which the sum of squares may still fall where a search stops.
const TOLERANCE: f64 = 1e-14;

/// Relative error of a figure of 11 digits.
const PRINTED: f64 = 5e-11;

/// Share by which the sum of squares may lie above its minimum where a search has converged: as long as a step gains at least a
/// ten-thousandth less than the one before, all later gains together are 1e4 times the last.
const LEFT: f64 = 1e4 * TOLERANCE;

/// Rounded operations in a prediction: three exponentials, products and sums, and the exponents' own rounding.
const OPERATIONS: f64 = 20.0;

/// Growth of a relative error from parameters, in their deviations, to the deviations themselves: how far the models bend within one
/// deviation.
const BENT: f64 = 2.0;

/// In which a search moves.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Coordinates {
    Logarithms,
    Values,
}
use Coordinates::{Logarithms, Values};

#[derive(Deserialize)]
struct Problem {
    level: String,
    start_1: Vec<f64>,
    start_2: Vec<f64>,
    certified: Vec<f64>,
    deviations: Vec<f64>,
    sum_of_squares: f64,
    /// Whether the model predicts ln y.
    #[serde(default)]
    log_response: bool,
    y: Vec<f64>,
    #[serde(flatten)]
    predictors: BTreeMap<String, Vec<f64>>,
}

impl Problem {
    fn read(name: &str) -> Self {
        let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/nist_strd").join(name).with_extension("toml");
        let text = std::fs::read_to_string(file).expect("a file of each problem");
        let mut problem: Self = toml::from_str(&text).expect("numbers of each problem");
        if problem.log_response {
            problem.y.iter_mut().for_each(|y| *y = y.ln());
        }
        problem
    }

    /// The parameters as a calibration has them, wide around both starts.
    fn free(&self, coordinates: Coordinates) -> Vec<Free> {
        let bounds = self.start_1.iter().zip(&self.start_2).map(|(a, b)| {
            let largest = a.abs().max(b.abs()) * BEYOND_THE_STARTS;
            match coordinates {
                Logarithms if a.min(*b) > 0.0 => (a.min(*b) / BEYOND_THE_STARTS, largest),
                Logarithms | Values => (-largest, largest),
            }
        });
        bounds
            .map(|(min, max)| Free {
                variable: parameter(min, max),
                start: 0.0,
                prior: None,
                shared: None,
                within: None,
            })
            .collect()
    }

    /// Residuals, the first column, and their Jacobian in the parameters.
    fn linear(&self, model: ModelFunction, parameters: &[f64]) -> DMatrix<f64> {
        let rows: Vec<Vec<f64>> = (0..self.y.len()).map(|i| self.predictors.values().map(|x| x[i]).collect()).collect();
        let mut linear = DMatrix::zeros(self.y.len(), parameters.len() + 1);
        for k in 0..parameters.len() {
            let mut b: Vec<Dual64> = parameters.iter().copied().map(Dual64::from).collect();
            b[k] = b[k].derivative();
            for (i, x) in rows.iter().enumerate() {
                let prediction = model(&b, x);
                linear[(i, 0)] = prediction.re - self.y[i];
                linear[(i, k + 1)] = prediction.eps;
            }
        }
        linear
    }

    /// Where the search from `start` ends, in the parameters, and the Jacobian there.
    fn search(&self, model: ModelFunction, start: &[f64], coordinates: Coordinates) -> (Minimum, DMatrix<f64>) {
        let free = self.free(coordinates);
        let values = |u: &[f64]| -> Vec<f64> { free.iter().zip(u).map(|(free, u)| free.value(*u)).collect() };
        let residual = |u: &[f64]| -> Vec<f64> {
            let residuals = self.linear(model, &values(u)).column(0).into_owned();
            residuals.iter().map(|r| if r.is_finite() { *r } else { f64::INFINITY }).collect()
        };
        let linear = |u: &[f64]| {
            let values = values(u);
            let mut linear = self.linear(model, &values);
            for (k, (free, value)) in free.iter().zip(&values).enumerate() {
                linear.column_mut(k + 1).scale_mut(free.slope(*value));
            }
            linear
        };
        let (lower, upper) = free.iter().map(Free::bounds).unzip();
        let (rows, tolerance) = (self.y.len(), TOLERANCE);
        let search = LeastSquares { lower, upper, rows, tolerance, residual: &residual, linear: &linear };
        let start: Vec<f64> = free.iter().zip(start).map(|(free, value)| free.coordinate(*value)).collect();
        let mut found = search.minimise(&[start], Pace::PATIENT).pop().expect("the bounds are intervals");
        found.x = values(&found.x);
        let jacobian = self.linear(model, &found.x).columns_range(1..).into_owned();
        (found, jacobian)
    }
}

fn parameter(min: f64, max: f64) -> Variable {
    let (name, doc, source) = (String::new(), "".into(), "NIST StRD".into());
    Variable { name, doc, unit: Unit::ONE, default: min, min, max, role: Role::Calibrated, source }
}

impl Problem {
    /// Error of the certified figures that rounding leaves, relative to the standard deviation of a residual.
    fn rounding(&self) -> f64 {
        let size: f64 = self.y.iter().map(|y| y * y).sum();
        OPERATIONS * f64::EPSILON * (size / self.sum_of_squares).sqrt()
    }

    /// What is not as certified, or not as a listed miss has it.
    fn surprise(&self, found: &Minimum, jacobian: &DMatrix<f64>, listed: Option<&Miss>) -> Option<String> {
        let missed = self.misses(found, jacobian);
        let Some(listed) = listed else { return missed };
        let above = 2.0 * found.cost / self.sum_of_squares - 1.0;
        let Some(missed) = missed else {
            return (listed.end != ByRounding).then(|| "found now: take it off the list".to_owned());
        };
        if listed.end == ByRounding {
            let within = above.abs() <= PRINTED + LEFT + 2.0 * self.rounding();
            return (!within).then(|| format!("{missed}, and the sum of squares is off by {above:.1e}"));
        }
        let end = if found.converged { Converged } else { Stopped };
        let alike = end == listed.end && (listed.above / 2.0..=2.0 * listed.above).contains(&above);
        (!alike).then(|| format!("{missed}; {end:?}, listed {:?} and {:.1e}", listed.end, listed.above))
    }

    /// What keeps the end of a search from being the certified minimum; `None` where it is that.
    fn misses(&self, found: &Minimum, jacobian: &DMatrix<f64>) -> Option<String> {
        let freedom = (self.y.len() - found.x.len()) as f64;
        let above = 2.0 * found.cost / self.sum_of_squares - 1.0;
        let rounding = self.rounding();
        if above.abs() > PRINTED + LEFT + 2.0 * rounding {
            return Some(format!("the sum of squares is off by {above:.1e}"));
        }
        // Near the minimum the sum of squares grows by delta^T J^T J delta, so that no parameter is off by more deviations than
        // the square root of its relative excess times the degrees of freedom.
        let off = ((LEFT + rounding) * freedom).sqrt();
        let scaled = DMatrix::from_fn(jacobian.nrows(), jacobian.ncols(), |i, k| jacobian[(i, k)] * found.x[k]);
        let deviation = (2.0 * found.cost / freedom).sqrt();
        let variances = variances(scaled).expect("a decomposition");
        for (k, (certified, certified_deviation)) in self.certified.iter().zip(&self.deviations).enumerate() {
            let error = (found.x[k] - certified).abs();
            if error > off * certified_deviation + PRINTED * certified.abs() {
                return Some(format!("b{} = {}, certified {certified}", k + 1, found.x[k]));
            }
            let own = deviation * variances[k].sqrt() * found.x[k].abs();
            if (own / certified_deviation - 1.0).abs() > PRINTED + BENT * off {
                return Some(format!("deviation of b{}: {own}, certified {certified_deviation}", k + 1));
            }
        }
        None
    }
}

/// A search that does not end at the certified minimum.
struct Miss {
    problem: &'static str,
    /// 1 or 2.
    start: usize,
    coordinates: Coordinates,
    end: End,
    /// Its sum of squares over the certified one, less 1; within a factor of two, since hundreds of steps magnify rounding.
    above: f64,
}

/// How a search ends.
#[derive(Clone, Copy, Debug, PartialEq)]
enum End {
    /// A tolerance was met.
    Converged,
    /// All steps that are allowed were made, or no step leads further down to rounding.
    Stopped,
    /// The sum of squares is the certified one to rounding; whether the parameters are too depends on the rounding of the system's
    /// exponential function.
    ByRounding,
}
use End::{ByRounding, Converged, Stopped};

const fn miss(problem: &'static str, start: usize, coordinates: Coordinates, end: End, above: f64) -> Miss {
    Miss { problem, start, coordinates, end, above }
}

/// All searches that miss, of 108. Each problem but Bennett5 from its second start and Lanczos1 is found in one of the coordinates.
const MISSES: [Miss; 14] = [
    // On their way after all 300 steps, along valleys that are so narrow and bent that steps stay short; those of sums of
    // exponentials bend in logarithms.
    miss("bennett5", 1, Logarithms, Stopped, 5.4e-2),
    miss("bennett5", 2, Logarithms, Stopped, 8.0e-3),
    miss("bennett5", 2, Values, Stopped, 1.0e-2),
    miss("lanczos1", 1, Logarithms, Stopped, 7.4e14),
    miss("lanczos1", 2, Logarithms, Stopped, 2.0e15),
    miss("lanczos2", 1, Logarithms, Stopped, 4.1),
    miss("lanczos2", 2, Logarithms, Stopped, 16.0),
    miss("lanczos3", 1, Logarithms, Stopped, 8.9e-2),
    miss("lanczos3", 2, Logarithms, Stopped, 1.9e-2),
    miss("mgh17", 1, Logarithms, Stopped, 0.46),
    // Deviations of 1e-10 of the parameters are as small as the step below which a search ends.
    miss("lanczos1", 1, Values, Converged, 0.25),
    miss("lanczos1", 2, Values, ByRounding, 0.0),
    // b1 falls over orders of magnitude on the way, until its steps in a range of 4000 are as small as the one below which a search
    // ends; scipy's `least_squares` with the same bounds and tolerances stays in the same valley.
    miss("mgh10", 1, Values, Converged, 8.3e6),
    // The pole b4 has run up against the nearest x, where the arc tangent and the sum of squares jump.
    miss("roszman1", 1, Logarithms, Converged, 1.2e2),
];

/// Every problem of a level against NIST's answer or the listed misses.
fn check(level: &str, problems: usize) {
    let all = MODELS.into_iter().map(|(name, model)| (name, model, Problem::read(name)));
    let of_level: Vec<_> = all.filter(|(.., problem)| problem.level == level).collect();
    assert_eq!(of_level.len(), problems);
    let mut wrong = Vec::new();
    for (name, model, problem) in &of_level {
        for (start, values) in [(1, &problem.start_1), (2, &problem.start_2)] {
            for coordinates in [Logarithms, Values] {
                let (found, jacobian) = problem.search(*model, values, coordinates);
                let like = |miss: &&Miss| (miss.problem, miss.start, miss.coordinates) == (*name, start, coordinates);
                if let Some(message) = problem.surprise(&found, &jacobian, MISSES.iter().find(like)) {
                    wrong.push(format!("{name} from start {start} in {coordinates:?}: {message}"));
                }
            }
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}

#[test]
fn published_problems_of_lower_difficulty_end_as_certified_or_as_listed() {
    check("lower", 8);
}

#[test]
fn published_problems_of_average_difficulty_end_as_certified_or_as_listed() {
    check("average", 11);
}

#[test]
fn published_problems_of_higher_difficulty_end_as_certified_or_as_listed() {
    check("higher", 8);
}
