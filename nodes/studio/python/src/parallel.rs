//! Work on all cores, with the interpreter lock released, that Ctrl-C ends.

use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use rayon::{ThreadPool, ThreadPoolBuilder};
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{RecvTimeoutError, sync_channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

const POLL_PERIOD: Duration = Duration::from_millis(50);

/// The threads, and the process that has them: a forked child has none. A fork has the interpreter lock, as has who locks this.
static POOL: Mutex<Option<(u32, &ThreadPool)>> = Mutex::new(None);

/// Does `work` on the threads of this process.
///
/// A signal handler that raises, as Ctrl-C does, raises here at once. The work is then told to stop by its argument, and what it still
/// does is dropped.
pub(crate) fn detach<R: Send + 'static>(
    py: Python<'_>,
    work: impl FnOnce(&AtomicBool) -> R + Send + 'static,
) -> PyResult<R> {
    let is_stopped = Arc::new(AtomicBool::new(false));
    let stop = Arc::clone(&is_stopped);
    let (send, mut receive) = sync_channel(1);
    threads()?.spawn(move || {
        // A panic is handed to the caller; nothing that the work has touched is used after it.
        let done = catch_unwind(AssertUnwindSafe(|| work(&stop)));
        // The caller may have left.
        _ = send.send(done);
    });
    loop {
        // A receiver belongs to one thread at a time, which a shared reference would not show.
        let receive = &mut receive;
        match py.detach(move || receive.recv_timeout(POLL_PERIOD)) {
            Ok(done) => return Ok(done.unwrap_or_else(|panic| resume_unwind(panic))),
            Err(RecvTimeoutError::Timeout) => {
                py.check_signals().inspect_err(|_| is_stopped.store(true, Ordering::Relaxed))?;
            }
            Err(RecvTimeoutError::Disconnected) => {
                return Err(PyRuntimeError::new_err(
                    "a thread of the computation has ended without a result",
                ));
            }
        }
    }
}

fn threads() -> PyResult<&'static ThreadPool> {
    let process = std::process::id();
    let mut pool = POOL.lock().unwrap_or_else(PoisonError::into_inner);
    match *pool {
        Some((owner, threads)) if owner == process => Ok(threads),
        _ => {
            let built =
                ThreadPoolBuilder::new().build().map_err(|e| PyRuntimeError::new_err(e.to_string()))?;
            // Never freed: the end of a pool waits for its threads, which a child lacks.
            Ok(pool.insert((process, Box::leak(Box::new(built)))).1)
        }
    }
}
