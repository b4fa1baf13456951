//! The prediction of several experiments: one behind the other, each by its own kind.

use crate::diagnosis::free::Free;
use crate::diagnosis::layout::Layout;
use crate::diagnosis::prediction::{Derivatives, Predict, PredictionError};
use crate::diagnosis::problem::{Placed, Problem};
use crate::diagnosis::unanswered::Answers;
use crate::diagnosis::windows::free::FreeStart;

/// A part, with those of the free parameters that act in it.
struct Part<'p> {
    problem: Problem<'p>,
    placed: Placed,
    /// Names that the part's runs have in the whole.
    runs: Vec<String>,
    /// Number of the first of them.
    first_run: usize,
}

impl Part<'_> {
    fn values(&self, whole: &[f64], free: &[Free]) -> Vec<f64> {
        self.placed.values(whole, free)
    }

    fn named(&self, error: PredictionError) -> PredictionError {
        let inside = self.problem.experiment.runs.iter().position(|run| run.name == error.run());
        match inside.and_then(|k| self.runs.get(k)) {
            Some(name) => error.in_run(name),
            None => error,
        }
    }

    /// What `f` gives of the part's own prediction.
    fn predict<R>(&self, f: impl FnOnce(&dyn Predict) -> Result<R, PredictionError>) -> Result<R, PredictionError> {
        self.problem.predict(&self.placed.free, f).and_then(|inside| inside).map_err(|error| self.named(error))
    }
}

/// All parts.
pub(super) struct JointPrediction<'p> {
    layout: &'p Layout,
    free: &'p [Free],
    parts: Vec<Part<'p>>,
}

impl<'p> JointPrediction<'p> {
    pub fn new(problem: &'p Problem, free: &'p [Free]) -> Self {
        let whole = problem;
        let part = |(k, runs): (usize, std::ops::Range<usize>)| {
            let problem = problem.part_of(k);
            Part {
                placed: Placed::of(free, &problem, k),
                problem,
                first_run: runs.start,
                runs: whole.experiment.runs[runs].iter().map(|run| run.name.clone()).collect(),
            }
        };
        let parts = problem.experiment.runs_of_parts().into_iter().enumerate().map(part).collect();
        Self { layout: &problem.layout, free, parts }
    }

    /// How the modelled values depend on what is open of the starts of windows.
    pub fn free_starts(&self, values: &[f64]) -> Result<Vec<FreeStart>, PredictionError> {
        let mut all = Vec::new();
        for part in &self.parts {
            let own = part.values(values, self.free);
            let starts = part.problem.strategy().free_starts(&part.problem, &part.placed.free, &own);
            let starts = starts.map_err(|error| part.named(error))?;
            all.extend(starts.into_iter().map(|start| FreeStart { run: start.run + part.first_run, ..start }));
        }
        Ok(all)
    }

    fn values_by(
        &self,
        free: &[f64],
        of: impl Fn(&dyn Predict, &[f64]) -> Result<Vec<f64>, PredictionError>,
    ) -> Result<Vec<f64>, PredictionError> {
        let mut all = Vec::with_capacity(self.layout.len());
        for part in &self.parts {
            let own = part.values(free, self.free);
            all.extend(part.predict(|predict| of(predict, &own))?);
        }
        Ok(all)
    }

    fn slopes_by(
        &self,
        free: &[f64],
        of: impl Fn(&dyn Predict, &[f64]) -> Result<(Vec<f64>, Vec<Vec<f64>>), PredictionError>,
    ) -> Result<(Vec<f64>, Vec<Vec<f64>>), PredictionError> {
        let mut all = Vec::with_capacity(self.layout.len());
        let mut slopes = vec![vec![0.0; self.layout.len()]; free.len()];
        for part in &self.parts {
            let own = part.values(free, self.free);
            let (values, of_part) = part.predict(|predict| of(predict, &own))?;
            let here = all.len()..all.len() + values.len();
            all.extend(values);
            part.placed.each_slope(free, self.free, |k, own, rate| {
                let column = slopes[k][here.clone()].iter_mut().zip(&of_part[own]);
                column.for_each(|(slope, of_part)| *slope += rate * of_part);
            });
        }
        Ok((all, slopes))
    }
}

impl Predict for JointPrediction<'_> {
    fn layout(&self) -> &Layout {
        self.layout
    }

    fn answers(&self, free: &[f64]) -> Result<Answers, PredictionError> {
        let mut all = Answers { values: Vec::with_capacity(self.layout.len()), unanswered: Vec::new() };
        for part in &self.parts {
            let own = part.values(free, self.free);
            let answers = part.predict(|predict| predict.answers(&own))?;
            all.values.extend(answers.values);
            for mut rows in answers.unanswered {
                rows.error = part.named(rows.error);
                rows.run += part.first_run;
                all.unanswered.push(rows);
            }
        }
        Ok(all)
    }

    fn slopes(&self, free: &[f64]) -> Result<(Vec<f64>, Vec<Vec<f64>>), PredictionError> {
        self.slopes_by(free, |predict, own| predict.slopes(own))
    }

    fn values_onward(&self, free: &[f64]) -> Result<Vec<f64>, PredictionError> {
        self.values_by(free, |predict, own| predict.values_onward(own))
    }

    fn slopes_onward(&self, free: &[f64]) -> Result<(Vec<f64>, Vec<Vec<f64>>), PredictionError> {
        self.slopes_by(free, |predict, own| predict.slopes_onward(own))
    }

    /// That of the part whose fits end first.
    fn tolerance(&self) -> f64 {
        let of = |part: &Part| part.predict(|predict| Ok(predict.tolerance())).unwrap_or(0.0);
        self.parts.iter().map(of).fold(0.0, f64::max)
    }

    fn derivatives(&self) -> Derivatives {
        let exact = |part: &Part| {
            part.predict(|predict| Ok(predict.derivatives())).is_ok_and(|derivatives| derivatives == Derivatives::Exact)
        };
        if self.parts.iter().all(exact) { Derivatives::Exact } else { Derivatives::Differences }
    }
}
