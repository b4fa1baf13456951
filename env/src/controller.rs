//! Class `Controller`: the core's controllers on measurements from outside.

use crate::error::{self, InputError, ModelError};
use crate::model::PyModel;
use bekker::control::{Controller as _, SlipController};
use bekker::model::{ControlKind, ControllerRun, RunError, nominal};
use bekker::modeldescription::Parameters;
use bekker::signals::{Command, Measurement, Reference};
use numpy::{AllowTypeChange, PyArray1, PyArrayLike1, PyArrayLike2};
use pyo3::prelude::*;

/// A controller at work, with the data sheet of a model: it sees what it is given, and nothing of any run.
#[pyclass(module = "bekker", name = "Controller")]
pub struct PyController {
    work: Work,
    wheels: usize,
    links: usize,
}

enum Work {
    /// Lives on measurements alone.
    Measured(Box<ControllerRun>),
    /// Is told slips too.
    Slip { controller: Box<SlipController>, command: Command },
}

#[pymethods]
impl PyController {
    /// A controller of `kind` ("velocity", "velocity_tuned", "rtc", "rtc_speed", "equal_torque" or "slip") for the vehicle of `model`,
    /// at rest, that decides every `period` seconds.
    #[new]
    fn new(model: &PyModel, kind: &str, period: f64) -> PyResult<Self> {
        let mut model = model.core.clone();
        let refused = |wrong| ModelError::new_err(format!("kind of controller: {wrong}"));
        model.control.kind = serde_json::from_value(serde_json::Value::from(kind)).map_err(refused)?;
        model.control.velocity.period = period;
        model.control.velocity_tuned.period = period;
        model.control.rtc_timing.period = period;
        model.control.equal_torque.period = period;
        let (wheels, links) = (model.rover.wheels.len(), model.rover.links.len());
        let work = if model.control.kind == ControlKind::Slip {
            let made = SlipController::new(nominal(&model.rover), model.control.slip, model.control.velocity);
            let controller = Box::new(made.map_err(|source| error::run(&RunError::Control { time: 0.0, source }))?);
            Work::Slip { controller, command: Command::torque(vec![0.0; wheels]) }
        } else {
            Work::Measured(Box::new(model.start_controller().map_err(|refused| error::run(&refused))?))
        };
        Ok(Self { work, wheels, links })
    }

    /// Torques of the wheels, N m, until the next decision.
    ///
    /// `body` is pitch (rad), pitch rate (rad/s) and velocity (m/s); `wheels` has a row a wheel, rear to front: speed
    /// (rad/s), torque (N m), contact angle (rad); `links` a row a link: angle (rad), rate (rad/s); `slip` a number a
    /// wheel, for slip control.
    fn decide<'py>(
        &mut self,
        py: Python<'py>,
        goal: f64,
        body: [f64; 3],
        wheels: PyArrayLike2<'py, f64, AllowTypeChange>,
        links: PyArrayLike2<'py, f64, AllowTypeChange>,
        slip: PyArrayLike1<'py, f64, AllowTypeChange>,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let (wheels, links, slip) = (wheels.as_array(), links.as_array(), slip.as_array());
        expect("wheels", wheels.shape(), [self.wheels, 3])?;
        expect("links", links.shape(), [self.links, 2])?;
        let mut measured = Measurement::of(self.wheels, self.links);
        let mut readings = body.iter().chain(wheels.iter()).chain(links.iter());
        measured.places(&mut |place| readings.next().into_iter().for_each(|reading| *place = *reading));
        let work = &mut self.work;
        let torques = error::fenced(|| match work {
            Work::Measured(run) => {
                *run.measurement_mut() = measured;
                run.goal_mut().velocity_command = goal;
                run.decide().map(|command| command.values.clone())
            }
            Work::Slip { controller, command } => {
                controller.reveal(slip.iter().copied());
                let decided = controller.command(&measured, &Reference { velocity: goal }, command);
                decided.map(|()| command.values.clone()).map_err(|source| RunError::Control { time: 0.0, source })
            }
        })?;
        Ok(PyArray1::from_vec(py, torques.map_err(|refused| error::run(&refused))?))
    }
}

fn expect(name: &str, found: &[usize], expected: [usize; 2]) -> PyResult<()> {
    if found == expected {
        return Ok(());
    }
    Err(InputError::new_err(format!("{name}: expected an array of shape {expected:?}, found {found:?}")))
}
