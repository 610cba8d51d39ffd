//! Ends the wait of the one thread that steps the nodes.

use crate::lock::lock;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Condvar, Mutex, PoisonError};
use std::time::Duration;

/// Longest wait without a look at the request to stop, which a signal handler sets without a call.
const LOOK: Duration = Duration::from_millis(50);

#[derive(Debug)]
pub(super) struct Alarm {
    called: Mutex<bool>,
    rings: Condvar,
    pub(super) stop: Arc<AtomicBool>,
}

impl Alarm {
    pub(super) fn new(stop: Arc<AtomicBool>) -> Self {
        Self { called: Mutex::new(false), rings: Condvar::new(), stop }
    }

    /// Ends the present wait, or else the next one.
    pub(super) fn call(&self) {
        *lock(&self.called) = true;
        self.rings.notify_one();
    }

    /// True once after a call.
    pub(super) fn was_called(&self) -> bool {
        std::mem::take(&mut *lock(&self.called))
    }

    /// Waits until a call, a request to stop, or for `time` at most, 50 ms at most.
    pub(super) fn wait(&self, time: Duration) {
        let called = lock(&self.called);
        if !*called && !self.stop.load(Ordering::Relaxed) {
            let waited = self.rings.wait_timeout(called, time.min(LOOK));
            drop(waited.unwrap_or_else(PoisonError::into_inner));
        }
    }
}
