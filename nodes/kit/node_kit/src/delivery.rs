//! Whether the readers of a publisher make progress.

use std::time::Duration;

/// The acknowledgements that a publisher waits for.
#[derive(Clone, Copy, Debug)]
pub struct Delivery {
    pending: u64,
    /// Time of the last acknowledgement, or of the beginning.
    progress: Duration,
}

impl Delivery {
    /// Longest time without any acknowledgement for which readers are waited for. An active one acknowledges within
    /// milliseconds, and one on a busy host within a second or two.
    pub const PATIENCE: Duration = Duration::from_secs(10);

    /// Begins to wait at `now` for the acknowledgement of `pending` messages: see
    /// [`DdsBus::unacknowledged`](crate::DdsBus::unacknowledged).
    pub fn begin(pending: u64, now: Duration) -> Self {
        Self { pending, progress: now }
    }

    /// Returns true if messages are pending at `now`, and no message was acknowledged for [`Self::PATIENCE`].
    pub fn is_stuck(&mut self, pending: u64, now: Duration) -> bool {
        if pending < self.pending || pending == 0 {
            self.progress = now;
        }
        self.pending = pending;
        now.saturating_sub(self.progress) >= Self::PATIENCE
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_publisher_waits_as_long_as_messages_are_acknowledged_and_ten_seconds_more() {
        let at = Duration::from_secs;
        let mut delivery = Delivery::begin(100, at(0));
        assert!(!delivery.is_stuck(100, at(9)));
        assert!(!delivery.is_stuck(99, at(11)), "one more was acknowledged");
        assert!(!delivery.is_stuck(99, at(20)));
        assert!(delivery.is_stuck(99, at(21)));
        assert!(!delivery.is_stuck(0, at(60)), "nothing is pending");
    }
}
