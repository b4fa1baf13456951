//! Windows that begin elsewhere once an effect is known.
//!
//! The starts of windows are found under the baseline, and what other starts could bring about is taken out to first order. Where the
//! baseline lacks an effect that depends on the place, such as ground that wheels have passed, its best starts may be so far from the
//! right ones that first order is not enough: what is left then looks like a further effect. So the starts are found once more
//! under the effects that were chosen, and where that leaves less by more than noise, the search goes on from there, once.
//!
//! Starts found under one model are a little worse for another, which counts in favour of the effects that were chosen, as far as first order is
//! not enough. They were chosen from starts found under the baseline, where that was against them.

use super::bootstrap::p_value;
use super::far::costs;
use super::fits::Task;
use super::search::Search;
use super::stage::Stage;
use super::untried::Untried;
use crate::diagnosis::thresholds::NAMED;
use crate::diagnosis::windows::Windows;

/// What a second search over windows with other starts needs.
pub(super) struct MovedStarts {
    /// Effects beside the baseline under which the starts were found.
    pub effects: Vec<String>,
    /// Values of the free parameters there.
    pub values: Vec<f64>,
    /// The windows with these starts.
    pub windows: Windows,
    /// Single effects, and the chosen set with its last effects left off one by one, each with the fitted values.
    pub fitted: Vec<(Vec<String>, Vec<f64>)>,
}

impl Search<'_> {
    /// The windows as they begin where the chosen effects bring them nearest to the measurements, if chi-square of the chosen set is lower over them
    /// without any further fit, by more than the best single effect gains by noise alone (p < [`NAMED`]): it could be taken for an effect.
    /// `stage` is the baseline's. `None` also where the model has no answer from there, and where there is no time for a second search.
    pub(super) fn moved_starts(&self, stage: &Stage, chosen: &[String]) -> Option<MovedStarts> {
        if !self.problem.is_cut() || chosen.is_empty() || self.watch.stopped() {
            return None;
        }
        let fit = self.fits.get(chosen)?;
        let values = fit.values();
        let mut moved = self.problem.clone();
        moved.refine_starts(self.noise, (chosen, &values)).ok()?;
        let (left, _) = costs(&moved, self.noise, &moved.task(chosen, vec![values.clone()]))?;
        if p_value(&stage.draws, |draw| draw.single, fit.chi_square - left[0]) >= NAMED {
            return None;
        }
        if !self.watch.has_time_again() {
            self.watch.leave([Untried::Again(chosen.to_vec())]);
            return None;
        }
        let parts = (2..=chosen.len())
            .filter_map(|count| Some((chosen[..count].to_vec(), self.fits.get(&chosen[..count])?.values())));
        let alone = self.fits.of(1).map(|(effects, fit)| (effects.clone(), fit.values()));
        let fitted = alone.chain(parts).collect();
        Some(MovedStarts { effects: chosen.to_vec(), values, windows: moved.windows, fitted })
    }

    /// Makes fits of an earlier search again, each from where it ended.
    pub(super) fn go_on_from(&mut self, fitted: Vec<(Vec<String>, Vec<f64>)>) {
        let again = fitted.into_iter().map(|(effects, values)| self.problem.task(&effects, vec![values]));
        self.settle_all(&again.collect::<Vec<Task>>());
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test may fail by panicking")]
mod tests {
    use super::*;
    use crate::diagnosis::diagnose::control::Control;
    use crate::diagnosis::diagnose::engine::DiagnoseOptions;
    use crate::diagnosis::diagnose::fits::{fit_task, outcome};
    use crate::diagnosis::diagnose::prepare::prepare;
    use crate::diagnosis::diagnose::stage::StageContext;
    use crate::diagnosis::diagnose::watch::Watch;
    use crate::diagnosis::kinds::synthetic::experiment;
    use crate::diagnosis::problem::Problem;
    use crate::measurement::{Experiment, Table};
    use crate::model::{ControlKind, Model};
    use crate::terrain::{Profile, Samples};
    use bekker_modeldescription::Lookup;

    /// Draws of the bootstrap: p-values reach down to 0.005.
    const DRAWS: usize = 199;
    /// Half of a wave of the ground, m: what a start there brings about is not proportional to its displacement.
    const FAR: f64 = 2.0;
    const MEASURED: [(&str, f64); 5] =
        [("x", 0.01), ("velocity", 0.004), ("pitch", 0.002), ("wheel[1].torque", 0.02), ("wheel[2].sinkage", 5e-4)];

    /// The first drive of the synthetic experiment as the model itself makes it.
    fn driven(model: &Model) -> Experiment {
        let mut experiment = experiment("speed_command", false);
        experiment.runs.truncate(1);
        for run in &mut experiment.runs {
            let mut model = model.clone();
            let ground = run.terrain.as_ref().unwrap();
            let samples = Samples::new(ground.column("x").unwrap(), ground.column("z").unwrap()).unwrap();
            model.rover.terrain.profile = Profile::Samples(samples.into());
            let mut simulation = model.start().unwrap();
            let columns = ["time", "wheel[1].speed_command", "wheel[2].speed_command"];
            let mut data = Table::new(columns.into_iter().chain(MEASURED.map(|(name, _)| name))).unwrap();
            for row in 0..run.data.rows() {
                let mut cells: Vec<f64> = columns.iter().map(|name| run.data.column(name).unwrap()[row]).collect();
                let mut signals = simulation.signals().clone();
                cells.extend(MEASURED.map(|(name, _)| signals.get(name).unwrap()));
                data.push(&cells).unwrap();
                simulation.inputs_mut().set_all(&cells[1..3]).unwrap();
                simulation.advance((0.1 / simulation.step_size()).round() as u64).unwrap();
            }
            run.data = data;
        }
        // Two parameters of the soil stay free.
        let soil = &model.rover.soil;
        let known =
            [("cohesion", soil.cohesion), ("k_c", soil.k_c), ("k_phi", soil.k_phi), ("exponent", soil.exponent)];
        let known = known.into_iter().chain([("c1", soil.c1), ("c2", soil.c2)]);
        experiment.parameters = known.map(|(name, value)| (format!("soil.{name}"), value)).collect();
        experiment.noise = MEASURED.map(|(name, noise)| (name.to_owned(), noise)).into();
        experiment
    }

    #[test]
    fn property_starts_are_moved_where_they_leave_more_than_noise() {
        let mut model = Model::preset("two_wheeled").unwrap();
        model.control.kind = ControlKind::Speed;
        model.rover.soil.shear_modulus = 0.01;
        let experiment = driven(&model);
        let drag = ["drag".to_owned()];
        let options = DiagnoseOptions { candidates: Some(drag.to_vec()), ..DiagnoseOptions::default() };
        let mut problem = options.problem(&model, &experiment).unwrap();
        let mut prepared = prepare(&mut problem).unwrap();
        let values = prepared.baseline.values();
        let moves = |problem: &Problem| {
            let whitening = prepared.noise.whitening(problem, &|_, _| true).unwrap();
            let context = StageContext::new(problem, &prepared, &whitening, DRAWS);
            let control = Control::default();
            let watch = Watch::new(&control, problem.strategy());
            let mut search = Search::new(context, prepared.baseline.clone(), &control, &watch);
            let stage = search.stage(&[]).unwrap().unwrap();
            search.fit(vec![search.start(&stage, 0)]);
            search.moved_starts(&stage, &drag)
        };
        assert!(moves(&problem).is_none(), "as they were found");
        let mut windows = problem.windows.clone();
        windows.iter_mut().flatten().for_each(|window| window.displace([FAR, 0.0]));
        problem.begin_windows(windows, (&[], &values)).unwrap();
        let moved = moves(&problem).unwrap();

        // Another machine makes the same fits over the moved windows.
        problem.begin_windows(moved.windows, (&moved.effects, &moved.values)).unwrap();
        prepared.noise.begin_at(&problem, (&moved.effects, &moved.values));
        let task = problem.task(&drag, vec![moved.values]);
        let here = outcome(&problem, &prepared.noise, &task);
        assert_eq!(fit_task(&model, &experiment, &options, &prepared.noise, &task).unwrap(), here);
        assert!(here.is_some());
    }
}
