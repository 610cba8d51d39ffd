//! Finds a dead DDS thread: a process that looks alive and hears nothing is worse than one that ended.
//!
//! Two ways: a panic in one of RustDDS's threads is caught by a hook, and once a second the process counts those threads
//! in `/proc/self/task`. Its own heartbeat would say more, but where loopback has no multicast (the default on Linux) a
//! participant does not find itself, and nothing of its own comes back.

use std::sync::Once;
use std::sync::atomic::{AtomicBool, Ordering};

/// RustDDS names its threads so.
const DDS_THREAD: &str = "RustDDS";

static DDS_THREAD_PANICKED: AtomicBool = AtomicBool::new(false);

/// Notes panics of RustDDS's threads from now on, for the whole process. The usual message is printed, too.
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

/// Why the DDS layer counts as dead.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Dead {
    /// One of its threads panicked.
    #[error("a DDS thread of this process panicked (see above): nothing is sent or received any more")]
    Panicked,
    /// One of its threads is gone.
    #[error("{left} of {started} DDS threads of this process are left: nothing is sent or received any more")]
    Ended {
        /// The most there were.
        started: usize,
        /// Those there are.
        left: usize,
    },
}

/// Counts the DDS threads of this process.
#[derive(Clone, Copy, Debug, Default)]
pub struct Watchdog {
    most: usize,
}

impl Watchdog {
    /// Whether the DDS layer lives. To be asked once a second.
    pub fn check(&mut self) -> Result<(), Dead> {
        self.judge(dds_threads())
    }

    /// The same, `threads` being there now; `None` where they cannot be counted.
    fn judge(&mut self, threads: Option<usize>) -> Result<(), Dead> {
        if DDS_THREAD_PANICKED.load(Ordering::Relaxed) {
            return Err(Dead::Panicked);
        }
        let left = threads.unwrap_or(self.most);
        self.most = self.most.max(left);
        if left < self.most { Err(Dead::Ended { started: self.most, left }) } else { Ok(()) }
    }
}

/// Threads of this process with RustDDS's names; `None` where the system does not tell.
fn dds_threads() -> Option<usize> {
    let tasks = std::fs::read_dir("/proc/self/task").ok()?;
    let names = tasks.flatten().filter_map(|t| std::fs::read_to_string(t.path().join("comm")).ok());
    Some(names.filter(|name| name.starts_with(DDS_THREAD)).count())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_thread_that_is_gone_is_missed_and_one_that_comes_later_is_not() {
        let mut dog = Watchdog::default();
        assert_eq!(dog.judge(Some(1)), Ok(()));
        assert_eq!(dog.judge(Some(2)), Ok(()));
        assert_eq!(dog.judge(None), Ok(()), "no count is no death");
        assert_eq!(dog.judge(Some(1)), Err(Dead::Ended { started: 2, left: 1 }));
    }
}
