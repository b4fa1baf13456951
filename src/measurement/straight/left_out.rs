//! What is left out of a file, in words.

use super::{LEAST_WAY, SHORTEST};
use crate::measurement::doubts::Doubts;
use crate::measurement::error::{ExperimentError, Problem};
use std::ops::Range;
use std::path::Path;

/// How much of a file is left out.
#[derive(Default)]
pub(in crate::measurement) struct LeftOut {
    rows: usize,
    of: usize,
    stretches: usize,
    radius: f64,
    /// Whether the drive needs more in curves that usually count as straight.
    gentle: bool,
}

impl LeftOut {
    /// Counts a run of which `pieces` are left; `radius` is that of the tightest curve that counts as straight, m, and `usual` the one that
    /// does where the drive needs no more in curves.
    pub fn count(&mut self, rows: usize, pieces: &[Range<usize>], [radius, usual]: [f64; 2]) {
        self.of += rows;
        self.rows += rows - pieces.iter().map(Range::len).sum::<usize>();
        self.stretches += pieces.len();
        (self.radius, self.gentle) = (radius, radius > usual);
    }

    /// Adds a doubt that counts the rows that are left out, where there are any.
    ///
    /// # Errors
    /// [`ExperimentError`] where nothing is left.
    pub fn say(&self, file: &Path, doubts: &mut Doubts) -> Result<(), ExperimentError> {
        let Self { rows, of, stretches, radius, gentle } = self;
        let curve = match gentle {
            true => {
                format!("a curve of a radius under {radius:.0} m, in which its drive needs more than straight ahead")
            }
            false => format!("a curve of a radius under {radius:.1} m"),
        };
        if *rows == 0 {
            return Ok(());
        }
        if *stretches == 0 {
            let message = format!(
                "the vehicle nowhere drives straight for {SHORTEST} s and {LEAST_WAY} m (outside of {curve}), and the model is planar"
            );
            return Err(ExperimentError::in_file(file, Problem::Derived(message)));
        }
        let runs = if *stretches == 1 {
            "one straight stretch".to_owned()
        } else {
            format!("{stretches} straight stretches, each a run of its own")
        };
        doubts.add(
            file,
            format!(
                "{rows} of {of} rows are left out: the vehicle turns there ({curve}), stands, or drives \
                 straight for less than {SHORTEST} s or {LEAST_WAY} m in between, and the model is planar; the others are {runs}"
            ),
        );
        Ok(())
    }
}
