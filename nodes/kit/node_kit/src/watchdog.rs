//! Detects failed DDS threads, without which a process runs but receives nothing.
//!
//! There are two checks: a hook records a panic in one of RustDDS's threads, and once a second the process
//! counts those threads in `/proc/self/task` and compares the number with that of its open participants.
//! Receiving its own heartbeat would be a better check, but a participant discovers itself only if multicast
//! reaches it.

use std::sync::Once;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

const DDS_THREAD: &str = "RustDDS";

/// Number of RustDDS's threads per participant: discovery and the event loop.
const THREADS: usize = 2;

static DDS_THREAD_PANICKED: AtomicBool = AtomicBool::new(false);

static PARTICIPANTS: AtomicUsize = AtomicUsize::new(0);

/// Counts one participant while it exists.
#[derive(Debug)]
pub(crate) struct OpenParticipant(());

impl OpenParticipant {
    /// Call this after the participant's threads were started.
    pub(crate) fn new() -> Self {
        PARTICIPANTS.fetch_add(1, Ordering::Relaxed);
        Self(())
    }
}

impl Drop for OpenParticipant {
    fn drop(&mut self) {
        PARTICIPANTS.fetch_sub(1, Ordering::Relaxed);
    }
}

/// Records panics of RustDDS's threads from now on, for the whole process. The usual message is printed, too.
pub fn watch_dds_threads() {
    static HOOK: Once = Once::new();
    HOOK.call_once(|| {
        let before = std::panic::take_hook();
        std::panic::set_hook(Box::new(move |info| {
            if std::thread::current().name().is_some_and(|name| name.starts_with(DDS_THREAD)) {
                DDS_THREAD_PANICKED.store(true, Ordering::Relaxed);
            }
            before(info);
        }));
    });
}

/// A failure of the DDS layer: one of its threads panicked, or has ended.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{0}: nothing is sent or received any more")]
pub struct DdsFailure(String);

/// Checks the DDS threads of this process. Call it once a second.
pub fn check() -> Result<(), DdsFailure> {
    if DDS_THREAD_PANICKED.load(Ordering::Relaxed) {
        return Err(DdsFailure("a DDS thread of this process panicked (see above)".into()));
    }
    judge(THREADS * PARTICIPANTS.load(Ordering::Relaxed), dds_threads())
}

/// Judges `found` running threads; `None` where they cannot be counted.
fn judge(started: usize, found: Option<usize>) -> Result<(), DdsFailure> {
    match found {
        Some(left) if left < started => {
            Err(DdsFailure(format!("only {left} of {started} DDS threads of this process are running")))
        }
        _ => Ok(()),
    }
}

/// Number of threads of this process with RustDDS's names; `None` where the system does not list them.
fn dds_threads() -> Option<usize> {
    let tasks = std::fs::read_dir("/proc/self/task").ok()?;
    let names = tasks.flatten().filter_map(|t| std::fs::read_to_string(t.path().join("comm")).ok());
    Some(names.filter(|name| name.starts_with(DDS_THREAD)).count())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_ended_thread_is_reported_at_the_first_check() {
        assert_eq!(judge(2, Some(2)), Ok(()));
        assert_eq!(judge(2, None), Ok(()), "no count is no evidence");
        assert!(judge(2, Some(1)).unwrap_err().to_string().starts_with("only 1 of 2 DDS threads"));
        assert!(judge(2, Some(0)).unwrap_err().to_string().starts_with("only 0 of 2 DDS threads"));
    }
}
