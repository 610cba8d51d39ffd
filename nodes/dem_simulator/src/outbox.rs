//! Messages in their order, none lost where a reader is behind.

use node_kit::{Bus, BusError, PublisherId};
use std::collections::VecDeque;

/// What is still to be published, in order.
#[derive(Debug, Default)]
pub(crate) struct Outbox {
    waiting: VecDeque<(PublisherId, Vec<u8>)>,
    held_up: u64,
}

impl Outbox {
    pub(crate) fn post(&mut self, publisher: PublisherId, body: Vec<u8>) {
        self.waiting.push_back((publisher, body));
    }

    /// Publishes what the bus takes; true if nothing is left. A reliable reader that is too far behind holds the rest up:
    /// the run waits for it rather than lose a sample.
    pub(crate) fn deliver(&mut self, bus: &mut dyn Bus) -> Result<bool, BusError> {
        while let Some((publisher, body)) = self.waiting.front() {
            match bus.publish(*publisher, body) {
                Ok(_) => drop(self.waiting.pop_front()),
                Err(full @ BusError::Full { .. }) => {
                    self.held_up += 1;
                    if self.held_up.is_power_of_two() {
                        log::warn!("the run waits ({} times so far): {full}", self.held_up);
                    }
                    return Ok(false);
                }
                Err(error) => return Err(error),
            }
        }
        Ok(true)
    }

    /// How often a reader held the run up.
    pub(crate) fn held_up(&self) -> u64 {
        self.held_up
    }
}
