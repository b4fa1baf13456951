//! The prediction of soil tests: every row is a formula of its own.

use crate::diagnosis::layout::{Block, Layout};
use crate::diagnosis::prediction::{Predict, PredictionError};
use crate::diagnosis::unanswered::Answers;
use crate::measurement::Experiment;
use crate::scalar::{Dual, Scalar};
use crate::soil_test::SoilTest;
use bekker_modeldescription::Parameters;

/// A soil in its tests.
pub(super) struct SoilTestPrediction<'a> {
    experiment: &'a Experiment,
    layout: &'a Layout,
    /// One a run, with what is known of that run.
    tests: Vec<SoilTest>,
    names: Vec<String>,
}

/// Derivatives that travel together.
const WIDTH: usize = 8;

impl<'a> SoilTestPrediction<'a> {
    /// `names` are the free parameters. A parameter that a run sets itself stays as it is.
    pub fn new(experiment: &'a Experiment, layout: &'a Layout, tests: Vec<SoilTest>, names: Vec<String>) -> Self {
        Self { experiment, layout, tests, names }
    }

    /// Sets the free parameters of a run's test; `place` gets the index of the parameter and where it goes.
    fn set_free<S: Scalar>(&self, run: usize, test: &mut SoilTest<S>, place: &dyn Fn(usize, &mut S)) {
        let own = &self.experiment.runs[run].parameters;
        test.visit("", &mut |variable, value| {
            if let Some(k) = self.names.iter().position(|name| *name == variable.name)
                && !own.contains_key(&variable.name)
            {
                place(k, value);
            }
        });
    }

    /// Calls `store` with the place of every value and what the model says there.
    fn each_value<S: Scalar>(&self, test_of: &dyn Fn(usize) -> SoilTest<S>, store: &mut dyn FnMut(usize, S)) {
        for (run, data) in self.experiment.runs.iter().enumerate() {
            let test = test_of(run);
            let input = |name: &str, row: usize| data.data.value(name, row).unwrap_or(f64::NAN);
            for Block { signal, range, .. } in self.layout.of_run(run) {
                for (row, at) in range.clone().enumerate() {
                    store(
                        at,
                        match signal.as_str() {
                            "force" => test.force(input("sinkage", row)),
                            "pressure" => test.pressure(input("sinkage", row)),
                            _ => test.shear_stress(input("displacement", row), input("normal_stress", row)),
                        },
                    );
                }
            }
        }
    }

    fn all_values(&self, free: &[f64]) -> Vec<f64> {
        let mut values = vec![f64::NAN; self.layout.len()];
        let test_of = |run: usize| {
            let mut test = self.tests[run].clone();
            self.set_free(run, &mut test, &|k, place| *place = free[k]);
            test
        };
        self.each_value(&test_of, &mut |at, value| values[at] = value);
        values
    }

    fn all_slopes(&self, free: &[f64]) -> (Vec<f64>, Vec<Vec<f64>>) {
        let mut values = vec![f64::NAN; self.layout.len()];
        let mut slopes = vec![vec![0.0; self.layout.len()]; free.len()];
        for first in (0..free.len().max(1)).step_by(WIDTH) {
            let test_of = |run: usize| {
                let mut test = self.tests[run].map(&|value| Dual::<WIDTH>::from(value));
                self.set_free(run, &mut test, &|k, place| {
                    let value = Dual::from(free[k]);
                    *place = if (first..first + WIDTH).contains(&k) { value.derivative(k - first) } else { value };
                });
                test
            };
            self.each_value(&test_of, &mut |at, value| {
                values[at] = value.re;
                for (k, slope) in slopes[first..].iter_mut().take(WIDTH).enumerate() {
                    slope[at] = crate::carriage::partial(&value, k);
                }
            });
        }
        (values, slopes)
    }
}

impl Predict for SoilTestPrediction<'_> {
    fn layout(&self) -> &Layout {
        self.layout
    }

    /// Every row has an answer.
    fn answers(&self, free: &[f64]) -> Result<Answers, PredictionError> {
        Ok(Answers { values: self.all_values(free), unanswered: Vec::new() })
    }

    fn slopes(&self, free: &[f64]) -> Result<(Vec<f64>, Vec<Vec<f64>>), PredictionError> {
        Ok(self.all_slopes(free))
    }

    fn values_onward(&self, free: &[f64]) -> Result<Vec<f64>, PredictionError> {
        Ok(self.all_values(free))
    }

    fn slopes_onward(&self, free: &[f64]) -> Result<(Vec<f64>, Vec<Vec<f64>>), PredictionError> {
        Ok(self.all_slopes(free))
    }
}
