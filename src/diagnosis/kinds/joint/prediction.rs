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

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test may fail by panicking")]
mod tests {
    use crate::diagnosis::SingleWheelPlan;
    use crate::diagnosis::given::Given;
    use crate::diagnosis::problem::Problem;
    use crate::measurement::Experiment;
    use crate::model::Model;

    /// Relative step of the differences, and how well they agree with the derivatives: about its square, times a thousand.
    const STEP: f64 = 1e-5;
    const AGREE: f64 = 1e-6;

    /// Two wheels of different width, nothing measured yet.
    fn pair() -> Experiment {
        let wheel = |width: f64| {
            let mut model = Model::preset("two_wheeled").unwrap();
            model.rover.wheel.width = width;
            let mut plan = SingleWheelPlan::of(&model);
            (plan.repeats, plan.slips) = (1, vec![0.1, 0.4]);
            let mut experiment = plan.experiment().unwrap();
            experiment.name = format!("wheel{}", (100.0 * width) as u32);
            experiment
        };
        Experiment::joint(vec![wheel(0.10), wheel(0.16)]).unwrap()
    }

    #[test]
    fn agreement_derivatives_are_those_of_differences() {
        let experiment = pair();
        let problem = Problem::new(Given::default(), &experiment, &[]).unwrap();
        // A strength everywhere and one that is added to it in the second wheel.
        let free = problem.free(&["slip_sinkage".to_owned(), "slip_sinkage in wheel16".to_owned()]);
        let inside = |free: &crate::diagnosis::free::Free| match free.variable.name.as_str() {
            name if name.starts_with("slip_sinkage") => 0.1,
            name if name.starts_with("soil_scatter") => 1.02,
            "soil.k_c" => 5e3,
            _ => free.start,
        };
        let at: Vec<f64> = free.iter().map(inside).collect();
        problem
            .predict(&free, |predict| {
                let (values, slopes) = predict.slopes(&at).unwrap();
                for (k, slope) in slopes.iter().enumerate() {
                    let step = STEP * at[k].abs().max(1e-3);
                    let beside = |side: f64| {
                        let mut moved = at.clone();
                        moved[k] += side * step;
                        predict.values(&moved).unwrap()
                    };
                    let (up, down) = (beside(1.0), beside(-1.0));
                    let scale = slope.iter().fold(0.0_f64, |most, s| most.max(s.abs())) + 1e-9 / step;
                    for row in 0..values.len() {
                        let difference = (up[row] - down[row]) / (2.0 * step);
                        let name = &free[k].variable.name;
                        assert!(
                            (difference - slope[row]).abs() < AGREE * scale,
                            "{name}, row {row}: {difference} {}",
                            slope[row]
                        );
                    }
                }
            })
            .unwrap();
    }

    #[test]
    fn property_a_parameter_of_one_part_moves_nothing_else() {
        let experiment = pair();
        let problem = Problem::new(Given::default(), &experiment, &[]).unwrap();
        let free = problem.free(&["slip_sinkage in wheel16".to_owned()]);
        let at: Vec<f64> = free.iter().map(|free| free.start).collect();
        let (_, slopes) = problem.predict(&free, |predict| predict.slopes(&at)).unwrap().unwrap();
        let strength = slopes.last().unwrap();
        let moved = |runs: std::ops::Range<usize>| {
            let blocks = problem.layout.blocks.iter().filter(|block| runs.contains(&block.run));
            blocks.flat_map(|block| strength[block.range.clone()].iter()).any(|slope| *slope != 0.0)
        };
        let [first, second] = experiment.runs_of_parts().try_into().unwrap();
        assert!(!moved(first) && moved(second));
    }
}
