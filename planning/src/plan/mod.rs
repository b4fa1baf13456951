//! The thesis's planner (3.2): a fast search on a performance index, a model-based evaluation of the path found, raised cost where
//! the rover would fail, and again.

mod binary;
mod evaluate;
mod index;
mod outcome;
mod planner;
mod search;

pub use binary::{BinaryPath, binary_path, obstacle_density, obstacles};
pub use evaluate::{Assessment, Evaluator, Failure, Limits};
pub use index::{CostField, PerformanceIndex};
pub use outcome::{Measure, PathPoint, Plan, PlanError, Unreachable};
pub(crate) use planner::ground_node;
pub use planner::{Localisation, Planner, Request};

use crate::map::ElevationMap;
use std::f64::consts::FRAC_PI_4;

/// Directions of travel on the grid, 45 degrees apart, from east.
pub const HEADINGS: usize = 8;

/// Steps (columns, rows) of the headings.
const STEPS: [(i64, i64); HEADINGS] = [(1, 0), (1, 1), (0, 1), (-1, 1), (-1, 0), (-1, -1), (0, -1), (1, -1)];

/// A node of the map and the heading in which the rover stands on it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Stand {
    /// Column.
    pub column: usize,
    /// Row.
    pub row: usize,
    /// Heading in eighths of a turn from east, counter-clockwise.
    pub heading: usize,
}

impl Stand {
    /// Heading, rad from east to north.
    #[must_use]
    pub fn angle(self) -> f64 {
        self.heading as f64 * FRAC_PI_4
    }

    /// Place on the map, m.
    #[must_use]
    pub fn place(self, map: &ElevationMap) -> [f64; 2] {
        map.place(self.column, self.row)
    }

    /// Where a step in `heading` leads, on a map of these sizes.
    fn ahead(self, heading: usize, columns: usize, rows: usize) -> Option<Self> {
        let (dc, dr) = STEPS[heading];
        let column = self.column.checked_add_signed(dc as isize).filter(|column| *column < columns)?;
        let row = self.row.checked_add_signed(dr as isize).filter(|row| *row < rows)?;
        Some(Self { column, row, heading })
    }
}

/// Length of a step in a heading, in spacings.
fn step_length(heading: usize) -> f64 {
    if heading.is_multiple_of(2) { 1.0 } else { std::f64::consts::SQRT_2 }
}
