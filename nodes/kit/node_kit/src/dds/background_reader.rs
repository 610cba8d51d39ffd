//! Empties the readers while the node computes.
//!
//! RustDDS acknowledges a sample as soon as its cache holds it, and the cache is bounded: a node that computes for
//! seconds would lose what it has acknowledged. The background reader moves samples into the queues of this process
//! as soon as the node has not used the bus for a while, and follows the graph. It does nothing for a node with short
//! steps.

use super::graph::Follower;
use super::inbox::Inbox;
use crate::lock::lock;
use mio::Waker;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Condvar, Mutex, PoisonError};
use std::time::{Duration, Instant};

/// Time without use of the bus after which the background reader empties the readers. An ending node stays longer than
/// this.
const ABSENCE: Duration = Duration::from_millis(20);

/// Readers of one bus, shared with the background reader.
pub(super) type Inboxes = Arc<Mutex<Vec<Arc<Mutex<Inbox>>>>>;

struct Shared {
    start: Instant,
    /// Time at which the node last used the bus, ns since `start`.
    last_seen: AtomicU64,
    stopped: Mutex<bool>,
    stop: Condvar,
}

/// The thread; it ends when this is dropped.
pub(super) struct BackgroundReader {
    shared: Arc<Shared>,
    thread: Option<std::thread::JoinHandle<()>>,
}

impl BackgroundReader {
    pub(super) fn spawn(
        inboxes: Inboxes,
        follower: Arc<Mutex<Follower>>,
        waker: Arc<Waker>,
    ) -> std::io::Result<Self> {
        let shared = Arc::new(Shared {
            start: Instant::now(),
            last_seen: AtomicU64::new(0),
            stopped: Mutex::new(false),
            stop: Condvar::new(),
        });
        let its = Arc::clone(&shared);
        let thread = std::thread::Builder::new()
            .name("bus reader".into())
            .spawn(move || run(&its, &inboxes, &follower, &waker))?;
        Ok(Self { shared, thread: Some(thread) })
    }

    pub(super) fn seen(&self) {
        self.shared.last_seen.store(self.shared.start.elapsed().as_nanos() as u64, Ordering::Relaxed);
    }
}

impl Drop for BackgroundReader {
    fn drop(&mut self) {
        *lock(&self.shared.stopped) = true;
        self.shared.stop.notify_all();
        if let Some(thread) = self.thread.take()
            && thread.join().is_err()
        {
            log::error!("the bus reader panicked");
        }
    }
}

fn run(shared: &Shared, inboxes: &Inboxes, follower: &Mutex<Follower>, waker: &Waker) {
    let mut stopped = lock(&shared.stopped);
    while !*stopped {
        stopped = shared.stop.wait_timeout(stopped, ABSENCE).unwrap_or_else(PoisonError::into_inner).0;
        let absent = shared.start.elapsed().as_nanos() as u64 - shared.last_seen.load(Ordering::Relaxed);
        if *stopped || absent < ABSENCE.as_nanos() as u64 {
            continue;
        }
        let all: Vec<Arc<Mutex<Inbox>>> = lock(inboxes).clone();
        let mut moved = false;
        for inbox in &all {
            // The node's next take returns the error of a failing reader.
            moved |= lock(inbox).collect().unwrap_or(false);
        }
        moved |= lock(follower).follow();
        // The node may have begun to wait meanwhile: the reader is empty now, so wake it again.
        if moved && let Err(error) = waker.wake() {
            log::error!("cannot wake the node: {error}");
        }
    }
}
