//! Class `Ahead`: the ground ahead as an elevation map has it.

use crate::error::InputError;
use bekker::model::Ahead;
use pyo3::prelude::*;

/// A map of the ground ahead of the rover, which an environment shows as `height_ahead`, `seen_ahead` and `soil_ahead`, an entry for
/// each of the `distances` along x from the body's reference point, m (negative: behind it).
///
/// `height_ahead` is the height of the ground, or of an obstacle on it, above the ground at the reference point, m, with `noise` (m) as
/// standard deviation, drawn in each step. `soil_ahead` is the shear strength of the soil over that of the model's own soil, both at the
/// mean ground pressure of the wheels. A cell is missing with the probability `dropout`: both then read 0, and so does `seen_ahead`,
/// which is 1 otherwise. The map is looked up at the recorded `x`, which the scale of the odometry and a lag change where these effects
/// are on; effects on the soil are not on the map.
///
/// Raises InputError where there is no distance, one is not finite, `noise` is negative or `dropout` is not within 0 to 1.
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
