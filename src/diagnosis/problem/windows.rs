//! How the runs of a problem are stepped and cut into windows.

use super::Problem;
use crate::diagnosis::diagnose::Noise;
use crate::diagnosis::prediction::PredictionError;
use crate::diagnosis::windows::free::{FreeStart, carried_over};
use crate::diagnosis::windows::{Windows, cut, displaced};
use crate::model::ControlKind;
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
        if !self.is_cut() {
            return None;
        }
        let all: usize = self.windows.iter().map(Vec::len).sum();
        let keep_one_of = all.div_ceil(ROUGH_WINDOWS * self.repeated());
        if keep_one_of < 2 {
            return None;
        }
        let mut thin = self.clone();
        let (mut dropped, mut without) = (Vec::new(), Vec::new());
        for (run, windows) in thin.windows.iter_mut().enumerate() {
            if windows.is_empty() {
                continue;
            }
            // Runs that repeat each other keep the same windows.
            let mut number = 0;
            let first = self.windows.iter().position(|other| *other == *windows).unwrap_or(run);
            windows.retain(|window| {
                number += 1;
                let kept = (number + first) % keep_one_of == 0;
                if !kept {
                    dropped.extend(window.rows.clone().map(|row| (run, row)));
                }
                kept
            });
            if windows.is_empty() {
                // A run without windows would be replayed as a whole: it is left out.
                without.extend((0..self.experiment.runs[run].data.rows()).map(|row| (run, row)));
                windows.extend(self.windows[run].first().cloned());
            }
        }
        let thin_windows = &thin.windows;
        let number = |run: usize, window: usize| {
            let cut = &self.windows[run][window];
            thin_windows[run].iter().position(|kept| kept.rows == cut.rows)
        };
        let kept = self.layout.free_starts.iter().filter_map(|start| {
            let window = number(start.run, start.window)?;
            Some(Arc::new(FreeStart { window, ..(**start).clone() }))
        });
        thin.layout.free_starts = kept.collect();
        thin.layout.unsettle(dropped);
        thin.layout.leave_out(&without);
        Some(thin)
    }

    /// How many runs share a simulation, on average, since they repeat each other.
    fn repeated(&self) -> usize {
        let cut: Vec<_> = self.windows.iter().filter(|windows| !windows.is_empty()).collect();
        let different = (0..cut.len()).filter(|run| !cut[..*run].contains(&cut[*run])).count();
        cut.len() / different.max(1)
    }

    /// Whether any run is cut.
    pub fn is_cut(&self) -> bool {
        self.windows.iter().any(|windows| !windows.is_empty())
    }

    /// Takes these windows, whose starts are free as the baseline at `values` depends on them.
    ///
    /// # Errors
    /// [`PredictionError`] where the model gives nothing there.
    pub fn begin_windows(&mut self, windows: Windows, values: &[f64]) -> Result<(), PredictionError> {
        self.windows = windows;
        self.sensitivities = None;
        let starts = self.strategy().free_starts(self, &self.base, values)?;
        self.layout.free_starts = starts.into_iter().map(Arc::new).collect();
        Ok(())
    }

    /// Begins the windows where the baseline at `values` brings them nearest to the measurements.
    ///
    /// # Errors
    /// [`PredictionError`] where the model gives nothing there.
    pub fn refine_starts(&mut self, noise: &Noise, values: &[f64]) -> Result<(), PredictionError> {
        self.begin_windows(self.windows.clone(), values)?;
        let Some(whitening) = noise.whitening(self, &|_, _| true) else { return Ok(()) };
        let modelled = self.predict(&self.base, |predict| predict.values_onward(values))??;
        let residual: Vec<f64> = modelled.iter().zip(&self.layout.measured).map(|(m, y)| m - y).collect();
        self.begin_windows(displaced(&self.windows, &whitening.best_starts(&residual)), values)
    }
}
