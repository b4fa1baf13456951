//! Several experiments on one soil on the workbench: each of them as it is shown, under names of its own.

use super::settable::Settable;
use super::{Trial, Values, Workbench};
use crate::diagnosis::compare::CompareError;
use crate::diagnosis::curves::{Axis, Curves};
use crate::diagnosis::failure::failures;
use crate::diagnosis::noise::NoiseFloor;
use crate::diagnosis::problem::Problem;
use crate::diagnosis::unanswered::UnansweredRows;
use crate::diagnosis::uncounted::UncountedRows;
use crate::measurement::Part;
use crate::model::Model;
use std::collections::BTreeMap;
use std::ops::Range;
use std::sync::Arc;

impl Workbench {
    /// The experiments that share a soil, each held ready by itself: with what the others state of the soil, the rows that count in the
    /// set, and the noise that was found there. What they share is tried with the values of [`values_of_part`](Self::values_of_part). None
    /// where there is one experiment.
    #[must_use]
    pub fn parts(&self) -> &[Self] {
        &self.parts
    }

    /// The parts of a set; see [`parts`](Self::parts).
    pub(super) fn parts_of(problem: &Problem, floors: &BTreeMap<String, NoiseFloor>) -> Arc<[Self]> {
        let part = |(k, part): (usize, &Part)| {
            let problem = problem.part_by_itself(k);
            let own = |(signal, floor): (&String, &NoiseFloor)| Some((part.own(signal)?.to_owned(), *floor));
            Self {
                settable: Arc::new(Settable::of(&problem)),
                problem,
                floors: floors.iter().filter_map(own).collect(),
                baseline: None,
                parts: Arc::default(),
            }
        };
        problem.experiment.parts.iter().enumerate().map(part).collect()
    }

    /// What `values` of the set's parameters are in part number `part`: under the names of its own model, with the effects that act
    /// there and its scatter of the soil, without what such an experiment does not depend on. The scatter may carry a value beyond the bounds
    /// of a calibration, where a [trial](Self::trial) of the part by itself refuses it.
    ///
    /// # Errors
    /// [`CompareError`] where a name or a value is not allowed.
    pub fn values_of_part(&self, part: usize, values: &Values) -> Result<Values, CompareError> {
        self.check(values)?;
        let (effects, all) = self.all_values(values);
        let mut own = self.problem.values_in_part(part, &self.problem.free(&effects), &all);
        own.retain(|name, _| self.parts[part].settable.has(name));
        for (name, value) in values {
            let Some((parts, name)) = self.settable.places(name) else { continue };
            if parts.contains(&part) {
                let _ = own.insert(name.to_owned(), *value);
            }
        }
        Ok(own)
    }

    /// The model of part number `part` with these values of the set's parameters, as `compare` and `diagnose` save it.
    ///
    /// # Errors
    /// [`CompareError`] where a name or a value is not allowed.
    pub fn model_of_part(&self, part: usize, values: &Values) -> Result<Model, CompareError> {
        self.check(values)?;
        let (effects, all) = self.all_values(values);
        Ok(self.placed(values).saved_parts(&self.problem.free(&effects), &all).swap_remove(part).1)
    }

    /// What a trial of the set at `values` shows of part number `part`, under names of its own; with `in_motion` also how the model's rover
    /// moves in it.
    ///
    /// # Errors
    /// [`CompareError`] where a name or a value is not allowed.
    pub fn trial_of_part(
        &self,
        part: usize,
        trial: &Trial,
        values: &Values,
        in_motion: bool,
    ) -> Result<Trial, CompareError> {
        let mut shown = self.shown_of_part(part, trial);
        if in_motion {
            shown.fit = self.parts[part].moving(shown.fit, &self.values_of_part(part, values)?)?;
        }
        Ok(shown)
    }

    /// Curves of part number `part` where the set's parameters are `values`; see [`sketch`](Self::sketch).
    ///
    /// # Errors
    /// [`CompareError`] where a name or a value is not allowed.
    pub fn sketch_of_part(&self, part: usize, axis: Axis, values: &Values) -> Result<Option<Curves>, CompareError> {
        Ok(self.parts[part].sketched(axis, &self.values_of_part(part, values)?))
    }

    fn shown_of_part(&self, part: usize, trial: &Trial) -> Trial {
        let own = &self.parts[part];
        let fit = trial.fit.of_part(&self.problem.experiment.parts[part], self.runs_of(part));
        let failures = failures(own.experiment(), &fit, &own.floors);
        let of_part =
            |rows: &UnansweredRows| Some(UnansweredRows { run: self.own_run(part, &rows.run)?, ..rows.clone() });
        Trial { unanswered: trial.unanswered.iter().filter_map(of_part).collect(), failures, fit }
    }

    /// Rows of part number `part` that no error counts, under the names of its own runs.
    #[must_use]
    pub fn uncounted_of_part(&self, part: usize) -> Vec<UncountedRows> {
        let own = |rows: UncountedRows| Some(UncountedRows { run: self.own_run(part, &rows.run)?, ..rows });
        self.uncounted().into_iter().filter_map(own).collect()
    }

    fn runs_of(&self, part: usize) -> Range<usize> {
        self.problem.experiment.runs_of_parts()[part].clone()
    }

    /// Name that a run of the set has in part number `part`, if it is one of its runs.
    fn own_run(&self, part: usize, name: &str) -> Option<String> {
        let runs = self.runs_of(part);
        let at = self.problem.experiment.runs[runs.clone()].iter().position(|run| run.name == name)?;
        Some(self.parts[part].experiment().runs[at].name.clone())
    }
}
