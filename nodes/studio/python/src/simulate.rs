//! Runs of scenes in this process.

use crate::error;
use crate::files::warn;
use crate::packing::PyPacking;
use grainlab::Simulation;
use pyo3::prelude::*;
use pyo3::types::{PyBool, PyDict};
use std::sync::{Mutex, PoisonError};
use std::time::Duration;

/// Time between two looks for a signal such as Ctrl-C.
const SIGNAL_PERIOD: Duration = Duration::from_millis(50);

/// A run of a scene: an iterator over its packings.
#[pyclass(name = "Simulation", module = "grainlab", frozen)]
pub(crate) struct PySimulation(Mutex<Simulation>);

/// Starts a run of a scene: a built-in name, a file, or a text.
#[pyfunction]
#[pyo3(signature = (scene, *, seed=None, set=None, threads=1))]
pub(crate) fn simulate(
    py: Python<'_>,
    scene: &str,
    seed: Option<u64>,
    set: Option<&Bound<'_, PyDict>>,
    threads: usize,
) -> PyResult<PySimulation> {
    let seed = seed.map(|s| Ok(format!("seed={s}")));
    let set = set.iter().flat_map(|set| set.iter()).map(|(key, value)| assignment(&key, &value));
    let settings = set.chain(seed).collect::<PyResult<Vec<String>>>()?;
    let settings: Vec<&str> = settings.iter().map(String::as_str).collect();
    let begin = || grainlab::simulate(scene, &settings)?.with_threads(threads);
    let run = py.detach(begin).map_err(error::of)?;
    run.notes().iter().try_for_each(|note| warn(py, note))?;
    Ok(PySimulation(Mutex::new(run)))
}

/// `key=value` in TOML.
fn assignment(key: &Bound<'_, PyAny>, value: &Bound<'_, PyAny>) -> PyResult<String> {
    let key: String = key.extract()?;
    let value = match value.extract::<String>() {
        Ok(text) => toml::Value::String(text).to_string(),
        Err(_) if value.is_instance_of::<PyBool>() => value.extract::<bool>()?.to_string(),
        Err(_) => value.str()?.to_string(),
    };
    Ok(format!("{key}={value}"))
}

#[pymethods]
impl PySimulation {
    fn __iter__(slf: PyRef<'_, Self>) -> PyRef<'_, Self> {
        slf
    }

    /// The next packing that the scene publishes.
    fn __next__(&self, py: Python<'_>) -> PyResult<Option<PyPacking>> {
        loop {
            let step = || {
                let mut run = self.0.lock().unwrap_or_else(PoisonError::into_inner);
                let found = run.advance(SIGNAL_PERIOD);
                (found, run.finished(), format!("simulation of {}, step {}", run.name(), run.steps()))
            };
            let (found, done, source) = py.detach(step);
            match found.map_err(error::of)? {
                Some(state) => {
                    return Ok(Some(PyPacking::new(state.packing, source, state.notes).at(&state.run_state)));
                }
                None if done => return Ok(None),
                None => py.check_signals()?,
            }
        }
    }

    fn __repr__(&self) -> String {
        let run = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        format!("<grainlab.Simulation of {}, step {}>", run.name(), run.steps())
    }
}
