//! How the runs of a problem are stepped and cut into windows.

use super::Problem;
use crate::diagnosis::diagnose::Noise;
use crate::diagnosis::prediction::PredictionError;
use crate::diagnosis::windows::free::{FreeStart, carried_over};
use crate::diagnosis::windows::{Window, Windows, cut, displaced};
use crate::model::ControlKind;
use std::borrow::Cow;
use std::sync::Arc;

/// Different windows over which a search finds its way.
const ROUGH_WINDOWS: usize = 16;

impl<'a> Problem<'a> {
    /// Steps simulations as coarsely as the kind of the experiment allows, where the model's own step is finer. Drives with their own loop keep
    /// their step.
    pub fn coarsen(&mut self) {
        self.steps = self.strategy().coarse_steps(&self.experiment);
        self.own_steps = self.models.iter().map(|model| model.stepping.step_size).collect();
        self.step_by_first();
    }

    /// Takes the inner step that was found exact enough for another experiment with this rig.
    pub fn step_as(&mut self, other: &Problem) {
        if !other.own_steps.is_empty() {
            self.coarsen();
            self.steps.retain(|step| other.steps.contains(step));
            self.step_by_first();
        }
    }

    /// Takes the next finer step; whether there is one.
    pub fn refine_step(&mut self) -> bool {
        if self.steps.is_empty() {
            return false;
        }
        self.steps.remove(0);
        self.sensitivities = None;
        self.step_by_first();
        true
    }

    fn step_by_first(&mut self) {
        let step = self.steps.first().copied().unwrap_or(0.0);
        for (model, own) in self.models.iter_mut().zip(&self.own_steps) {
            if model.control.kind != ControlKind::SpeedLoop {
                model.stepping.step_size = own.max(step);
            }
        }
    }

    /// Cuts the runs into windows whose starts are free, where they are long or do not begin at rest.
    pub fn cut(&mut self) {
        let windows = self.strategy().windows(&self.experiment, &self.models);
        let unsettled = cut::unsettled(&self.experiment, &windows);
        self.layout.unsettle(unsettled);
        self.layout.free_starts = carried_over(&self.layout, &windows).into_iter().map(Arc::new).collect();
        self.windows = windows;
    }

    /// The same over some of the windows, evenly spread, where there are many; `None` where there are not: near its end a search asks
    /// for all of them, on its way there a few tell as well where to go.
    pub fn thinned(&self) -> Option<Problem<'a>> {
        let chosen = self.some_windows(ROUGH_WINDOWS)?;
        Some(self.over(&|run, window| chosen[run][window]))
    }

    /// Keeps at most so many different windows for all that follows, evenly spread. Returns the same problem over the others, which can
    /// judge the final model; `None` where there are no others.
    pub fn spare(&mut self, most: usize) -> Option<Problem<'a>> {
        let chosen = self.some_windows(most.max(1))?;
        let others = self.over(&|run, window| !chosen[run][window]);
        let is_spared = |(run, windows): (usize, &Vec<Window>)| {
            (0..windows.len()).filter(|k| !chosen[run][*k]).map(|k| windows[k].clone()).collect()
        };
        let spared = self.windows.iter().enumerate().map(is_spared).collect();
        *self = self.over(&|run, window| chosen[run][window]);
        self.spared = spared;
        Some(others)
    }

    /// The same with all windows simulated, also those that take no part in the fits, whose rows still do not count.
    pub fn shown(&self) -> Cow<'_, Problem<'a>> {
        if self.spared.is_empty() {
            return Cow::Borrowed(self);
        }
        let mut shown = self.clone();
        for (run, (windows, spared)) in shown.windows.iter_mut().zip(&self.spared).enumerate() {
            if self.layout.is_left_out(run) && !spared.is_empty() {
                windows.clear();
            }
            windows.extend(spared.iter().cloned());
            windows.sort_by_key(|window| window.rows.start);
        }
        shown.layout.show_spared();
        Cow::Owned(shown)
    }

    /// Modelled values in the layout's order, with what the model gives where no fit looks.
    ///
    /// # Errors
    /// [`PredictionError`] where the model cannot be placed on a run.
    pub fn with_spared(
        &self,
        effects: &[String],
        values: &[f64],
        modelled: Vec<f64>,
    ) -> Result<Vec<f64>, PredictionError> {
        if self.spared.is_empty() {
            return Ok(modelled);
        }
        let all = match self.shown().predict(&self.free(effects), |predict| predict.answers(values))? {
            Err(PredictionError::Interrupted) => return Ok(modelled),
            answers => answers?.values,
        };
        let filled = modelled.into_iter().zip(all).map(|(fitted, shown)| if fitted.is_nan() { shown } else { fitted });
        Ok(filled.collect())
    }

    /// Windows, at most `most` different ones and evenly spread: of each run which are among them. Runs that repeat each other have the same.
    /// `None` where there are no more.
    fn some_windows(&self, most: usize) -> Option<Vec<Vec<bool>>> {
        let counting = |run: &usize| !self.layout.is_left_out(*run);
        let all: usize = (0..self.windows.len()).filter(counting).map(|run| self.windows[run].len()).sum();
        let one_of = all.div_ceil(most * self.repeated().max(1));
        if !self.is_cut() || one_of < 2 {
            return None;
        }
        let of_run = |(run, windows): (usize, &Vec<Window>)| {
            let first = self.windows.iter().position(|other| other == windows).unwrap_or(run);
            (1..=windows.len()).map(|number| (number + first) % one_of == 0).collect()
        };
        Some(self.windows.iter().enumerate().map(of_run).collect())
    }

    /// The same over those windows (run, window) that are kept; the rows of the others are spared.
    fn over(&self, keep: &dyn Fn(usize, usize) -> bool) -> Problem<'a> {
        let mut part = self.clone();
        for (run, windows) in self.windows.iter().enumerate().filter(|(_, windows)| !windows.is_empty()) {
            let kept: Vec<Window> = (0..windows.len()).filter(|k| keep(run, *k)).map(|k| windows[k].clone()).collect();
            let dropped = (0..windows.len()).filter(|k| !keep(run, *k));
            part.layout.spare(dropped.flat_map(|k| windows[k].rows.clone()).map(|row| (run, row)));
            // A run without windows would be replayed as a whole; one of which no row counts is not simulated.
            part.windows[run] = if kept.is_empty() { windows[..1].to_vec() } else { kept };
        }
        let windows = &part.windows;
        let number = |run: usize, window: usize| {
            let cut = &self.windows[run][window];
            windows[run].iter().position(|kept| kept.rows == cut.rows)
        };
        let kept = self.layout.free_starts.iter().filter_map(|start| {
            let window = number(start.run, start.window)?;
            Some(Arc::new(FreeStart { window, ..(**start).clone() }))
        });
        part.layout.free_starts = kept.collect();
        part
    }

    /// How many runs share a simulation, on average, since they repeat each other.
    fn repeated(&self) -> usize {
        let counting = |run: &usize| !self.windows[*run].is_empty() && !self.layout.is_left_out(*run);
        let cut: Vec<&Vec<Window>> = (0..self.windows.len()).filter(counting).map(|run| &self.windows[run]).collect();
        let different = (0..cut.len()).filter(|run| !cut[..*run].contains(&cut[*run])).count();
        cut.len() / different.max(1)
    }

    /// Whether any run is cut.
    pub fn is_cut(&self) -> bool {
        self.windows.iter().any(|windows| !windows.is_empty())
    }

    /// Takes these windows, whose starts are free as the baseline with `effects` at `values` depends on them.
    ///
    /// # Errors
    /// [`PredictionError`] where the model gives nothing there.
    pub fn begin_windows(
        &mut self,
        windows: Windows,
        (effects, values): (&[String], &[f64]),
    ) -> Result<(), PredictionError> {
        self.windows = windows;
        self.sensitivities = None;
        let starts = self.strategy().free_starts(self, &self.free(effects), values)?;
        self.layout.free_starts = starts.into_iter().map(Arc::new).collect();
        Ok(())
    }

    /// Begins the windows where the baseline with `effects` at `values` brings them nearest to the measurements.
    ///
    /// # Errors
    /// [`PredictionError`] where the model gives nothing there.
    pub fn refine_starts(
        &mut self,
        noise: &Noise,
        (effects, values): (&[String], &[f64]),
    ) -> Result<(), PredictionError> {
        self.begin_windows(self.windows.clone(), (effects, values))?;
        let Some(whitening) = noise.whitening(self, &|_, _| true) else { return Ok(()) };
        let modelled = self.predict(&self.free(effects), |predict| predict.values_onward(values))??;
        let residual: Vec<f64> = modelled.iter().zip(&self.layout.measured).map(|(m, y)| m - y).collect();
        self.begin_windows(displaced(&self.windows, &whitening.best_starts(&residual)), (effects, values))
    }
}
