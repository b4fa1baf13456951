//! Class `Ahead`: the ground ahead as an elevation map has it.

use crate::error::InputError;
use bekker::sensors::Ahead;
use pyo3::prelude::*;

/// A map of the ground ahead of the rover, as a camera or a laser makes it: what the environment shows of it are
/// `height_ahead`, `seen_ahead` and `soil_ahead`, an entry for each distance.
///
/// `distances` are those of its cells along x from the body's reference point, m (negative: behind it). A height is that of the ground,
/// or of an obstacle on it, above the ground at the reference point, m, with `noise` as standard deviation, drawn anew at each reading.
/// A cell is missing with the probability `dropout` and then reads 0 everywhere; `seen_ahead` is 1 where it is there. `soil_ahead` is
/// 1 where the soil differs from the rover's own, such as the loose sand of a ditch.
#[pyclass(module = "bekker", name = "Ahead", frozen, eq)]
#[derive(Debug, PartialEq)]
pub struct PyAhead {
    core: Ahead,
}

impl PyAhead {
    /// The core's map.
    pub fn core(&self) -> &Ahead {
        &self.core
    }
}

#[pymethods]
impl PyAhead {
    #[new]
    #[pyo3(signature = (distances, noise = 0.0, dropout = 0.0))]
    fn new(distances: Vec<f64>, noise: f64, dropout: f64) -> PyResult<Self> {
        let core = Ahead::new(distances, noise, dropout).map_err(|refused| InputError::new_err(refused.to_string()))?;
        Ok(Self { core })
    }

    /// Where the cells are along x from the body's reference point, m.
    #[getter]
    fn distances(&self) -> Vec<f64> {
        self.core.distances().to_vec()
    }

    /// Standard deviation of a height, m.
    #[getter]
    fn noise(&self) -> f64 {
        self.core.noise()
    }

    /// Probability with which a cell is missing.
    #[getter]
    fn dropout(&self) -> f64 {
        self.core.dropout()
    }

    fn __getnewargs__(&self) -> (Vec<f64>, f64, f64) {
        (self.distances(), self.noise(), self.dropout())
    }

    fn __repr__(&self) -> String {
        format!("Ahead({:?}, noise={}, dropout={})", self.core.distances(), self.core.noise(), self.core.dropout())
    }
}
