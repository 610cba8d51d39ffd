//! What a step is computed with: instruction set and threads. Neither changes a bit of the result.

use crate::simd::Simd;
use rayon::ThreadPool;
use rayon::prelude::*;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// Grains that make a thread of their own pay.
const GRAINS_PER_THREAD: usize = 2000;

/// Instruction set and threads.
#[derive(Clone, Debug)]
pub struct Compute {
    simd: Simd,
    threads: usize,
    pool: Option<Arc<ThreadPool>>,
}

/// Why a way to compute cannot be had.
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
        /// Why not.
        reason: String,
    },
}

fn names(sets: &[Simd]) -> String {
    sets.iter().map(Simd::to_string).collect::<Vec<_>>().join(", ")
}

impl Default for Compute {
    /// The widest instruction set of this processor, one thread.
    fn default() -> Self {
        Self { simd: Simd::best(), threads: 1, pool: None }
    }
}

impl Compute {
    /// `threads` from 1; more than one share the chunks of grains between them.
    pub fn new(simd: Simd, threads: usize) -> Result<Self, ComputeError> {
        if !simd.is_available() {
            return Err(ComputeError::Simd(simd));
        }
        let fault = |reason: String| ComputeError::Threads { threads, reason };
        let pool = match threads {
            0 => return Err(fault("at least one is needed".into())),
            1 => None,
            n => {
                let built = rayon::ThreadPoolBuilder::new().num_threads(n).build();
                Some(Arc::new(built.map_err(|e| fault(e.to_string()))?))
            }
        };
        Ok(Self { simd, threads, pool })
    }

    /// Threads worth using for so many grains on so many cores: each needs some thousands of grains to pay for what
    /// it does twice over: pairs across the border of its share.
    pub fn threads_that_pay(grains: usize, cores: usize) -> usize {
        (grains / GRAINS_PER_THREAD).clamp(1, cores.max(1))
    }

    /// Instruction set.
    pub fn simd(&self) -> Simd {
        self.simd
    }

    /// Threads.
    pub fn threads(&self) -> usize {
        self.threads
    }

    /// Does work that goes over and over to all threads, and keeps them awake meanwhile: a thread that has gone to sleep
    /// takes longer to wake than a step takes.
    pub fn within<R: Send>(&self, work: impl FnOnce() -> R + Send) -> R {
        match &self.pool {
            Some(pool) => pool.install(|| awake(work)),
            None => work(),
        }
    }

    /// Does all pieces of work, one a thread as long as there are threads, and gives their results in their order. They
    /// should take about as long as each other, and little: who is done first does not rest until the others are.
    pub(crate) fn share<T: Send, R: Send>(
        &self,
        pieces: impl Iterator<Item = T>,
        work: impl Fn(T) -> R + Sync + Send,
    ) -> Vec<R> {
        match &self.pool {
            None => pieces.map(work).collect(),
            Some(pool) => {
                let pieces = pieces.collect();
                pool.install(|| side_by_side(pieces, &work))
            }
        }
    }

    /// Does all work items, and joins their results in their order, whatever thread they came from.
    pub(crate) fn each<T: Send, R: Send>(
        &self,
        items: impl Iterator<Item = T>,
        work: impl Fn(T) -> R + Sync + Send,
        join: impl FnMut(R),
    ) {
        match &self.pool {
            None => items.map(work).for_each(join),
            Some(pool) => {
                let items: Vec<T> = items.collect();
                let results: Vec<R> = pool.install(|| items.into_par_iter().map(work).collect());
                results.into_iter().for_each(join);
            }
        }
    }
}

/// Halves of the pieces on two threads, and so on.
fn side_by_side<T: Send, R: Send>(mut pieces: Vec<T>, work: &(impl Fn(T) -> R + Sync)) -> Vec<R> {
    if pieces.len() < 2 {
        return pieces.into_iter().map(work).collect();
    }
    let others = pieces.split_off(pieces.len() / 2);
    let (begun, done) = (AtomicBool::new(false), AtomicBool::new(false));
    let one = || {
        let results = side_by_side(pieces, work);
        // A thread that the pool lets wait goes to sleep; waking up takes longer than the others take. Where they take
        // long after all, they may be in want of this very core.
        let mut looks = 0u32;
        while begun.load(Ordering::Acquire) && !done.load(Ordering::Acquire) {
            looks += 1;
            if looks.is_multiple_of(1000) { std::thread::yield_now() } else { std::hint::spin_loop() }
        }
        results
    };
    let other = || {
        begun.store(true, Ordering::Release);
        let _end = Ending(&done);
        side_by_side(others, work)
    };
    let (mut results, others) = rayon::join(one, other);
    results.extend(others);
    results
}

/// Does `work` while the other threads of the pool look for their part in it without rest.
fn awake<R>(work: impl FnOnce() -> R) -> R {
    let leader = rayon::current_thread_index();
    let done = AtomicBool::new(false);
    rayon::in_place_scope(|scope| {
        scope.spawn_broadcast(|_, _| {
            // The leader comes by here too; it must not stay.
            while rayon::current_thread_index() != leader && !done.load(Ordering::Acquire) {
                if rayon::yield_now() != Some(rayon::Yield::Executed) {
                    std::thread::yield_now();
                }
            }
        });
        let end = Ending(&done);
        let result = work();
        drop(end);
        result
    })
}

/// Lets the others rest, whatever happens.
struct Ending<'a>(&'a AtomicBool);

impl Drop for Ending<'_> {
    fn drop(&mut self) {
        self.0.store(true, Ordering::Release);
    }
}
