//! Means of computing a step: instruction set and threads, neither of which changes a bit of the result; and a flag that
//! ends a computation early.

use crate::simd::instruction_set::Simd;
use rayon::ThreadPool;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// Grains that are worth a thread of their own.
const GRAINS_PER_THREAD: usize = 2000;

/// Most threads: no machine has more processors, and as many stacks fit into its memory.
const MOST_THREADS: usize = 1024;

/// Instruction set and threads.
#[derive(Clone, Debug)]
pub struct Compute {
    simd: Simd,
    threads: usize,
    pool: Option<Arc<ThreadPool>>,
    stop: Option<Arc<AtomicBool>>,
}

/// Why an instruction set or a number of threads is not available.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ComputeError {
    /// The processor lacks the instruction set.
    #[error("this processor has no {0}; it has {available}", available = names(&Simd::available()))]
    Simd(Simd),
    /// Threads could not be started.
    #[error("cannot use {threads} threads: {reason}")]
    Threads {
        /// Threads asked for.
        threads: usize,
        /// Reason in words.
        reason: String,
    },
}

fn names(sets: &[Simd]) -> String {
    sets.iter().map(Simd::to_string).collect::<Vec<_>>().join(", ")
}

impl Default for Compute {
    /// The widest instruction set of this processor, one thread.
    fn default() -> Self {
        Self { simd: Simd::best(), threads: 1, pool: None, stop: None }
    }
}

impl Compute {
    /// `threads` from 1 to 1024. Several threads divide the chunks of grains among themselves.
    pub fn new(simd: Simd, threads: usize) -> Result<Self, ComputeError> {
        if !simd.is_available() {
            return Err(ComputeError::Simd(simd));
        }
        let error = |reason: String| ComputeError::Threads { threads, reason };
        let pool = match threads {
            0 => return Err(error("at least one is needed".into())),
            1 => None,
            n if n > MOST_THREADS => return Err(error(format!("at most {MOST_THREADS} are allowed"))),
            n => {
                let built = rayon::ThreadPoolBuilder::new().num_threads(n).build();
                Some(Arc::new(built.map_err(|e| error(e.to_string()))?))
            }
        };
        Ok(Self { simd, threads, pool, stop: None })
    }

    /// Adds a flag that another thread may set: computations then end with
    /// [`DemError::Stopped`](crate::DemError::Stopped) within about a step.
    pub fn stopping_on(self, flag: Arc<AtomicBool>) -> Self {
        Self { stop: Some(flag), ..self }
    }

    /// True if the flag is set.
    pub fn is_stopped(&self) -> bool {
        self.stop.as_ref().is_some_and(|flag| flag.load(Ordering::Relaxed))
    }

    /// Threads worth using for this many grains and cores. Pairs across the border of two subdomains are evaluated in both,
    /// so each thread needs some thousands of grains to be worth it.
    pub fn useful_threads(grains: usize, cores: usize) -> usize {
        (grains / GRAINS_PER_THREAD).clamp(1, cores.max(1))
    }

    /// Instruction set in use.
    pub fn simd(&self) -> Simd {
        self.simd
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
    pub(crate) fn map_subdomains<T: Send, R: Send>(
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

/// Splits the pieces between two threads, and so on.
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

/// Runs `work` while the other threads of the pool poll for tasks without sleeping.
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
