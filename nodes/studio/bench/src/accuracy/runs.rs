//! Many runs on a few threads.

use super::measure::{Outcome, measure};
use grainlab_scene::Scene;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};

/// One run.
pub(crate) struct Job<'a> {
    pub(crate) scene: &'a Scene,
    pub(crate) seed: u64,
    /// Maximum number of solver steps; a longer run counts as failed.
    pub(crate) limit: u64,
}

/// The outcome of each job, in the order of the jobs. A run stays on one thread, so that the CPU time of the
/// thread is that of the run. `done` is called after each run.
pub(crate) fn all(jobs: &[Job<'_>], threads: usize, done: impl Fn() + Sync) -> Vec<Result<Outcome, String>> {
    let next = AtomicUsize::new(0);
    let results: Vec<Mutex<Option<Result<Outcome, String>>>> =
        jobs.iter().map(|_| Mutex::new(None)).collect();
    let work = || {
        while let Some((job, result)) = {
            let index = next.fetch_add(1, Ordering::Relaxed);
            jobs.get(index).zip(results.get(index))
        } {
            let scene = Scene { seed: job.seed, ..job.scene.clone() };
            let outcome = measure(&scene, job.limit);
            *result.lock().unwrap_or_else(PoisonError::into_inner) = Some(outcome);
            done();
        }
    };
    std::thread::scope(|scope| {
        for _ in 1..threads.min(jobs.len()) {
            scope.spawn(work);
        }
        work();
    });
    let outcome = |m: Mutex<Option<Result<Outcome, String>>>| {
        m.into_inner().unwrap_or_else(PoisonError::into_inner).unwrap_or(Err("not run".to_owned()))
    };
    results.into_iter().map(outcome).collect()
}
