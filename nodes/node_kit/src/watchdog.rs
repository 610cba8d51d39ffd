//! Finds a dead DDS thread: a process that looks alive and hears nothing is worse than one that ended.
//!
//! Two ways: a panic in one of RustDDS's threads is caught by a hook and reported at the next step; and every process
//! listens to its own heartbeat, which travels through the event loop, the loopback interface and the event loop again.

use std::sync::Once;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

/// How long an own heartbeat may take: far above any delay of a loaded machine.
pub const LIMIT: Duration = Duration::from_secs(10);

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
    /// Our own heartbeats do not come back.
    #[error(
        "our own heartbeat did not come back for {0:?}: the DDS threads of this process are dead or stuck"
    )]
    NoEcho(Duration),
}

/// Compares heartbeats sent with heartbeats heard.
#[derive(Clone, Copy, Debug, Default)]
pub struct Watchdog {
    /// Since when one is missing.
    unanswered_since: Option<Duration>,
}

impl Watchdog {
    /// A heartbeat was published at `now`.
    pub fn sent(&mut self, now: Duration) {
        self.unanswered_since.get_or_insert(now);
    }

    /// One of our own came back.
    pub fn heard(&mut self) {
        self.unanswered_since = None;
    }

    /// Whether the DDS layer lives. To be asked after everything that arrived was taken, so that a node that computed
    /// for long does not suspect itself.
    pub fn check(&self, now: Duration) -> Result<(), Dead> {
        if DDS_THREAD_PANICKED.load(Ordering::Relaxed) {
            return Err(Dead::Panicked);
        }
        match self.unanswered_since.map(|since| now.saturating_sub(since)) {
            Some(silent) if silent > LIMIT => Err(Dead::NoEcho(silent)),
            _ => Ok(()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn silence_counts_from_the_first_unanswered_heartbeat() {
        let mut dog = Watchdog::default();
        assert_eq!(dog.check(LIMIT * 5), Ok(()), "nothing sent, nothing missing");
        for second in 1..=8 {
            dog.sent(Duration::from_secs(second));
        }
        assert_eq!(dog.check(Duration::from_secs(11)), Ok(()));
        assert_eq!(dog.check(Duration::from_secs(12)), Err(Dead::NoEcho(Duration::from_secs(11))));
        dog.heard();
        assert_eq!(dog.check(Duration::from_secs(60)), Ok(()));
    }
}
