//! How a traverse depends on what is open of the starts of its windows.

use super::prediction::TraversePrediction;
use crate::diagnosis::layout::Block;
use crate::diagnosis::prediction::PredictionError;
use crate::diagnosis::recorded::{Drives, Recorded};
use crate::diagnosis::windows::OPEN;
use crate::diagnosis::windows::free::FreeStart;
use crate::model::ControlKind;
use crate::parallel::map_in_order;
use crate::rover::Rover;
use crate::scalar::Dual;

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
        let Drives::Open(replay) = &run.drives else { return Ok(Vec::new()) };
        if run.windows.is_empty() {
            return Ok(Vec::new());
        }
        let model = self.model(run, free)?;
        let numbers = if model.control.kind == ControlKind::Torque { OPEN } else { 1 };
        // More derivatives than are asked for: a width of its own would be one more copy of the physics to compile.
        let rover: Rover<Dual<8>> = model.rover.map(&Dual::from);
        let open = |start: [f64; OPEN]| {
            std::array::from_fn(|k| {
                let value = Dual::<8>::from(start[k]);
                if k < numbers { value.derivative(k) } else { value }
            })
        };
        let traced = run.windowed(replay, &rover, Dual::from(model.start.x0), &open, self.halt)?;
        let slope = |value: &Dual<8>, k: usize| value.eps.0.map_or(0.0, |eps| eps[k]);
        let finite = |x: f64| if x.is_finite() { x } else { 0.0 };
        Ok((0..numbers).map(|k| traced.values.iter().map(|value| finite(slope(value, k))).collect()).collect())
    }
}
