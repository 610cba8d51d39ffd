//! Means of computing a step: threads, which change no bit of the result, and a flag that ends a computation early.

use rayon::ThreadPool;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// Most threads: no machine has more processors, and as many stacks fit into its memory.
const MOST_THREADS: usize = 1024;

/// Threads, and the flag that stops a computation.
#[derive(Clone, Debug)]
pub struct Compute {
    threads: usize,
    pool: Option<Arc<ThreadPool>>,
    stop: Option<Arc<AtomicBool>>,
}

/// Why a number of threads is not available.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("cannot use {threads} threads: {reason}")]
pub struct ThreadsError {
    /// Threads asked for.
    pub threads: usize,
    /// Reason in words.
    pub reason: String,
}

impl Default for Compute {
    /// One thread.
    fn default() -> Self {
        Self { threads: 1, pool: None, stop: None }
    }
}

impl Compute {
    /// Starts `threads` threads, from 1 to 1024.
    ///
    /// # Errors
    /// No thread, too many, or threads that the system does not start.
    pub fn new(threads: usize) -> Result<Self, ThreadsError> {
        let error = |reason: String| ThreadsError { threads, reason };
        let pool = match threads {
            0 => return Err(error("at least one is needed".into())),
            1 => None,
            n if n > MOST_THREADS => return Err(error(format!("at most {MOST_THREADS} are allowed"))),
            n => {
                let built = rayon::ThreadPoolBuilder::new().num_threads(n).build();
                Some(Arc::new(built.map_err(|e| error(e.to_string()))?))
            }
        };
        Ok(Self { threads, pool, stop: None })
    }

    /// Adds a flag that another thread may set: computations then end with
    /// [`EngineError::Stopped`](crate::EngineError::Stopped) within about a step.
    pub fn stopping_on(self, flag: Arc<AtomicBool>) -> Self {
        Self { stop: Some(flag), ..self }
    }

    /// True if the flag is set.
    pub fn is_stopped(&self) -> bool {
        self.stop.as_ref().is_some_and(|flag| flag.load(Ordering::Relaxed))
    }

    /// Number of threads.
    pub fn threads(&self) -> usize {
        self.threads
    }

    /// Runs `work`, which uses all threads again and again, and keeps them spinning meanwhile: waking a sleeping thread takes
    /// longer than a step.
    pub fn install<R: Send>(&self, work: impl FnOnce() -> R + Send) -> R {
        match &self.pool {
            Some(pool) => pool.install(|| keep_threads_spinning(work)),
            None => work(),
        }
    }

    /// Does one piece of work per subdomain, each on its own thread, and returns the results in order. The pieces should take
    /// equal and short times: a thread that has finished spins until the others have.
    pub fn map_subdomains<T: Send, R: Send>(
        &self,
        pieces: impl Iterator<Item = T>,
        work: impl Fn(T) -> R + Sync + Send,
    ) -> Vec<R> {
        match &self.pool {
            None => pieces.map(work).collect(),
            Some(pool) => {
                let pieces = pieces.collect();
                pool.install(|| fork_join(pieces, &work))
            }
        }
    }
}

fn fork_join<T: Send, R: Send>(mut pieces: Vec<T>, work: &(impl Fn(T) -> R + Sync)) -> Vec<R> {
    if pieces.len() < 2 {
        return pieces.into_iter().map(work).collect();
    }
    let others = pieces.split_off(pieces.len() / 2);
    let (started, done) = (AtomicBool::new(false), AtomicBool::new(false));
    let one = || {
        let results = fork_join(pieces, work);
        // A thread that waits in the pool falls asleep, and waking it takes longer than the other piece does. If that piece
        // takes long after all, it may need this core: so yield now and then.
        let mut polls = 0u32;
        while started.load(Ordering::Acquire) && !done.load(Ordering::Acquire) {
            polls += 1;
            if polls.is_multiple_of(1000) { std::thread::yield_now() } else { std::hint::spin_loop() }
        }
        results
    };
    let other = || {
        started.store(true, Ordering::Release);
        let _set = SetOnDrop(&done);
        fork_join(others, work)
    };
    let (mut results, others) = rayon::join(one, other);
    results.extend(others);
    results
}

fn keep_threads_spinning<R>(work: impl FnOnce() -> R) -> R {
    let leader = rayon::current_thread_index();
    let done = AtomicBool::new(false);
    rayon::in_place_scope(|scope| {
        scope.spawn_broadcast(|_, _| {
            // The leader runs this too, and must return to its work.
            while rayon::current_thread_index() != leader && !done.load(Ordering::Acquire) {
                if rayon::yield_now() != Some(rayon::Yield::Executed) {
                    std::thread::yield_now();
                }
            }
        });
        let set = SetOnDrop(&done);
        let result = work();
        drop(set);
        result
    })
}

/// Sets the flag even if the work panics, so that the other threads stop waiting.
struct SetOnDrop<'a>(&'a AtomicBool);

impl Drop for SetOnDrop<'_> {
    fn drop(&mut self) {
        self.0.store(true, Ordering::Release);
    }
}
