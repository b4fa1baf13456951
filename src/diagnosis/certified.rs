//! The search of a calibration on public problems of nonlinear regression with certified answers: NIST's Statistical
//! Reference Datasets. Misra1a (of lower difficulty) and MGH09 (of higher difficulty), from both of NIST's starts.

use super::least_squares::{LeastSquares, Pace};
use nalgebra::DMatrix;

/// Error of a parameter in its certified standard deviations, far below what the data can tell. MGH09 is so ill-conditioned
/// that a cost which no longer falls leaves the sixth digit of its parameters open.
const OFF: f64 = 1e-3;

/// Relative error of the sum of squares: rounding, and ten certified digits.
const SQUARES: f64 = 1e-9;

/// A prediction at `x` and its derivatives in the parameters.
type Model = fn(&[f64], f64) -> (f64, Vec<f64>);

struct Problem<'a> {
    model: Model,
    x: &'a [f64],
    y: &'a [f64],
    /// By parameter; far wider than the starts.
    bounds: &'a [(f64, f64)],
    /// Certified values and standard deviations.
    parameters: &'a [(f64, f64)],
    sum_of_squares: f64,
}

impl Problem<'_> {
    fn check_from(&self, start: &[f64]) {
        let rows = |b: &[f64]| -> Vec<(f64, Vec<f64>)> {
            let row = |(x, y): (&f64, &f64)| {
                let (value, slopes) = (self.model)(b, *x);
                (value - y, slopes)
            };
            self.x.iter().zip(self.y).map(row).collect()
        };
        let residual = |b: &[f64]| rows(b).into_iter().map(|(r, _)| r).collect();
        let linear = |b: &[f64]| {
            let rows = rows(b);
            DMatrix::from_fn(rows.len(), b.len() + 1, |i, k| if k == 0 { rows[i].0 } else { rows[i].1[k - 1] })
        };
        let (lower, upper) = self.bounds.iter().copied().unzip();
        let (rows, tolerance) = (self.x.len(), 1e-14);
        let search = LeastSquares { lower, upper, rows, tolerance, residual: &residual, linear: &linear };
        let found = search.minimise(&[start.to_vec()], Pace::PATIENT).pop().expect("the bounds are intervals");
        for (found, (certified, deviation)) in found.x.iter().zip(self.parameters) {
            assert!((found - certified).abs() < OFF * deviation, "from {start:?}: {found} instead of {certified}");
        }
        let sum_of_squares = 2.0 * found.cost;
        assert!((sum_of_squares / self.sum_of_squares - 1.0).abs() < SQUARES, "from {start:?}: {sum_of_squares}");
    }
}

#[test]
fn published_misra1a_is_found_as_certified() {
    let problem = Problem {
        model: |b, x| (b[0] * (1.0 - (-b[1] * x).exp()), vec![1.0 - (-b[1] * x).exp(), b[0] * x * (-b[1] * x).exp()]),
        x: &[77.6, 114.9, 141.1, 190.8, 239.9, 289.0, 332.8, 378.4, 434.8, 477.3, 536.8, 593.1, 689.1, 760.0],
        y: &[10.07, 14.73, 17.94, 23.93, 29.61, 35.18, 40.02, 44.82, 50.76, 55.05, 61.01, 66.40, 75.47, 81.78],
        bounds: &[(1.0, 1e4), (1e-6, 1e-1)],
        parameters: &[(2.389_421_291_8e2, 2.707_007_524_1), (5.501_564_318_1e-4, 7.266_868_843_6e-6)],
        sum_of_squares: 1.245_513_889_4e-1,
    };
    problem.check_from(&[500.0, 1e-4]);
    problem.check_from(&[250.0, 5e-4]);
}

#[test]
fn published_mgh09_is_found_as_certified() {
    let problem = Problem {
        model: |b, x| {
            let (above, below) = (x * x + x * b[1], x * x + x * b[2] + b[3]);
            let slope = -b[0] * above / (below * below);
            (b[0] * above / below, vec![above / below, b[0] * x / below, slope * x, slope])
        },
        x: &[4.0, 2.0, 1.0, 0.5, 0.25, 0.167, 0.125, 0.1, 0.0833, 0.0714, 0.0625],
        y: &[0.1957, 0.1947, 0.1735, 0.16, 0.0844, 0.0627, 0.0456, 0.0342, 0.0323, 0.0235, 0.0246],
        bounds: &[(0.0, 100.0); 4],
        parameters: &[
            (1.928_069_345_8e-1, 1.143_531_222_7e-2),
            (1.912_823_287_3e-1, 1.963_322_091_1e-1),
            (1.230_565_069_3e-1, 8.084_203_123_2e-2),
            (1.360_623_306_8e-1, 9.002_554_230_8e-2),
        ],
        sum_of_squares: 3.075_056_038_5e-4,
    };
    problem.check_from(&[25.0, 39.0, 41.5, 39.0]);
    problem.check_from(&[0.25, 0.39, 0.415, 0.39]);
}
