//! Computations that take longer than a node may leave its bus unattended.

use crate::bus::{Bus, Caller};
use crate::logging::Logger;
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::sync::mpsc::{Receiver, Sender, channel};

/// Runs one job at a time. If another thread can wake the bus, the job runs on a worker thread, so that the
/// node keeps publishing heartbeats. On the bus in memory, where time is virtual and results must not depend
/// on real time, a job runs at once.
///
/// [`Worker::result`] resumes a panic of the job. Dropping a worker does not stop its job: the
/// thread ends with the job, or with the process.
pub struct Worker<J, R> {
    kind: Kind<J, R>,
    busy: bool,
}

type Outcome<R> = std::thread::Result<R>;

enum Kind<J, R> {
    Here { work: Box<dyn FnMut(J) -> R>, done: Option<R> },
    Thread { jobs: Sender<J>, results: Receiver<Outcome<R>> },
}

impl<J, R> std::fmt::Debug for Worker<J, R> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Worker").field("busy", &self.busy).finish_non_exhaustive()
    }
}

impl<J: Send + 'static, R: Send + 'static> Worker<J, R> {
    /// A worker for a node on `bus`, without a job. The thread is called `name`.
    ///
    /// # Errors
    /// If the system cannot start a thread.
    pub fn new<F>(bus: &dyn Bus, name: &str, work: F) -> std::io::Result<Self>
    where
        F: FnMut(J) -> R + Send + 'static,
    {
        match bus.caller() {
            Some(caller) => Self::threaded(caller, name, work),
            None => Ok(Self { kind: Kind::Here { work: Box::new(work), done: None }, busy: false }),
        }
    }

    fn threaded<F>(caller: Caller, name: &str, mut work: F) -> std::io::Result<Self>
    where
        F: FnMut(J) -> R + Send + 'static,
    {
        let (jobs, its_jobs) = channel::<J>();
        let (its_results, results) = channel();
        let logger = Logger::of_thread();
        std::thread::Builder::new().name(name.into()).spawn(move || {
            logger.enter();
            for job in its_jobs {
                let outcome = catch_unwind(AssertUnwindSafe(|| work(job)));
                let last = outcome.is_err();
                let unheard = its_results.send(outcome).is_err();
                caller.call();
                if last || unheard {
                    return;
                }
            }
        })?;
        Ok(Self { kind: Kind::Thread { jobs, results }, busy: false })
    }

    /// True if a job was given and its result not taken yet.
    pub fn is_busy(&self) -> bool {
        self.busy
    }

    /// Begins a job. The bus wakes the node when it is done.
    ///
    /// # Panics
    /// If the worker is busy: an error in the node's code.
    pub fn give(&mut self, job: J) {
        assert!(!self.busy, "a worker has one job at a time");
        self.busy = true;
        match &mut self.kind {
            Kind::Here { work, done } => *done = Some(work(job)),
            Kind::Thread { jobs, .. } => assert!(jobs.send(job).is_ok(), "the worker's thread is there"),
        }
    }

    /// The result of the job, once, when it is done.
    ///
    /// # Panics
    /// With the panic of the job.
    pub fn result(&mut self) -> Option<R> {
        let outcome = match &mut self.kind {
            Kind::Here { done, .. } => done.take().map(Ok),
            Kind::Thread { results, .. } => results.try_recv().ok(),
        };
        self.busy &= outcome.is_none();
        outcome.map(|outcome| outcome.unwrap_or_else(|panic| resume_unwind(panic)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::Arc;

    #[test]
    fn a_panic_of_a_job_resumes_in_the_node() {
        let (called, calls) = channel();
        let caller = Caller(Arc::new(move || called.send(()).unwrap()));
        let mut worker = Worker::threaded(caller, "worker", |job: i32| {
            assert_ne!(job, 2, "a bug in the job");
            job * 10
        })
        .unwrap();
        worker.give(1);
        calls.recv().unwrap();
        assert_eq!((worker.result(), worker.is_busy()), (Some(10), false));
        worker.give(2);
        calls.recv().unwrap();
        let panic = catch_unwind(AssertUnwindSafe(|| worker.result())).unwrap_err();
        let text = panic.downcast_ref::<String>().expect("a text");
        assert!(text.contains("a bug in the job"), "{text}");
    }
}
