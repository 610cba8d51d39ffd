//! After the loading path: the last messages, and what the end of the process waits for.

use super::DemSimulator;
use crate::publication::{HOLD, flush_last_messages};
use grainlab_node_kit::{Bus, Exit, Next, NodeError};
use std::time::Duration;

impl DemSimulator {
    pub(super) fn wait_after_end(&mut self, bus: &mut dyn Bus) -> Result<Next, NodeError> {
        self.publication.deliver(bus)?;
        if !self.publication.queue().is_empty() {
            return Ok(Next::Wait(HOLD));
        }
        if self.settings.exit_when_finished && self.may_end(bus.now()) {
            flush_last_messages(bus);
            return Ok(Next::Finished(Exit::Done));
        }
        Ok(Next::Wait(self.publication.next_beat().saturating_sub(bus.now())))
    }

    /// True if the last packing is inverted, or has been awaited for long enough.
    fn may_end(&self, now: Duration) -> bool {
        let packings = self.publication.packings();
        let missing = self.inversions.missing(packings.last_step).filter(|_| packings.count > 0);
        let waited = now.saturating_sub(self.done.unwrap_or(now));
        let over = waited >= self.settings.inverted_within;
        if let Some(topic) = missing.filter(|_| over) {
            log::warn!(
                "the last packing was not inverted from its {topic} within {:.0} s of the end of the loading path \
                 (parameter inverted_within): the simulator ends",
                waited.as_secs_f64()
            );
        }
        missing.is_none() || over
    }
}
