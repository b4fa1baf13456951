//! Pictures of a rover on its ground: a cross-section from the side, drawn without a display.
//!
//! The soil is drawn as the model has it: pressed down under the wheels' arcs, and left as deep behind them as they sank.

mod canvas;
mod flag;
mod ground;
mod letters;
mod panel;
mod scene;
mod text;
mod vehicle;

use crate::error::InputError;
use crate::model::PyModel;
use bekker::modeldescription::Parameters;
use bekker::signals::Signals;
use canvas::Canvas;
use ground::Ruts;
use numpy::{AllowTypeChange, PyArray1, PyArray3, PyArrayLike1, PyArrayMethods};
use pyo3::prelude::*;
use scene::Scene;

/// What a task asks for, where a frame is to show it.
#[derive(Clone, Copy, Default)]
struct Asked {
    /// Position of the goal along x, m.
    goal: Option<f64>,
    /// Speed to drive at, m/s.
    target: Option<f64>,
    /// Reward of the step.
    reward: Option<f64>,
}

/// Draws the frames of one run after the other; it remembers the ruts and how far the wheels have turned.
#[pyclass(module = "bekker")]
pub struct Renderer {
    rover: bekker::rover::Rover,
    size: (u32, u32),
    ruts: Ruts,
    /// Angles of the wheels, rad, and the instant to which they belong, s.
    turned: Vec<f64>,
    last: Option<(f64, Vec<f64>)>,
}

#[pymethods]
impl Renderer {
    /// Frames of `model` of so many pixels.
    #[new]
    #[pyo3(signature = (model, width = 960, height = 540))]
    fn new(model: &PyModel, width: u32, height: u32) -> PyResult<Self> {
        for (name, pixels) in [("width", width), ("height", height)] {
            if !(64..=8192).contains(&pixels) {
                return Err(InputError::new_err(format!("{name} = {pixels}: expected 64 to 8192 pixels")));
            }
        }
        let rover = model.core.rover.clone();
        let turned = vec![0.0; rover.wheels.len()];
        Ok(Self { rover, size: (width, height), ruts: Ruts::default(), turned, last: None })
    }

    /// A frame from the true signals in the vocabulary's order: height x width x 3 bytes. Frames are to be asked for in the
    /// order of their times; an earlier time starts a new run. `goal` (x, m), `target` (m/s) and `reward` are shown where given.
    #[pyo3(signature = (time, signals, status, *, goal = None, target = None, reward = None))]
    #[allow(clippy::too_many_arguments, reason = "names in Python")]
    fn frame<'py>(
        &mut self,
        py: Python<'py>,
        time: f64,
        signals: PyArrayLike1<'py, f64, AllowTypeChange>,
        status: &str,
        goal: Option<f64>,
        target: Option<f64>,
        reward: Option<f64>,
    ) -> PyResult<Bound<'py, PyArray3<u8>>> {
        let signals = self.read(signals.as_array().as_slice().unwrap_or_default())?;
        let (width, height) = self.size;
        let asked = Asked { goal, target, reward };
        let bytes = py.detach(|| crate::error::fenced(|| self.draw(time, &signals, status, asked)))??;
        PyArray1::from_vec(py, bytes).reshape([height as usize, width as usize, 3])
    }

    /// One line of numbers and a profile in characters.
    fn text(&self, time: f64, signals: PyArrayLike1<'_, f64, AllowTypeChange>, status: &str) -> PyResult<String> {
        let signals = self.read(signals.as_array().as_slice().unwrap_or_default())?;
        Ok(text::text(&Scene::new(&self.rover, &signals), &self.rover, time, &signals, status))
    }
}

impl Renderer {
    /// Signals from their row.
    fn read(&self, row: &[f64]) -> PyResult<Signals> {
        let mut signals = Signals::of(self.rover.wheels.len(), self.rover.links.len());
        let (mut count, mut finite) = (0, true);
        signals.visit("", &mut |_, place| {
            if let Some(value) = row.get(count) {
                *place = *value;
                finite &= value.is_finite();
            }
            count += 1;
        });
        if row.len() != count || !finite {
            let found = if row.len() == count { "some that are not finite".to_owned() } else { row.len().to_string() };
            return Err(InputError::new_err(format!(
                "signals: expected a contiguous row of {count} numbers, found {found}"
            )));
        }
        Ok(signals)
    }

    fn draw(&mut self, time: f64, signals: &Signals, status: &str, asked: Asked) -> PyResult<Vec<u8>> {
        let scene = Scene::new(&self.rover, signals);
        self.remember(time, signals, &scene);
        let view = scene::View::new(&self.rover, &scene, self.size);
        let mut canvas =
            Canvas::new(self.size).ok_or_else(|| InputError::new_err("the frame is too large to be drawn"))?;
        let colours = ground::Colours::of(self.rover.environment.gravity);
        ground::draw(&mut canvas, &view, &self.rover, &scene, &self.ruts, &colours);
        if let Some(x) = asked.goal {
            flag::draw(&mut canvas, &view, &self.rover, x);
        }
        vehicle::draw(&mut canvas, &view, &self.rover, &scene, &self.turned);
        vehicle::forces(&mut canvas, &view, &self.rover, &scene, signals);
        panel::draw(&mut canvas, time, signals, status, asked, &colours);
        Ok(canvas.rgb())
    }

    /// Turns the wheels on and presses the ruts, from the frame before.
    fn remember(&mut self, time: f64, signals: &Signals, scene: &Scene) {
        let speeds: Vec<f64> = signals.wheels.iter().map(|wheel| wheel.speed).collect();
        match &self.last {
            Some((before, old)) if time >= *before => {
                for ((angle, now), old) in self.turned.iter_mut().zip(&speeds).zip(old) {
                    *angle += 0.5 * (now + old) * (time - before);
                }
            }
            _ => {
                self.turned.iter_mut().for_each(|angle| *angle = 0.0);
                self.ruts = Ruts::default();
            }
        }
        self.ruts.press(scene, signals);
        self.last = Some((time, speeds));
    }
}
