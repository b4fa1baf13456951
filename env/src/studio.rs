//! The workbench's server in a thread of its own, without Python.

use crate::compare::{Asked, SoilAsked, TogetherAsked, failed, given, together as add_together};
use crate::error::{self, InputError, SimulationError};
use crate::experiment::Source;
use bekker::model::Model;
use bekker_studio::{Opened, Options, Studio, StudioError};
use pyo3::prelude::*;
use std::collections::BTreeMap;
use std::net::{IpAddr, Ipv4Addr, SocketAddr};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::JoinHandle;

/// A server that answers a browser on this machine until it is stopped.
#[pyclass(module = "bekker._bekker", frozen)]
pub struct NativeStudio {
    #[pyo3(get)]
    url: String,
    stop: Arc<AtomicBool>,
    thread: Mutex<Option<JoinHandle<Result<(), StudioError>>>>,
}

/// Starts a server with these experiments; `together` is said of those that are several. `port` 0 takes a free one; `in_notebook` lets
/// pages of notebooks on this machine show it.
#[pyfunction]
#[allow(clippy::too_many_arguments, reason = "arguments of the Python function")]
pub fn open_studio(
    py: Python<'_>,
    experiments: Vec<Source<'_>>,
    model: Asked,
    values: BTreeMap<String, f64>,
    soil: SoilAsked,
    together: TogetherAsked,
    port: u16,
    in_notebook: bool,
) -> PyResult<NativeStudio> {
    let given = given(py, &model, &values, &soil, &(None, None))?;
    let mut opened = Vec::new();
    for experiment in experiments {
        let (experiment, _) = experiment.read(py)?;
        let given = if experiment.parts.is_empty() { given.clone() } else { add_together(given.clone(), &together)? };
        opened.push(Opened { experiment, given, example: false });
    }
    let address = SocketAddr::new(IpAddr::V4(Ipv4Addr::LOCALHOST), port);
    let options = Options { address, experiments: opened, fmu: Some(pack), in_notebook, ..Options::default() };
    let studio = py.detach(|| error::fenced(|| Studio::start(options)))?.map_err(|refused| refusal(&refused))?;
    let (url, stop) = (studio.url(), Arc::new(AtomicBool::new(false)));
    let asked = Arc::clone(&stop);
    let thread = std::thread::spawn(move || studio.run(move || asked.load(Ordering::Relaxed)));
    Ok(NativeStudio { url, stop, thread: Mutex::new(Some(thread)) })
}

fn refusal(refused: &StudioError) -> PyErr {
    match refused {
        StudioError::Experiment { source, .. } => failed(source),
        StudioError::Bind { .. } => InputError::new_err(format!("port: {refused}; 0 takes a free one")),
        _ => SimulationError::new_err(refused.to_string()),
    }
}

fn pack(model: &Model) -> Result<Vec<u8>, String> {
    bekker_fmu_package::pack(model, &bekker_fmu_package::Options::default()).map_err(|error| error.to_string())
}

#[pymethods]
impl NativeStudio {
    /// Whether it still answers.
    fn running(&self) -> bool {
        let thread = self.thread.lock().unwrap_or_else(PoisonError::into_inner);
        thread.as_ref().is_some_and(|thread| !thread.is_finished())
    }

    /// Ends it, and waits until it has; once more does nothing.
    fn stop(&self, py: Python<'_>) -> PyResult<()> {
        self.stop.store(true, Ordering::Relaxed);
        let thread = self.thread.lock().unwrap_or_else(PoisonError::into_inner).take();
        let ended = py.detach(|| thread.map(JoinHandle::join));
        match ended {
            None | Some(Ok(Ok(()))) => Ok(()),
            Some(Ok(Err(refused))) => Err(refusal(&refused)),
            Some(Err(_)) => Err(SimulationError::new_err("the workbench failed: this is a fault of the program")),
        }
    }
}

impl Drop for NativeStudio {
    fn drop(&mut self) {
        // The thread sees it within a moment; nobody waits for it here.
        self.stop.store(true, Ordering::Relaxed);
    }
}
