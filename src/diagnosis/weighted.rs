//! The whitened residuals of a fit as a function of the search's coordinates, and their Jacobian.
//!
//! Rows: one a measured value, made white by the noise model, then those of the [priors](super::prior_rows). Beyond a threshold a
//! measured value counts as in Huber's loss, so that single bad samples do not lead; see [`Weighted::robust`].

use super::free::Free;
use super::layout::Layout;
use super::noise::Whitening;
use super::prediction::{Predict, PredictionError};
use super::prior_rows::PriorRows;
use super::undetermined::silence;
use nalgebra::DMatrix;

/// A weighted least-squares problem over `free`.
pub(crate) struct Weighted<'a> {
    pub predict: &'a dyn Predict,
    pub layout: &'a Layout,
    pub free: &'a [Free],
    pub whitening: &'a Whitening,
    /// What is known of the free parameters.
    pub priors: &'a PriorRows,
    /// Size of a whitened residual beyond which its weight falls (Huber 1964); infinite for plain least squares.
    pub robust: f64,
    /// Whether every row that counts must have an answer; not where rows are left out of the fit, which may be predicted badly.
    pub whole: bool,
}

impl Weighted<'_> {
    /// Parameter values at search coordinates.
    pub fn values(&self, u: &[f64]) -> Vec<f64> {
        self.free.iter().zip(u).map(|(free, u)| free.value(*u)).collect()
    }

    /// Search coordinates of parameter values, within the bounds.
    pub fn coordinates(&self, values: &[f64]) -> Vec<f64> {
        let clamped = |free: &Free, value: f64| value.clamp(free.variable.min, free.variable.max);
        self.free.iter().zip(values).map(|(free, value)| free.coordinate(clamped(free, *value))).collect()
    }

    /// Number of rows.
    pub fn rows(&self) -> usize {
        self.whitening.len() + self.priors.len()
    }

    /// Rows less the directions that the starts of windows take.
    pub fn freedom(&self) -> usize {
        self.rows() - self.whitening.taken()
    }

    /// Whitened residuals (modelled minus measured) of a prediction, then those of the priors; not yet robust.
    pub fn whitened(&self, modelled: &[f64], values: &[f64]) -> Vec<f64> {
        let difference: Vec<f64> = modelled.iter().zip(&self.layout.measured).map(|(m, y)| m - y).collect();
        let mut all = self.whitening.apply(&difference);
        all.extend(self.priors.residual(values));
        all
    }

    /// Whether search coordinates are an answer: every row that counts has one, where it must.
    pub fn is_valid(&self, u: &[f64]) -> bool {
        !self.whole || self.predict.values(&self.values(u)).is_ok()
    }

    /// Residuals whose squares are Huber's loss; rows without an answer count as [`unanswered`](super::unanswered) says.
    /// Infinite where the model gives nothing at all, which rejects a step.
    pub fn residual(&self, u: &[f64]) -> Vec<f64> {
        let values = self.values(u);
        match self.predict.values_onward(&values) {
            Ok(modelled) => {
                let mut all = self.whitened(&modelled, &values);
                all[..self.whitening.len()].iter_mut().for_each(|r| *r = self.huber(*r).0);
                all
            }
            Err(_) => vec![f64::INFINITY; self.rows()],
        }
    }

    /// sqrt of twice Huber's loss with the residual's sign, and its slope in the residual.
    fn huber(&self, r: f64) -> (f64, f64) {
        let size = r.abs();
        if size <= self.robust {
            return (r, 1.0);
        }
        let root = (self.robust * (2.0 * size - self.robust)).sqrt();
        (root.copysign(r), self.robust / root)
    }

    /// [`Self::residual`], the first column, and its Jacobian; NaN where the model has no answer, which the search reports as
    /// a breakdown.
    pub fn linear(&self, u: &[f64]) -> DMatrix<f64> {
        let Ok((mut residual, mut columns)) = self.sensitivities(u) else {
            return DMatrix::from_element(self.rows(), u.len() + 1, f64::NAN);
        };
        self.make_robust(&mut residual, &mut columns);
        columns.insert(0, residual);
        DMatrix::from_fn(self.rows(), u.len() + 1, |i, k| columns[k][i])
    }

    /// Turns whitened residuals into those whose squares are Huber's loss, and their derivatives with them.
    pub fn make_robust(&self, residual: &mut [f64], columns: &mut [Vec<f64>]) {
        for (at, r) in residual.iter_mut().enumerate().take(self.whitening.len()) {
            let (robust, slope) = self.huber(*r);
            *r = robust;
            columns.iter_mut().for_each(|column| column[at] *= slope);
        }
    }

    /// Whitened residuals and, for each free parameter, their derivative in its search coordinate.
    ///
    /// # Errors
    /// [`PredictionError`] where the model has no answer.
    pub fn sensitivities(&self, u: &[f64]) -> Result<(Vec<f64>, Vec<Vec<f64>>), PredictionError> {
        let values = self.values(u);
        let (modelled, mut slopes) = self.predict.slopes_onward(&values)?;
        silence(self.layout, self.free, &values, &mut slopes);
        let residual = self.whitened(&modelled, &values);
        Ok((residual, self.columns(&slopes, &values)))
    }

    /// Whitened columns, by search coordinate, of raw derivatives at `values`; the priors' rows follow.
    pub fn columns(&self, slopes: &[Vec<f64>], values: &[f64]) -> Vec<Vec<f64>> {
        let column = |(k, slope): (usize, &Vec<f64>)| {
            let scale = self.free[k].slope(values[k]);
            let scaled: Vec<f64> = slope.iter().map(|s| s * scale).collect();
            let mut column = self.whitening.apply(&scaled);
            column.extend(self.priors.column(self.free, values, k));
            column
        };
        slopes.iter().enumerate().map(column).collect()
    }
}
