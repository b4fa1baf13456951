//! Maps from files: ESRI ASCII grid, NumPy array, PGM with YAML (ROS), GeoTIFF, plain CSV.

mod ascii_grid;
mod csv_grid;
mod geotiff;
mod npy;
mod pgm;

pub use csv_grid::CsvGrid;

use super::{ElevationMap, MapError};
use std::path::{Path, PathBuf};

/// Why a file gives no map.
#[derive(Debug, thiserror::Error)]
pub enum MapReadError {
    /// The file cannot be read.
    #[error("`{file}`: {source}", file = file.display())]
    File {
        /// The file.
        file: PathBuf,
        /// What the system says.
        source: std::io::Error,
    },
    /// The file is of no known kind.
    #[error("`{file}`: expected a map as .asc, .npy, .yaml (with a PGM), .tif or .csv", file = file.display())]
    Kind {
        /// The file.
        file: PathBuf,
    },
    /// What the file says is no map.
    #[error("`{file}`{place}: {problem}", file = file.display(), place = line.map_or(String::new(), |line| format!(", line {line}")))]
    Content {
        /// The file.
        file: PathBuf,
        /// The line, from 1, where the file has lines.
        line: Option<usize>,
        /// What was found, and what was expected.
        problem: String,
    },
    /// The numbers make no map.
    #[error("`{file}`: {source}", file = file.display())]
    Map {
        /// The file.
        file: PathBuf,
        /// Why not.
        source: MapError,
    },
}

/// What is wrong in a text, before the file is named.
struct Problem {
    line: Option<usize>,
    text: String,
}

impl Problem {
    fn new(text: impl Into<String>) -> Self {
        Self { line: None, text: text.into() }
    }

    fn at(line: usize, text: impl Into<String>) -> Self {
        Self { line: Some(line), text: text.into() }
    }

    fn of_file(self, file: &Path) -> MapReadError {
        MapReadError::Content { file: file.to_owned(), line: self.line, problem: self.text }
    }
}

/// The numbers of a map as a file states them.
struct Raw {
    columns: usize,
    rows: usize,
    cell: f64,
    origin: [f64; 2],
    /// From the south.
    heights: Vec<f64>,
}

impl ElevationMap {
    /// The map of a file, by its ending: `.asc` (ESRI ASCII grid), `.npy`, `.yaml` (a PGM with heights), `.tif`, `.tiff`, or
    /// `.csv`. Heights are metres; nodes without data become holes. `grid` says what `.npy` and `.csv` do not: spacing and
    /// place.
    ///
    /// # Errors
    /// [`MapReadError`] names file, line where there is one, and what was expected.
    pub fn read(file: &Path, grid: &CsvGrid) -> Result<Self, MapReadError> {
        let ending = file.extension().map(|ending| ending.to_string_lossy().to_lowercase()).unwrap_or_default();
        let raw = match ending.as_str() {
            "asc" => ascii_grid::parse(&text(file)?),
            "csv" => csv_grid::parse(&text(file)?, grid),
            "npy" => npy::parse(&bytes(file)?, grid),
            "tif" | "tiff" => geotiff::parse(bytes(file)?),
            "yaml" | "yml" => {
                let settings = pgm::Settings::parse(&text(file)?).map_err(|problem| problem.of_file(file))?;
                let image = file.parent().unwrap_or(Path::new(".")).join(&settings.image);
                let picture = bytes(&image)?;
                let read = settings.heights(&picture).map_err(|problem| problem.of_file(&image))?;
                Ok(read)
            }
            _ => return Err(MapReadError::Kind { file: file.to_owned() }),
        };
        let raw = raw.map_err(|problem| problem.of_file(file))?;
        let map = Self::new(raw.columns, raw.rows, raw.cell, raw.origin, raw.heights);
        map.map_err(|source| MapReadError::Map { file: file.to_owned(), source })
    }
}

fn bytes(file: &Path) -> Result<Vec<u8>, MapReadError> {
    std::fs::read(file).map_err(|source| MapReadError::File { file: file.to_owned(), source })
}

fn text(file: &Path) -> Result<String, MapReadError> {
    std::fs::read_to_string(file).map_err(|source| MapReadError::File { file: file.to_owned(), source })
}

/// Rows given from the north, as rows from the south.
fn from_north(heights: Vec<f64>, columns: usize) -> Vec<f64> {
    heights.chunks(columns.max(1)).rev().flatten().copied().collect()
}
