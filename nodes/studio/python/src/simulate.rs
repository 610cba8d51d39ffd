//! Runs of scenes in this process.

use crate::error;
use crate::files::warn;
use crate::packing::PyPacking;
use grainlab_core::Packing;
use grainlab_dem::Compute;
use grainlab_experiment::Simulation;
use grainlab_recordings::{import, input};
use grainlab_scene::{BUILT_IN, Draft, Source, built_in};
use pyo3::prelude::*;
use pyo3::types::{PyBool, PyDict};
use std::path::Path;
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

/// Time between two looks for a signal such as Ctrl-C.
const SIGNAL_PERIOD: Duration = Duration::from_millis(50);

/// A run of a scene: an iterator over its packings.
#[pyclass(name = "Simulation", module = "grainlab", frozen)]
pub(crate) struct PySimulation(Mutex<State>);

struct State {
    run: Simulation,
    name: String,
    /// The packing that the scene starts from, which is returned first.
    start: Option<Packing>,
    failed: bool,
}

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
    let mut draft =
        Draft::of(&source(scene, None).map_err(error::scene)?, &|base, from| source(base, Some(from)))
            .map_err(error::scene)?;
    let seed = seed.map(|s| Ok(format!("seed={s}")));
    let set = set.iter().flat_map(|set| set.iter()).map(|(key, value)| assignment(&key, &value));
    for text in set.chain(seed) {
        draft.set(grainlab_scene::assignment(&text?).map_err(error::scene)?).map_err(error::scene)?;
    }
    let start = draft.start().map(|file| import::start(&draft, &file)).transpose().map_err(error::file)?;
    let resolved = match &start {
        Some(found) => {
            let forces = found.contact_forces.as_ref().map(|path| path.to_string_lossy());
            draft.start_at(&found.path.to_string_lossy(), forces.as_deref(), found.step);
            draft.resolve_from(&found.packing)
        }
        None => draft.resolve(),
    };
    let scene = resolved.map_err(error::scene)?.scene;
    let compute = Compute::new(grainlab_dem::Simd::best(), threads).map_err(error::scene)?;
    let name = scene.name.clone();
    start.iter().flat_map(|found| &found.notes).try_for_each(|note| warn(py, note))?;
    let start = start.map(|found| found.packing);
    let begin = || match &start {
        Some(packing) => Simulation::from_packing(scene, packing),
        None => Simulation::new(scene),
    };
    let mut run = py.detach(begin).map_err(error::physics)?;
    run.set_compute(compute);
    // As the run holds it: at its first step, without the strain of the file.
    let start = start.is_some().then(|| run.packing());
    Ok(PySimulation(Mutex::new(State { run, name, start, failed: false })))
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

/// A built-in scene, a file, or a text of several lines; one named in the file `from` is searched for beside it.
fn source(name: &str, from: Option<&str>) -> Result<Source, String> {
    if name.contains('\n') {
        return Ok(Source { name: "scene".to_owned(), text: name.to_owned() });
    }
    if let Some(text) = built_in(name) {
        return Ok(Source { name: name.to_owned(), text: text.to_owned() });
    }
    let path = from.map(Path::new).and_then(Path::parent).unwrap_or(Path::new("")).join(name);
    if !path.exists() {
        let known = BUILT_IN.map(|(name, _)| name).join(", ");
        return Err(format!("no scene {name:?}: neither a file nor built in; built in are: {known}"));
    }
    let text = input::text(&path, input::SETTINGS).map_err(|e| e.to_string())?;
    let name = path.canonicalize().unwrap_or(path);
    Ok(Source { name: name.to_string_lossy().into_owned(), text })
}

impl State {
    /// Goes on until a packing is due, `limit` has passed, or the path is done.
    fn advance(&mut self, limit: Duration) -> Result<Option<(Packing, Vec<u8>)>, String> {
        if let Some(packing) = self.start.take() {
            return Ok(Some((packing, self.run.run_state())));
        }
        let began = Instant::now();
        while began.elapsed() < limit
            && let Some(request) = self.run.request()
        {
            let output = grainlab_servo::control(&request.servo_input()).map_err(|e| e.to_string())?;
            let outcome = self.run.advance(&output.rate).map_err(|e| e.to_string())?;
            if outcome.packing_due {
                return Ok(Some((self.run.packing(), self.run.run_state())));
            }
        }
        Ok(None)
    }
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
                let mut state = self.0.lock().unwrap_or_else(PoisonError::into_inner);
                if state.failed {
                    return (Ok(None), true, String::new());
                }
                let found = state.advance(SIGNAL_PERIOD);
                state.failed = found.is_err();
                let done = state.run.finished();
                (found, done, format!("simulation of {}, step {}", state.name, state.run.engine().steps()))
            };
            let (found, done, source) = py.detach(step);
            match found.map_err(error::physics)? {
                Some((packing, run_state)) => {
                    return Ok(Some(PyPacking::new(packing, source, Vec::new()).at(&run_state)));
                }
                None if done => return Ok(None),
                None => py.check_signals()?,
            }
        }
    }

    fn __repr__(&self) -> String {
        let state = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        format!("<grainlab.Simulation of {}, step {}>", state.name, state.run.engine().steps())
    }
}
