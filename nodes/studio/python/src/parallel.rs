//! Parallel work, with the interpreter lock released.

use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use rayon::{ThreadPool, ThreadPoolBuilder};
use std::sync::{Mutex, PoisonError};

/// The threads, and the process that has them: a forked child has none. A fork has the interpreter lock, as has who locks this.
static POOL: Mutex<Option<(u32, &ThreadPool)>> = Mutex::new(None);

/// Does work on the threads of this process.
pub(crate) fn detach<R: Send>(py: Python<'_>, work: impl FnOnce() -> R + Send) -> PyResult<R> {
    let process = std::process::id();
    let mut pool = POOL.lock().unwrap_or_else(PoisonError::into_inner);
    let threads = match *pool {
        Some((owner, threads)) if owner == process => threads,
        _ => {
            let built =
                ThreadPoolBuilder::new().build().map_err(|e| PyRuntimeError::new_err(e.to_string()))?;
            // Never freed: the end of a pool waits for its threads, which a child lacks.
            pool.insert((process, Box::leak(Box::new(built)))).1
        }
    };
    drop(pool);
    Ok(py.detach(|| threads.install(work)))
}
