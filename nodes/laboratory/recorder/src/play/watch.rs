//! The acknowledgements of one topic over time.

use grainlab_node_kit::Delivery;
use std::time::Duration;

/// A subscriber that is removed after this time without any acknowledgement did not leave: it was stopped or ended, and its
/// discovery lease has expired. Many programs have a lease of 10 s.
const SILENT: Duration = Duration::from_secs(3);

/// Time in which the removal of a subscriber reaches the graph.
const REMOVAL: Duration = Duration::from_millis(200);

/// The state of one topic on the bus at one time.
#[derive(Clone, Copy, Debug)]
pub(super) struct Seen {
    pub(super) sent: u64,
    /// Number of messages that some subscriber has not acknowledged.
    pub(super) pending: u64,
    pub(super) readers: usize,
    /// True if every reliable subscriber has answered the publisher at least once.
    pub(super) is_answered: bool,
}

/// The acknowledgements of one topic.
#[derive(Debug, Default)]
pub(super) struct Watch {
    pending: u64,
    acknowledged: u64,
    /// True while a subscriber owes an answer: to a message, or to the publisher itself before the first message.
    is_owed: bool,
    /// Time of the last answer, or since which an answer is owed.
    progress: Duration,
    /// Largest number of subscribers since then.
    readers: usize,
    was_read: bool,
    suspect: Option<Suspect>,
    last_of_removed: Option<u64>,
}

/// A silence that ended, because its subscriber answered at last or was removed.
#[derive(Debug)]
struct Suspect {
    /// Number of messages that were acknowledged before the silence.
    acknowledged: u64,
    readers: usize,
    until: Duration,
}

impl Watch {
    pub(super) fn look(&mut self, now: Duration, seen: Seen) {
        let Seen { sent, pending, readers, is_answered } = seen;
        let acknowledged = sent.saturating_sub(pending);
        let is_owed = pending > 0 || !is_answered;
        self.readers = self.readers.max(readers);
        self.was_read |= readers > 0;
        if !is_owed || acknowledged > self.acknowledged || !self.is_owed {
            if self.is_owed && now.saturating_sub(self.progress) >= SILENT {
                let (acknowledged, readers) = (self.acknowledged, self.readers);
                self.suspect = Some(Suspect { acknowledged, readers, until: now + REMOVAL });
            }
            (self.progress, self.readers) = (now, readers);
        }
        (self.pending, self.acknowledged, self.is_owed) = (pending, acknowledged, is_owed);
        if let Some(suspect) = &self.suspect {
            if readers < suspect.readers {
                let first = self.last_of_removed.unwrap_or(u64::MAX);
                self.last_of_removed = Some(first.min(suspect.acknowledged));
                self.suspect = None;
            } else if now >= suspect.until {
                self.suspect = None;
            }
        }
    }

    /// Returns true if messages are pending, and none was acknowledged for [`Delivery::PATIENCE`].
    pub(super) fn is_stuck(&self, now: Duration) -> bool {
        self.pending > 0 && now.saturating_sub(self.progress) >= Delivery::PATIENCE
    }

    /// Returns true if every message is acknowledged, or its subscriber was removed.
    pub(super) fn is_settled(&self) -> bool {
        self.pending == 0 && self.suspect.is_none()
    }

    /// Number of messages that some subscriber had not acknowledged at the last look.
    pub(super) fn pending(&self) -> u64 {
        self.pending
    }

    /// Number of messages, of `sent`, that a subscriber did not acknowledge because it was removed without a word, at that time or
    /// before; `None` if no subscriber was removed so.
    pub(super) fn abandoned(&self, sent: u64) -> Option<u64> {
        self.last_of_removed.map(|acknowledged| sent - acknowledged)
    }

    /// True if the topic had a subscriber at any time.
    pub(super) fn was_read(&self) -> bool {
        self.was_read
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SECOND: Duration = Duration::from_secs(1);

    fn seen(sent: u64, pending: u64, readers: usize) -> Seen {
        Seen { sent, pending, readers, is_answered: true }
    }

    #[test]
    fn a_topic_is_stuck_after_ten_seconds_without_an_acknowledgement() {
        let mut watch = Watch::default();
        watch.look(5 * SECOND, seen(0, 0, 1));
        watch.look(9 * SECOND, seen(100, 100, 1));
        assert!(!watch.is_stuck(18 * SECOND) && !watch.is_settled());
        watch.look(18 * SECOND, seen(200, 199, 1));
        assert!(!watch.is_stuck(27 * SECOND), "one was acknowledged");
        assert!(watch.is_stuck(28 * SECOND));
        watch.look(29 * SECOND, seen(200, 0, 1));
        assert!(!watch.is_stuck(99 * SECOND));
    }

    #[test]
    fn messages_of_a_subscriber_that_is_removed_after_a_silence_are_not_acknowledged() {
        let after = |silence: Duration, readers: [usize; 2]| {
            let mut watch = Watch::default();
            watch.look(SECOND, seen(0, 0, 2));
            watch.look(SECOND, seen(50, 40, 2));
            let end = SECOND + silence;
            watch.look(end, seen(60, 50, 2));
            // The other subscriber has acknowledged all but two, this one ten. The graph may know of the removal a little later.
            watch.look(end, seen(60, 2, readers[0]));
            watch.look(end + REMOVAL / 2, seen(60, 0, readers[1]));
            watch.look(end + 2 * REMOVAL, seen(60, 0, readers[1]));
            assert!(watch.is_settled());
            watch.abandoned(70)
        };
        assert_eq!(after(9 * SECOND, [2, 1]), Some(60));
        assert_eq!(after(9 * SECOND, [1, 1]), Some(60));
        assert_eq!(after(9 * SECOND, [2, 2]), None, "it was slow, and is there");
        assert_eq!(after(SECOND, [2, 1]), None, "it left");
    }

    /// A subscriber that is matched and stopped at once: the publisher waits 10 s for its answer, and the subscriber is removed
    /// before, or shortly after the first messages.
    #[test]
    fn messages_of_a_subscriber_that_never_answered_are_counted_however_late_they_are_sent() {
        let removed = |sent_before: u64, is_removed: bool| {
            let mut watch = Watch::default();
            watch.look(SECOND, Seen { is_answered: false, ..seen(0, 0, 1) });
            watch.look(10 * SECOND, Seen { is_answered: false, ..seen(0, 0, 1) });
            watch.look(11 * SECOND, Seen { is_answered: false, ..seen(sent_before, sent_before, 1) });
            let readers = usize::from(!is_removed);
            watch.look(12 * SECOND, seen(sent_before, 0, readers));
            watch.look(13 * SECOND, seen(100, 0, readers));
            assert!(watch.is_settled() && watch.was_read());
            watch.abandoned(100)
        };
        assert_eq!(removed(60, true), Some(100));
        assert_eq!(removed(0, true), Some(100), "before the first message");
        assert_eq!([removed(60, false), removed(0, false)], [None, None], "it answered at last");
    }
}
