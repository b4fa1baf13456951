//! Class `Model`.

use crate::run::PyRun;
use crate::{error, vocabulary};
use bekker::carriage::{SetPoint, SteadyPoint};
use bekker::model::{ControlKind, Model, ModelError, ModelKind};
use bekker::modeldescription::{Lookup, Parameters, Variable, join};
use bekker::sensors::Sensors;
use bekker::signals::Signals;
use bekker::soil_test::SoilTestSignals;
use bekker::terrain::{Profile, Random, TerrainSpec};
use numpy::{PyArray1, PyReadonlyArray1};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyType};
use std::path::PathBuf;

/// A rover on its ground, its sensors and control, and how to run them; or a wheel on a carriage; or a test of the soil.
#[pyclass(module = "bekker", name = "Model")]
pub struct PyModel {
    pub core: Model,
}

/// Maker, arguments, state: what pickle takes.
type Reduced<'py> = (Bound<'py, PyAny>, (String,), State);

/// What a file has not: the numbers of all sensors, and which parameters the model states.
type State = (Vec<(String, f64)>, Vec<String>);

/// Drawbar pull (N), torque (N m) and sinkage (m), one value a point.
type Columns<'py> = [Bound<'py, PyArray1<f64>>; 3];

/// All sensors under their names in the vocabulary.
struct AllSensors<'a>(&'a mut Sensors);

impl Parameters<f64> for AllSensors<'_> {
    fn visit(&mut self, prefix: &str, f: &mut dyn FnMut(Variable, &mut f64)) {
        self.0.visit(&join(prefix, "sensor"), f);
    }

    fn values(&self, f: &mut dyn FnMut(f64)) {
        self.0.values(f);
    }
}

impl PyModel {
    fn read_by(py: Python<'_>, reader: impl FnOnce() -> Result<Model, ModelError> + Send) -> PyResult<Self> {
        match py.detach(|| error::fenced(reader))? {
            Ok(core) => Ok(Self { core }),
            Err(refused) => Err(error::model(&refused)),
        }
    }
}

#[pymethods]
impl PyModel {
    /// A built-in model; `bekker.presets()` lists the names.
    #[classmethod]
    fn from_preset(_class: &Bound<'_, PyType>, py: Python<'_>, name: &str) -> PyResult<Self> {
        Self::read_by(py, || Model::preset(name))
    }

    /// A model from TOML text; files that it names are looked for in `folder`.
    #[classmethod]
    #[pyo3(signature = (text, folder = None))]
    fn from_toml(_class: &Bound<'_, PyType>, py: Python<'_>, text: &str, folder: Option<PathBuf>) -> PyResult<Self> {
        Self::read_by(py, || Model::from_toml(text, folder.as_deref()))
    }

    /// A model from a TOML file.
    #[classmethod]
    fn read(_class: &Bound<'_, PyType>, py: Python<'_>, path: PathBuf) -> PyResult<Self> {
        Self::read_by(py, || Model::read(&path))
    }

    /// The model as TOML, complete in itself; reading it back gives the same model to the last bit.
    fn to_toml(&self) -> PyResult<String> {
        self.core.to_toml().map_err(|refused| error::model(&refused))
    }

    /// Every parameter of this model, in the vocabulary's order.
    fn parameters<'py>(&self, py: Python<'py>) -> PyResult<Vec<Bound<'py, PyDict>>> {
        vocabulary::list(py, &mut self.core.clone())
    }

    /// The inputs that a run takes, in order, with their starting values.
    fn inputs<'py>(&self, py: Python<'py>) -> PyResult<Vec<Bound<'py, PyDict>>> {
        vocabulary::list(py, &mut self.core.inputs())
    }

    /// The signals that a run computes, in order.
    fn signals<'py>(&self, py: Python<'py>) -> PyResult<Vec<Bound<'py, PyDict>>> {
        match self.core.kind {
            ModelKind::Carriage => return vocabulary::list(py, &mut SteadyPoint::default()),
            ModelKind::SoilTest => return vocabulary::list(py, &mut SoilTestSignals::default()),
            ModelKind::Rover => {}
        }
        let rover = &self.core.rover;
        vocabulary::list(py, &mut Signals::of(rover.wheels.len(), rover.links.len()))
    }

    /// Value of a parameter.
    fn get(&self, name: &str) -> PyResult<f64> {
        self.core.clone().get(name).map_err(|refused| error::parameter(&refused))
    }

    /// The sensors, whether or not the control of this model reads them.
    fn sensors<'py>(&self, py: Python<'py>) -> PyResult<Vec<Bound<'py, PyDict>>> {
        vocabulary::list(py, &mut AllSensors(&mut self.core.sensors.clone()))
    }

    /// Sets a number of a sensor, whether or not the control of this model reads it.
    fn set_sensor(&mut self, name: &str, value: f64) -> PyResult<()> {
        AllSensors(&mut self.core.sensors).set(name, value).map_err(|refused| error::parameter(&refused))
    }

    /// Changes the ground: `terrain` is the section `[terrain]` of a model file as JSON.
    #[pyo3(signature = (terrain, folder = None))]
    fn set_terrain(&mut self, terrain: &str, folder: Option<PathBuf>) -> PyResult<()> {
        let spec: TerrainSpec = serde_json::from_str(terrain)
            .map_err(|refused| error::ModelError::new_err(format!("terrain: {refused}")))?;
        let folder = folder.unwrap_or_else(|| PathBuf::from("."));
        self.core.rover.terrain = spec.terrain(&folder).map_err(|refused| error::model(&refused.into()))?;
        Ok(())
    }

    /// Takes another sample of random ground (the preset `random`) with the same numbers.
    fn reseed_terrain(&mut self, seed: u32) -> PyResult<()> {
        let Profile::Random(random) = &mut self.core.rover.terrain.profile else {
            return Err(error::ModelError::new_err("terrain.seed: expected the terrain preset `random`"));
        };
        *random = Random::new(random.spectrum, seed).with_rocks(*random.rocks());
        Ok(())
    }

    /// Changes what drives the wheels, see `control`.
    fn set_control(&mut self, kind: &str) -> PyResult<()> {
        let found = serde_json::from_value(serde_json::Value::from(kind));
        self.core.control.kind = found.map_err(|refused| error::ModelError::new_err(format!("control: {refused}")))?;
        Ok(())
    }

    /// Sets a parameter, which then counts as stated by this model; nothing is changed where the value is refused.
    fn set(&mut self, name: &str, value: f64) -> PyResult<()> {
        self.core.set(name, value).map_err(|refused| error::parameter(&refused))?;
        self.core.stated.insert(name);
        Ok(())
    }

    /// What a carriage measures of this model's wheel at each load (N), slip and wheel speed (rad/s), arrays of one length.
    fn steady_points<'py>(
        &self,
        py: Python<'py>,
        load: PyReadonlyArray1<'py, f64>,
        slip: PyReadonlyArray1<'py, f64>,
        wheel_speed: PyReadonlyArray1<'py, f64>,
    ) -> PyResult<Columns<'py>> {
        let rows = load.as_array().into_iter().zip(slip.as_array()).zip(wheel_speed.as_array());
        let mut sets = Vec::new();
        for (row, ((load, slip), wheel_speed)) in rows.enumerate() {
            let mut set = SetPoint { load: *load, slip: *slip, wheel_speed: *wheel_speed };
            set.check().map_err(|refused| error::InputError::new_err(format!("point {row}: {refused}")))?;
            sets.push(set);
        }
        let points = py.detach(|| error::fenced(|| self.core.steady_points(&sets)))?;
        let refused = |(row, refused)| error::SimulationError::new_err(format!("point {row}: {refused}"));
        let points = points.map_err(refused)?;
        let column = |of: fn(&SteadyPoint) -> f64| PyArray1::from_iter(py, points.iter().map(of));
        Ok([column(|point| point.drawbar_pull), column(|point| point.torque), column(|point| point.sinkage)])
    }

    /// Checks that a rover comes to rest and is not at its end within its first second; a wheel on a carriage passes.
    fn check_drive(&self, py: Python<'_>) -> PyResult<()> {
        let checked = py.detach(|| error::fenced(|| self.core.check_drive()))?;
        checked.map_err(|unfit| error::SimulationError::new_err(unfit.to_string()))
    }

    /// This rover with gravity, wheel, soil and effects of `tested`.
    fn with_rig_of(&self, tested: &Self) -> PyResult<Self> {
        let refused = |refused: bekker::effects::DefinitionError| error::model(&refused.into());
        Ok(Self { core: self.core.with_rig_of(&tested.core).map_err(refused)? })
    }

    /// Adds effects of the user's own, all neutral, from TOML text with `[[effect]]` tables.
    fn add_effects(&mut self, text: &str) -> PyResult<()> {
        self.core.add_effects(text).map_err(|refused| error::model(&refused.into()))
    }

    /// Ids and meanings of the effects of this model: the library's and the user's own.
    fn effects(&self) -> Vec<(String, String)> {
        self.core.rover.effects.list()
    }

    /// A run of this model at its start: settled on the ground, controllers at rest.
    fn start(&self, py: Python<'_>) -> PyResult<PyRun> {
        match py.detach(|| error::fenced(|| self.core.start()))? {
            Ok(run) => Ok(PyRun::new(run)),
            Err(refused) => Err(error::run(&refused)),
        }
    }

    /// Name for people.
    #[getter]
    fn name(&self) -> &str {
        &self.core.name
    }

    /// What the model is of: "rover", "carriage" for a wheel on a carriage, or "soil_test" for a test of the soil.
    #[getter]
    fn kind(&self) -> &'static str {
        match self.core.kind {
            ModelKind::Rover => "rover",
            ModelKind::Carriage => "carriage",
            ModelKind::SoilTest => "soil_test",
        }
    }

    /// What drives the wheels: "torque", "speed", "speed_loop", "velocity", "velocity_tuned", "rtc", "rtc_speed", "slip" or
    /// "equal_torque".
    #[getter]
    fn control(&self) -> &'static str {
        match self.core.control.kind {
            ControlKind::Torque => "torque",
            ControlKind::Speed => "speed",
            ControlKind::SpeedLoop => "speed_loop",
            ControlKind::Velocity => "velocity",
            ControlKind::VelocityTuned => "velocity_tuned",
            ControlKind::Rtc => "rtc",
            ControlKind::RtcSpeed => "rtc_speed",
            ControlKind::Slip => "slip",
            ControlKind::EqualTorque => "equal_torque",
            ControlKind::Registered => "registered",
        }
    }

    /// Number of wheels; 1 on a carriage, none in a test of the soil.
    #[getter]
    fn wheels(&self) -> usize {
        match self.core.kind {
            ModelKind::Rover => self.core.rover.wheels.len(),
            ModelKind::Carriage => 1,
            ModelKind::SoilTest => 0,
        }
    }

    /// Number of links, the bodies besides the chassis.
    #[getter]
    fn links(&self) -> usize {
        self.core.rover.links.len()
    }

    /// Mass of chassis and links, kg; none of what is no rover.
    #[getter]
    fn total_mass(&self) -> f64 {
        if self.core.kind == ModelKind::Rover { self.core.rover.total_mass() } else { 0.0 }
    }

    /// Inner step, s.
    #[getter]
    fn step_size(&self) -> f64 {
        self.core.stepping.step_size
    }

    /// Default length of a run, s.
    #[getter]
    fn duration(&self) -> f64 {
        self.core.stepping.duration
    }

    /// Seed of the sensors' noise, below 2^32.
    #[getter]
    fn seed(&self) -> u32 {
        self.core.stepping.seed
    }

    #[setter]
    fn set_seed(&mut self, seed: u32) {
        self.core.stepping.seed = seed;
    }

    /// An independent copy.
    fn copy(&self) -> Self {
        Self { core: self.core.clone() }
    }

    fn __copy__(&self) -> Self {
        self.copy()
    }

    fn __deepcopy__(&self, _memo: &Bound<'_, PyAny>) -> Self {
        self.copy()
    }

    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<Reduced<'py>> {
        let mut sensors = Vec::new();
        let model = slf.borrow();
        AllSensors(&mut model.core.sensors.clone())
            .visit("", &mut |variable, value| sensors.push((variable.name, *value)));
        let stated = model.core.stated.names().map(str::to_owned).collect();
        Ok((slf.get_type().getattr("from_toml")?, (model.to_toml()?,), (sensors, stated)))
    }

    /// What a file has not: it has the numbers of those sensors that the control reads, and states all its parameters.
    fn __setstate__(&mut self, state: State) -> PyResult<()> {
        let (sensors, stated) = state;
        self.core.stated = stated.into_iter().collect();
        sensors.iter().try_for_each(|(name, value)| self.set_sensor(name, *value))
    }

    fn __repr__(&self) -> String {
        match self.core.kind {
            ModelKind::Carriage => return format!("<bekker.Model {:?}: a wheel on a carriage>", self.core.name),
            ModelKind::SoilTest => return format!("<bekker.Model {:?}: a test of a soil>", self.core.name),
            ModelKind::Rover => {}
        }
        format!("<bekker.Model {:?}: {} wheels, control {:?}>", self.core.name, self.wheels(), self.control())
    }
}
