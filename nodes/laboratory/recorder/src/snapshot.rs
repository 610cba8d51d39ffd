//! The last seconds in memory, written when asked to.

use grainlab_node_kit::Sample;
use signal_hook::consts::SIGUSR1;
use std::collections::{BTreeMap, VecDeque};
use std::io;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

/// Settings of a snapshot.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SnapshotSettings {
    /// Messages that arrived within this time are kept.
    pub span: Duration,
    /// A message on this topic writes them, as SIGUSR1 does.
    pub trigger: Option<String>,
}

/// Maximum size of the messages in memory, bytes. Earlier ones are left out.
const MOST: usize = 512 << 20;

/// A message in memory.
#[derive(Debug)]
pub(crate) struct Kept {
    /// Full name of the topic.
    pub(crate) topic: String,
    pub(crate) sample: Sample,
    /// Late readers get the last message of the topic.
    pub(crate) latched: bool,
}

/// The last messages, in order of arrival.
#[derive(Debug)]
pub(crate) struct Snapshot {
    settings: SnapshotSettings,
    asked: Arc<AtomicBool>,
    kept: VecDeque<Kept>,
    /// Last message of each latched topic that is older than the span.
    latched: BTreeMap<String, Kept>,
    bytes: usize,
}

impl Snapshot {
    /// Nothing is kept yet. From now on SIGUSR1 asks for a snapshot.
    pub(crate) fn new(settings: SnapshotSettings) -> io::Result<Self> {
        let asked = Arc::new(AtomicBool::new(false));
        signal_hook::flag::register(SIGUSR1, Arc::clone(&asked))?;
        Ok(Self { settings, asked, kept: VecDeque::new(), latched: BTreeMap::new(), bytes: 0 })
    }

    /// Keeps a message; asks for a snapshot if its topic is the trigger.
    pub(crate) fn keep(&mut self, kept: Kept) {
        let bare = |name: &str| name.trim_start_matches('/').to_owned();
        if self.settings.trigger.as_deref().is_some_and(|t| bare(t) == bare(&kept.topic)) {
            self.asked.store(true, Ordering::Relaxed);
        }
        self.bytes += kept.sample.body.len();
        self.kept.push_back(kept);
    }

    /// Passes messages that are too old at `now` (ns since 1970) to `leave_out`.
    pub(crate) fn expire(&mut self, now: u64, mut leave_out: impl FnMut(Kept)) {
        let span = u64::try_from(self.settings.span.as_nanos()).unwrap_or(u64::MAX);
        let oldest = now.saturating_sub(span);
        while self.kept.front().is_some_and(|k| k.sample.info.received < oldest || self.bytes > MOST) {
            let Some(old) = self.kept.pop_front() else { break };
            self.bytes -= old.sample.body.len();
            let replaced = match old.latched {
                true => self.latched.insert(old.topic.clone(), old),
                false => Some(old),
            };
            replaced.into_iter().for_each(&mut leave_out);
        }
    }

    /// All messages, if a snapshot was asked for: the latched ones first, then those within the span.
    pub(crate) fn taken(&mut self) -> Option<Vec<Kept>> {
        self.asked.swap(false, Ordering::Relaxed).then(|| self.rest())
    }

    /// Takes all messages.
    pub(crate) fn rest(&mut self) -> Vec<Kept> {
        self.bytes = 0;
        let mut all: Vec<Kept> = std::mem::take(&mut self.latched).into_values().collect();
        all.sort_by_key(|k| k.sample.info.received);
        all.extend(self.kept.drain(..));
        all
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use grainlab_msgs::Guid;
    use grainlab_node_kit::SampleInfo;

    fn kept(topic: &str, latched: bool, second: u64) -> Kept {
        let received = second * 1_000_000_000;
        let (writer, sequence) = (Guid([1; 16]), second as i64);
        let info = SampleInfo { writer, sequence, source_time: None, received, about: None };
        Kept { topic: topic.into(), latched, sample: Sample { body: vec![0; 8], info } }
    }

    #[test]
    fn a_snapshot_has_the_last_seconds_and_the_last_latched_message_of_each_topic() {
        let settings = SnapshotSettings { span: Duration::from_secs(3), trigger: Some("alarm".into()) };
        let mut snapshot = Snapshot::new(settings).unwrap();
        let mut left_out = Vec::new();
        let name = |k: Kept| (k.topic, k.sample.info.sequence);
        for second in 1..=10 {
            snapshot.keep(kept("/a", false, second));
            if second < 5 {
                snapshot.keep(kept("/state", true, second));
            }
            snapshot.expire(second * 1_000_000_000, |k| left_out.push(name(k)));
        }
        assert!(snapshot.taken().is_none(), "nothing asked for it");
        snapshot.keep(kept("/alarm", false, 10));
        let taken: Vec<_> = snapshot.taken().unwrap().into_iter().map(name).collect();
        let expected = [("/state", 4), ("/a", 7), ("/a", 8), ("/a", 9), ("/a", 10), ("/alarm", 10)];
        assert_eq!(taken, expected.map(|(topic, n)| (topic.to_owned(), n)));
        assert_eq!(left_out.len(), 9, "six of /a and three of /state: {left_out:?}");
        assert!(snapshot.taken().is_none() && snapshot.rest().is_empty());
    }
}
