//! Runs of scenes in this process, and the texts of scenes.

use crate::arrays::matrix;
use crate::error;
use crate::packing::PyPacking;
use grainlab::{Mat3, Simulation, State};
use grainlab_recordings::scenes;
use numpy::PyArray2;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::Duration;

/// A run of a scene.
#[pyclass(module = "grainlab._grainlab", frozen)]
pub(crate) struct Run(Mutex<Simulation>);

impl Run {
    fn run(&self) -> MutexGuard<'_, Simulation> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

fn packing(run: &Simulation, state: State) -> PyPacking {
    PyPacking::new(state.packing, format!("simulation of {}", run.name()), state.notes, state.run_state)
}

/// Starts a run of a scene with settings such as `grains.count=500`; it and the notes on its start.
#[pyfunction]
pub(crate) fn begin(
    py: Python<'_>,
    scene: &str,
    settings: Vec<String>,
    threads: usize,
) -> PyResult<(Run, Vec<String>)> {
    let settings: Vec<&str> = settings.iter().map(String::as_str).collect();
    let run = py.detach(|| grainlab::simulate(scene, &settings)?.with_threads(threads)).map_err(error::of)?;
    let notes = run.notes().to_vec();
    Ok((Run(Mutex::new(run)), notes))
}

/// The complete text of a scene with settings, its name, and notes on it.
#[pyfunction]
pub(crate) fn scene(
    py: Python<'_>,
    scene: &str,
    settings: Vec<String>,
) -> PyResult<(String, String, Vec<String>)> {
    let found =
        py.detach(|| scenes::read(scene, &settings, None)).map_err(|e| error::scene(e.to_string()))?;
    let notes = found.notes.into_iter().chain(found.scene.notes()).collect();
    Ok((found.text, found.scene.name, notes))
}

/// The built-in scenes: by name, the description.
#[pyfunction]
pub(crate) fn scenes_built_in(py: Python<'_>) -> PyResult<Bound<'_, PyDict>> {
    let dict = PyDict::new(py);
    for (name, _) in grainlab_scene::BUILT_IN {
        let found = scenes::read(name, &[], None).map_err(|e| error::scene(e.to_string()))?;
        dict.set_item(name, found.scene.description)?;
    }
    Ok(dict)
}

#[pymethods]
impl Run {
    /// Goes on until a packing is due, a phase or the path has ended, or this time has passed, s, for one exchange at least.
    fn advance(&self, py: Python<'_>, limit: f64) -> PyResult<Option<PyPacking>> {
        let step = || {
            let mut run = self.run();
            let found = run.advance(Duration::from_secs_f64(limit))?;
            Ok(found.map(|state| packing(&run, state)))
        };
        py.detach(step).map_err(error::of)
    }

    /// The present packing.
    fn packing(&self, py: Python<'_>) -> PyResult<PyPacking> {
        let present = || {
            let run = self.run();
            Ok(packing(&run, run.state()?))
        };
        py.detach(present).map_err(error::of)
    }

    /// Name of the scene, and of the phase.
    fn names(&self) -> (String, Option<String>) {
        let run = self.run();
        (run.name().to_owned(), run.phase().map(str::to_owned))
    }

    /// Steps, time (s), share of the phase that is done, and whether the path is done.
    fn clock(&self) -> (u64, f64, Option<f64>, bool) {
        let run = self.run();
        (run.steps(), run.time(), run.progress(), run.finished())
    }

    /// Stress, Pa, shape `(3, 3)`.
    fn stress<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let stress: Mat3 = self.run().stress().map_err(error::of)?;
        Ok(matrix(py, 3, |i, j| stress[(i, j)]))
    }
}
