//! Elevation maps: heights over a square grid.

mod check;
mod filter;
mod generate;
mod read;
mod rocks;
mod surface;

pub use check::{Doubt, Spike};
pub use filter::{RangeError, blurred};
pub use generate::{GroundShape, generated};
pub use read::{CsvGrid, MapReadError};
pub use rocks::{Difficulty, RockyGround, rocky};
pub use surface::{Interpolation, Patch, Surface};

/// Largest number of nodes of a map, against a broken header that asks for all memory.
pub const MAX_NODES: usize = 1 << 28;

/// Heights at the nodes of a square grid.
///
/// Node (column, row) lies at x = `origin[0] + column cell`, y = `origin[1] + row cell`; x points east, y north, so row 0 is
/// the southern edge. A height that is not a number is a hole: ground that nobody has measured.
#[derive(Clone, Debug, PartialEq)]
pub struct ElevationMap {
    columns: usize,
    rows: usize,
    cell: f64,
    origin: [f64; 2],
    heights: Vec<f64>,
}

/// Why heights make no map.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum MapError {
    /// Too few or too many nodes.
    #[error("a map of {columns} x {rows} nodes; expected at least 2 x 2 and at most {MAX_NODES} in all")]
    Size {
        /// Nodes along x.
        columns: usize,
        /// Nodes along y.
        rows: usize,
    },
    /// The number of heights is another than that of the nodes.
    #[error("{got} heights were given for {columns} x {rows} nodes; expected {}", columns * rows)]
    Count {
        /// Heights given.
        got: usize,
        /// Nodes along x.
        columns: usize,
        /// Nodes along y.
        rows: usize,
    },
    /// The spacing is no length.
    #[error("the grid's spacing is {cell} m; expected a positive number")]
    Cell {
        /// The spacing, m.
        cell: f64,
    },
    /// The corner is not finite.
    #[error("the map's south-western corner is at ({x}, {y}); expected finite coordinates")]
    Origin {
        /// Easting, m.
        x: f64,
        /// Northing, m.
        y: f64,
    },
    /// A height is infinite.
    #[error(
        "the height of column {column}, row {row} is infinite; expected a number, or NaN where nothing was measured"
    )]
    Infinite {
        /// Column, from 0 at the west.
        column: usize,
        /// Row, from 0 at the south.
        row: usize,
    },
    /// No node has a height.
    #[error("no node of the map has a height: all are holes")]
    Empty,
}

impl ElevationMap {
    /// A map of `heights` (m), row by row from the south, each row from the west; NaN is a hole.
    ///
    /// # Errors
    /// [`MapError`] where the numbers make no map.
    pub fn new(columns: usize, rows: usize, cell: f64, origin: [f64; 2], heights: Vec<f64>) -> Result<Self, MapError> {
        let nodes = columns.checked_mul(rows).filter(|nodes| columns >= 2 && rows >= 2 && *nodes <= MAX_NODES);
        let Some(nodes) = nodes else { return Err(MapError::Size { columns, rows }) };
        if heights.len() != nodes {
            return Err(MapError::Count { got: heights.len(), columns, rows });
        }
        if !(cell > 0.0 && cell.is_finite()) {
            return Err(MapError::Cell { cell });
        }
        if !origin.iter().all(|x| x.is_finite()) {
            return Err(MapError::Origin { x: origin[0], y: origin[1] });
        }
        if let Some(at) = heights.iter().position(|z| z.is_infinite()) {
            return Err(MapError::Infinite { column: at % columns, row: at / columns });
        }
        if heights.iter().all(|z| z.is_nan()) {
            return Err(MapError::Empty);
        }
        Ok(Self { columns, rows, cell, origin, heights })
    }

    /// A map of the formula z = `height(x, y)`.
    ///
    /// # Errors
    /// [`MapError`] where the numbers make no map.
    pub fn from_formula(
        columns: usize,
        rows: usize,
        cell: f64,
        origin: [f64; 2],
        height: impl Fn(f64, f64) -> f64,
    ) -> Result<Self, MapError> {
        let nodes = (0..rows).flat_map(|row| (0..columns).map(move |column| (column, row)));
        let at = |(column, row)| height(origin[0] + column as f64 * cell, origin[1] + row as f64 * cell);
        Self::new(columns, rows, cell, origin, nodes.map(at).collect())
    }

    /// Nodes along x.
    #[must_use]
    pub fn columns(&self) -> usize {
        self.columns
    }

    /// Nodes along y.
    #[must_use]
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// Spacing of the nodes, m.
    #[must_use]
    pub fn cell(&self) -> f64 {
        self.cell
    }

    /// Place of node (0, 0), the south-western one, m.
    #[must_use]
    pub fn origin(&self) -> [f64; 2] {
        self.origin
    }

    /// Heights, row by row from the south, m.
    #[must_use]
    pub fn heights(&self) -> &[f64] {
        &self.heights
    }

    /// Height of a node, m; NaN in a hole and beyond the map.
    #[must_use]
    pub fn height(&self, column: usize, row: usize) -> f64 {
        if column < self.columns && row < self.rows { self.heights[row * self.columns + column] } else { f64::NAN }
    }

    /// Place of a node, m.
    #[must_use]
    pub fn place(&self, column: usize, row: usize) -> [f64; 2] {
        [self.origin[0] + column as f64 * self.cell, self.origin[1] + row as f64 * self.cell]
    }

    /// The node nearest to a place; `None` beyond the outermost nodes.
    #[must_use]
    pub fn nearest(&self, place: [f64; 2]) -> Option<(usize, usize)> {
        let [u, v] = self.in_cells(place);
        let inside = u >= 0.0 && v >= 0.0 && u <= (self.columns - 1) as f64 && v <= (self.rows - 1) as f64;
        inside.then(|| (u.round() as usize, v.round() as usize))
    }

    /// West, south, east and north edge, m.
    #[must_use]
    pub fn bounds(&self) -> [f64; 4] {
        let [x, y] = self.place(self.columns - 1, self.rows - 1);
        [self.origin[0], self.origin[1], x, y]
    }

    /// The same grid with other heights.
    ///
    /// # Errors
    /// [`MapError`] where the number of heights differs or one is infinite.
    pub fn with_heights(&self, heights: Vec<f64>) -> Result<Self, MapError> {
        Self::new(self.columns, self.rows, self.cell, self.origin, heights)
    }

    /// Every `stride`-th node along both axes.
    ///
    /// # Errors
    /// [`MapError`] where fewer than 2 x 2 nodes are left.
    pub fn thinned(&self, stride: usize) -> Result<Self, MapError> {
        let stride = stride.max(1);
        let (columns, rows) = (self.columns.div_ceil(stride), self.rows.div_ceil(stride));
        let nodes = (0..rows).flat_map(|row| (0..columns).map(move |column| (column, row)));
        let heights = nodes.map(|(column, row)| self.height(column * stride, row * stride)).collect();
        Self::new(columns, rows, self.cell * stride as f64, self.origin, heights)
    }

    /// A place in units of the spacing from node (0, 0).
    pub(crate) fn in_cells(&self, place: [f64; 2]) -> [f64; 2] {
        [(place[0] - self.origin[0]) / self.cell, (place[1] - self.origin[1]) / self.cell]
    }
}
