//! The acknowledgements of one topic over time.

use grainlab_node_kit::Delivery;
use std::time::Duration;

/// A subscriber that is removed after this time without any acknowledgement did not leave: it was stopped or ended, and its
/// discovery lease has expired. Many programs have a lease of 10 s.
const SILENT: Duration = Duration::from_secs(3);

/// Time in which the removal of a subscriber reaches the graph.
const REMOVAL: Duration = Duration::from_millis(200);

/// The acknowledgements of one topic.
#[derive(Debug, Default)]
pub(super) struct Watch {
    pending: u64,
    acknowledged: u64,
    /// Time of the last acknowledgement, or at which the first message became pending.
    progress: Duration,
    /// Largest number of subscribers since then.
    readers: usize,
    suspect: Option<Suspect>,
    abandoned: u64,
}

/// Messages that ceased to be pending after a silence: acknowledged at last, or their subscriber was removed.
#[derive(Debug)]
struct Suspect {
    messages: u64,
    readers: usize,
    until: Duration,
}

impl Watch {
    /// Looks at the topic: messages sent, messages that some subscriber has not acknowledged, number of subscribers.
    pub(super) fn look(&mut self, now: Duration, sent: u64, pending: u64, readers: usize) {
        let acknowledged = sent.saturating_sub(pending);
        self.readers = self.readers.max(readers);
        if pending == 0 || acknowledged > self.acknowledged || self.pending == 0 {
            if self.pending > 0 && now.saturating_sub(self.progress) >= SILENT {
                let messages = acknowledged.saturating_sub(self.acknowledged);
                self.suspect = Some(Suspect { messages, readers: self.readers, until: now + REMOVAL });
            }
            (self.progress, self.readers) = (now, readers);
        }
        (self.pending, self.acknowledged) = (pending, acknowledged);
        if let Some(suspect) = &self.suspect {
            if readers < suspect.readers {
                self.abandoned += suspect.messages;
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

    /// Number of messages that a subscriber had not acknowledged when it was removed without a word.
    pub(super) fn abandoned(&self) -> u64 {
        self.abandoned
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SECOND: Duration = Duration::from_secs(1);

    #[test]
    fn a_topic_is_stuck_after_ten_seconds_without_an_acknowledgement() {
        let mut watch = Watch::default();
        watch.look(5 * SECOND, 0, 0, 1);
        watch.look(9 * SECOND, 100, 100, 1);
        assert!(!watch.is_stuck(18 * SECOND) && !watch.is_settled());
        watch.look(18 * SECOND, 200, 199, 1);
        assert!(!watch.is_stuck(27 * SECOND), "one was acknowledged");
        assert!(watch.is_stuck(28 * SECOND));
        watch.look(29 * SECOND, 200, 0, 1);
        assert!(!watch.is_stuck(99 * SECOND));
    }

    #[test]
    fn messages_of_a_subscriber_that_is_removed_after_a_silence_are_not_acknowledged() {
        let after = |silence: Duration, readers: [usize; 2]| {
            let mut watch = Watch::default();
            watch.look(SECOND, 0, 0, 2);
            watch.look(SECOND, 50, 50, 2);
            let end = SECOND + silence;
            watch.look(end, 60, 60, 2);
            // The other subscriber has acknowledged all but two. The graph may know of the removal a little later.
            watch.look(end, 60, 2, readers[0]);
            watch.look(end + REMOVAL / 2, 60, 0, readers[1]);
            watch.look(end + 2 * REMOVAL, 60, 0, readers[1]);
            assert!(watch.is_settled());
            watch.abandoned()
        };
        assert_eq!(after(9 * SECOND, [2, 1]), 58);
        assert_eq!(after(9 * SECOND, [1, 1]), 58);
        assert_eq!(after(9 * SECOND, [2, 2]), 0, "it was slow, and is there");
        assert_eq!(after(SECOND, [2, 1]), 0, "it left");
    }
}
