//! Several experiments on one soil, fitted together: each part is predicted by the strategy of its own kind.

mod prediction;

use super::single_wheel::SingleWheel;
use super::soil_test::SHEAR;
use super::traverse::Traverse;
use super::{Alikes, Budget, LeftOut, Strategy, strategy};
use crate::diagnosis::calibrate::Calibration;
use crate::diagnosis::compare::CompareError;
use crate::diagnosis::curves::Axis;
use crate::diagnosis::diagnose::{Phase, Shape};
use crate::diagnosis::free::Free;
use crate::diagnosis::halt::Halt;
use crate::diagnosis::layout::Layout;
use crate::diagnosis::least_squares::Pace;
use crate::diagnosis::noise::Scale;
use crate::diagnosis::precedence::Choice;
use crate::diagnosis::prediction::{Predict, PredictionError};
use crate::diagnosis::problem::Problem;
use crate::diagnosis::separate::variation::Variation;
use crate::diagnosis::windows::Windows;
use crate::diagnosis::windows::free::FreeStart;
use crate::measurement::{Experiment, Kind, Part};
use crate::model::{Model, ModelKind};
use bekker_modeldescription::Variable;
use prediction::JointPrediction;
use std::collections::BTreeMap;
use std::ops::Range;

/// Single effects that are refitted where a rover drives: each has two or three forms, by where it acts.
const SINGLES: usize = 24;

/// The strategy for a set of experiments.
#[derive(Debug)]
pub(super) struct Joint {
    /// Whether a rover drives in one of them, whose simulation takes tenths of a second.
    driven: bool,
}

/// Of wheels on carriages and tests of the soil.
pub(super) const STEADY: Joint = Joint { driven: false };
/// With drives among them.
pub(super) const DRIVEN: Joint = Joint { driven: true };

impl Joint {
    /// The kind of experiment that decides what is affordable: the one whose fits take longest.
    fn dearest(&self) -> &'static dyn Strategy {
        if self.driven { &Traverse } else { &SingleWheel }
    }
}

/// The parts with the runs of each.
fn parts(experiment: &Experiment) -> impl Iterator<Item = (&Part, Range<usize>)> {
    experiment.parts.iter().zip(experiment.runs_of_parts())
}

/// Shapes of each part, which are zero in the others.
fn of_parts(
    experiment: &Experiment,
    layout: &Layout,
    modelled: &[f64],
    shapes: impl Fn(&dyn Strategy, &Experiment, &Layout, &[f64]) -> Vec<Shape>,
) -> Vec<Shape> {
    let zero: Shape = experiment.runs.iter().map(|run| vec![0.0; run.data.rows()]).collect();
    let mut all = Vec::new();
    for (part, runs) in parts(experiment) {
        let own = &part.experiment;
        let of_part = layout.of_runs(own, &runs.clone().collect::<Vec<_>>());
        let values = of_part_values(layout, &runs, modelled);
        for shape in shapes(strategy(own), own, &of_part, &values) {
            let mut whole = zero.clone();
            whole[runs.clone()].clone_from_slice(&shape);
            all.push(whole);
        }
    }
    all
}

/// The values of some runs that follow each other.
fn of_part_values(layout: &Layout, runs: &Range<usize>, values: &[f64]) -> Vec<f64> {
    let blocks = layout.blocks.iter().filter(|block| runs.contains(&block.run));
    blocks.flat_map(|block| values[block.range.clone()].iter().copied()).collect()
}

impl Strategy for Joint {
    /// Each part has a model of its own; the first one's stands for all.
    fn finds(&self, choice: &Choice) -> Result<ModelKind, CompareError> {
        Ok(choice.model.kind)
    }

    /// Of those parts that tell of it.
    fn contact_widths(&self, experiment: &Experiment, models: &[Model]) -> Vec<f64> {
        let tells = |part: &Part| strategy(&part.experiment).calibrates("soil.k_c");
        let of = |(part, runs): (&Part, Range<usize>)| {
            strategy(&part.experiment).contact_widths(&part.experiment, &models[runs])
        };
        let mut widths: Vec<f64> = parts(experiment).filter(|(part, _)| tells(part)).flat_map(of).collect();
        widths.sort_by(f64::total_cmp);
        widths.dedup();
        widths
    }

    fn noise_scale(&self, problem: &Problem, expected: &[f64]) -> Vec<Scale> {
        let mut all = Vec::new();
        let mut differ = false;
        for (k, (part, runs)) in parts(&problem.experiment).enumerate() {
            let values = of_part_values(&problem.layout, &runs, expected);
            let scale = strategy(&part.experiment).noise_scale(&problem.part_of(k), &values);
            differ |= !scale.is_empty();
            all.extend(if scale.is_empty() { vec![Scale::USUAL; values.len()] } else { scale });
        }
        if differ { all } else { Vec::new() }
    }

    /// Of an effect that acts in tests of the soil alone, as there; else as in the dearest kind.
    fn alikes(&self, problem: &Problem, effect: &str) -> Option<Alikes> {
        let places = problem.parts_with(effect);
        let mut acting = problem.experiment.parts.iter().filter(|part| places.contains(&part.name));
        let is_test = |part: &Part| matches!(part.experiment.kind, Kind::PlateSinkage | Kind::Shear);
        if acting.all(is_test) { SHEAR.alikes(problem, effect) } else { self.dearest().alikes(problem, effect) }
    }

    fn assumed_scatter(&self, experiment: &Experiment) -> BTreeMap<String, f64> {
        let of_part = |(part, _): (&Part, _)| {
            let own = strategy(&part.experiment).assumed_scatter(&part.experiment);
            own.into_iter().map(|(signal, share)| (part.signal(&signal), share)).collect::<Vec<_>>()
        };
        parts(experiment).flat_map(of_part).collect()
    }

    fn commanded_wheels(&self, experiment: &Experiment) -> usize {
        parts(experiment)
            .map(|(part, _)| strategy(&part.experiment).commanded_wheels(&part.experiment))
            .max()
            .unwrap_or(0)
    }

    /// Said of each part's own model.
    fn unfit(&self, _: &Model) -> Option<String> {
        None
    }

    fn uncounted_rows(&self, experiment: &Experiment) -> Vec<usize> {
        parts(experiment).flat_map(|(part, _)| strategy(&part.experiment).uncounted_rows(&part.experiment)).collect()
    }

    fn coarse_steps(&self, experiment: &Experiment) -> Vec<f64> {
        let steps = parts(experiment).map(|(part, _)| strategy(&part.experiment).coarse_steps(&part.experiment));
        steps.max_by_key(Vec::len).unwrap_or_default()
    }

    fn prediction<'p>(&self, problem: &'p Problem, free: &'p [Free]) -> Result<Box<dyn Predict + 'p>, PredictionError> {
        Ok(Box::new(JointPrediction::new(problem, free)))
    }

    fn windows(&self, experiment: &Experiment, models: &[Model]) -> Windows {
        let mut all = Windows::new();
        for (part, runs) in parts(experiment) {
            let own = strategy(&part.experiment).windows(&part.experiment, &models[runs.clone()]);
            all.extend(if own.is_empty() { vec![Vec::new(); runs.len()] } else { own });
        }
        all
    }

    fn free_starts(&self, problem: &Problem, free: &[Free], values: &[f64]) -> Result<Vec<FreeStart>, PredictionError> {
        JointPrediction::new(problem, free).free_starts(values)
    }

    fn conditions(&self, experiment: &Experiment) -> Vec<String> {
        let mut names: Vec<String> = Vec::new();
        for (part, _) in parts(experiment) {
            let measured = part.experiment.signals();
            for name in strategy(&part.experiment).conditions(&part.experiment) {
                let name = if measured.contains(&name) { part.signal(&name) } else { name };
                if !names.contains(&name) {
                    names.push(name);
                }
            }
        }
        names
    }

    /// Curves are drawn of each part by itself.
    fn axes(&self) -> &'static [Axis] {
        &[]
    }

    fn parameters(&self, _: &Model) -> Vec<(Variable, f64)> {
        Vec::new()
    }

    fn discrepancy(&self, experiment: &Experiment, layout: &Layout, modelled: &[f64]) -> Vec<Shape> {
        of_parts(experiment, layout, modelled, |own, experiment, layout, values| {
            own.discrepancy(experiment, layout, values)
        })
    }

    fn modulations(&self, experiment: &Experiment, layout: &Layout, modelled: &[f64]) -> Vec<Shape> {
        of_parts(experiment, layout, modelled, |own, experiment, layout, values| {
            own.modulations(experiment, layout, values)
        })
    }

    /// Effects come in two or three forms, by where they act. Where fits are cheap all are refitted, since sensitivities mislead where an
    /// effect's misfit first rises; else those that promise the most.
    fn budget(&self) -> Budget {
        let singles = self.driven.then_some(SINGLES);
        let mut budget = Budget { singles, predicts_whole: true, ..self.dearest().budget() };
        if !self.driven {
            budget.calibration.pace = Pace::MANY;
        }
        budget
    }

    /// The number of fits, and what other work takes in fits.
    fn work(&self, phase: Phase) -> f64 {
        match phase {
            Phase::Baseline | Phase::Noise => 2.0,
            Phase::Singles => 24.0,
            Phase::Sets => 30.0,
            Phase::LeftOut => 12.0,
            Phase::Rivals | Phase::Profiles => 8.0,
            Phase::Next => 1.0,
            Phase::Done => 0.0,
        }
    }

    fn further_starts(&self, promised: bool) -> &'static [f64] {
        self.dearest().further_starts(promised)
    }

    fn left_out(&self, _: &Problem, _: &Calibration) -> LeftOut {
        if self.driven { LeftOut::Step } else { LeftOut::Refit }
    }

    /// Further experiments are planned for a part by itself.
    fn variations(&self, _: &Model, _: &Experiment, _: Halt) -> Vec<Variation> {
        Vec::new()
    }
}
