//! Heights as plain CSV, a line a row.

use super::{Problem, Raw};

/// What a file of bare numbers does not say: spacing, place, and which row comes first.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct CsvGrid {
    /// Spacing of the nodes, m.
    pub cell: f64,
    /// Place of the south-western node, m.
    pub origin: [f64; 2],
    /// Whether the first row is the northern one.
    pub from_north: bool,
}

impl Default for CsvGrid {
    fn default() -> Self {
        Self { cell: 1.0, origin: [0.0, 0.0], from_north: false }
    }
}

impl CsvGrid {
    /// Heights in the file's order, as a map's.
    pub(super) fn raw(&self, columns: usize, rows: usize, heights: Vec<f64>) -> Raw {
        let heights = if self.from_north { super::from_north(heights, columns) } else { heights };
        Raw { columns, rows, cell: self.cell, origin: self.origin, heights }
    }
}

/// Reads rows of numbers separated by commas, semicolons or blanks; an empty cell and `nan` are holes.
pub fn parse(text: &str, grid: &CsvGrid) -> Result<Raw, Problem> {
    let (mut columns, mut rows, mut heights) = (0, 0, Vec::new());
    for (number, line) in text.lines().enumerate().filter(|(_, line)| !line.trim().is_empty()) {
        let cells: Vec<&str> = if line.contains([',', ';']) {
            line.split([',', ';']).map(str::trim).collect()
        } else {
            line.split_whitespace().collect()
        };
        if rows == 0 {
            columns = cells.len();
        }
        if cells.len() != columns {
            return Err(Problem::at(
                number + 1,
                format!("{} heights; expected {columns} as in the first row", cells.len()),
            ));
        }
        for cell in cells {
            let height = if cell.is_empty() { Ok(f64::NAN) } else { cell.parse::<f64>() };
            heights
                .push(height.map_err(|_| Problem::at(number + 1, format!("`{cell}`; expected a height in metres")))?);
        }
        rows += 1;
    }
    Ok(grid.raw(columns, rows, heights))
}
