//! How a traverse depends on what is open of the starts of its windows.

use super::differences::SHIFT;
use super::prediction::TraversePrediction;
use crate::diagnosis::layout::Block;
use crate::diagnosis::prediction::PredictionError;
use crate::diagnosis::recorded::{Drives, Recorded, Traced, Variant, traced};
use crate::diagnosis::windows::OPEN;
use crate::diagnosis::windows::free::FreeStart;
use crate::model::ControlKind;
use crate::parallel::map_in_order;

impl TraversePrediction<'_> {
    /// How the modelled values depend on what is open of the starts of windows. The velocity is open where torques were
    /// commanded: imposed speeds set it within milliseconds.
    ///
    /// # Errors
    /// [`PredictionError`] where the model gives nothing at `free`.
    pub fn free_starts(&self, free: &[f64]) -> Result<Vec<FreeStart>, PredictionError> {
        let slopes = map_in_order(&self.runs, |run| self.slopes_of_starts(run, free));
        let mut columns = vec![vec![0.0; self.layout.len()]; OPEN];
        let mut open = Vec::new();
        for (run, slopes) in self.runs.iter().zip(slopes) {
            let slopes = slopes?;
            open.push(slopes.len());
            slopes.iter().zip(&mut columns).for_each(|(slope, column)| run.store(slope, column));
        }
        let mut starts = Vec::new();
        for (k, place) in self.places.iter().enumerate() {
            let Some(place) = *place else { continue };
            for (number, column) in columns.iter().enumerate().take(open[place]) {
                for (window, cut) in self.runs[place].windows.iter().enumerate().filter(|(_, cut)| cut.start.is_some())
                {
                    let own = |block: &Block| column[block.range.clone()][cut.rows.clone()].to_vec();
                    let slopes = self.layout.of_run(k).map(own).collect();
                    starts.push(FreeStart { run: k, window, number, rows: cut.rows.clone(), slopes });
                }
            }
        }
        Ok(starts)
    }

    /// Derivatives of a run's signals in place and, where torques were commanded, velocity in which its windows begin; none where
    /// all of it is replayed as a whole.
    fn slopes_of_starts(&self, run: &Recorded, free: &[f64]) -> Result<Vec<Vec<f64>>, PredictionError> {
        if run.windows.is_empty() || !matches!(run.drives, Drives::Open(_)) {
            return Ok(Vec::new());
        }
        let model = self.model(run, free)?;
        let numbers = if model.control.kind == ControlKind::Torque { OPEN } else { 1 };
        let shifted = |number: Option<usize>| {
            let shift = std::array::from_fn(|k| if number == Some(k) { SHIFT } else { 0.0 });
            Variant { shift, ..Variant::new(run, model.clone()) }
        };
        let variants: Vec<Variant> = [None].into_iter().chain((0..numbers).map(Some)).map(shifted).collect();
        let mut all = traced(&variants, self.halt).into_iter();
        let Some(own) = all.next() else { return Ok(Vec::new()) };
        let own = own?;
        let finite = |x: f64| if x.is_finite() { x } else { 0.0 };
        let slope = |changed: Result<Traced<f64>, PredictionError>| {
            Ok(run.slope(&own, &changed?, SHIFT).into_iter().map(finite).collect())
        };
        all.map(slope).collect()
    }
}
