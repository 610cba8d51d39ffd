//! Syncs a file to the device in a separate thread: in the recorder's thread it would take tens of
//! milliseconds.

use std::fs::File;
use std::io;
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

pub(super) struct DeviceSync {
    /// `None` once stopped.
    requests: Option<SyncSender<()>>,
    failures: Receiver<io::Error>,
    thread: Option<JoinHandle<()>>,
    last: Option<Instant>,
    /// True if data were written since the last request.
    unsynced: bool,
}

impl DeviceSync {
    pub(super) fn start(file: File) -> io::Result<Self> {
        let (requests, inbox) = sync_channel::<()>(1);
        let (report, failures) = sync_channel::<io::Error>(1);
        let work = move || {
            while inbox.recv().is_ok() {
                if let Err(e) = file.sync_data() {
                    // The first error matters; a full mailbox contains it already.
                    let _ = report.try_send(e);
                }
            }
        };
        let thread = std::thread::Builder::new().name("recording-sync".into()).spawn(work)?;
        Ok(Self { requests: Some(requests), failures, thread: Some(thread), last: None, unsynced: false })
    }

    pub(super) fn note_written(&mut self) {
        self.unsynced = true;
    }

    pub(super) fn request(&mut self, now: Instant, interval: Duration) {
        let due = self.last.is_none_or(|t| now.saturating_duration_since(t) >= interval);
        if !(self.unsynced && due) {
            return;
        }
        // A full mailbox means that the last sync is still running: the next tick tries again.
        if self.requests.as_ref().is_some_and(|r| r.try_send(()).is_ok()) {
            self.last = Some(now);
            self.unsynced = false;
        }
    }

    pub(super) fn failure(&self) -> Option<io::Error> {
        self.failures.try_recv().ok()
    }

    pub(super) fn stop(&mut self) {
        self.requests = None;
        if let Some(thread) = self.thread.take() {
            // The thread cannot panic: it only waits and syncs.
            let _ = thread.join();
        }
    }
}

impl Drop for DeviceSync {
    fn drop(&mut self) {
        self.stop();
    }
}
