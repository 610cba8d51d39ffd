//! Waits until the subscribers of a playback have acknowledged its messages.

use super::publisher::TopicPublishers;
use grainlab_console::{Failure, count, say};
use grainlab_node_kit::{Bus, DdsBus, Delivery, Wake};
use std::time::Duration;

/// Pause between two looks at the acknowledgements.
const LOOK: Duration = Duration::from_millis(10);

/// Waits until every subscriber has acknowledged all messages, or none of a topic for [`Delivery::PATIENCE`]; false on a signal.
pub(super) fn wait(bus: &mut DdsBus, publishers: &mut TopicPublishers) -> Result<bool, Failure> {
    loop {
        let (mut settled, mut stuck) = (true, true);
        for publisher in publishers.values_mut() {
            // A wait returns at once while the answers to messages in parts are not taken.
            publisher.advance(bus)?;
            publisher.look(bus);
            let is_settled = publisher.watch().is_settled();
            settled &= is_settled;
            stuck &= is_settled || publisher.watch().is_stuck(bus.now());
        }
        if settled || stuck {
            return Ok(true);
        }
        if bus.wait(LOOK) == Wake::Shutdown {
            return Ok(false);
        }
    }
}

/// Says which topics have messages that a subscriber did not acknowledge; true if there are none. A subscriber may have received some
/// of them. The counts are from the last look: a stuck subscriber may have been removed since, without having received any.
pub(super) fn report(publishers: &TopicPublishers) -> bool {
    let mut complete = true;
    for publisher in publishers.values() {
        let (pending, name) = (publisher.watch().pending(), publisher.name());
        let sent = count(publisher.sent(), "message");
        if pending > 0 {
            complete = false;
            say!(
                "grainlab: {name}: {pending} of {sent} not acknowledged: a subscriber has acknowledged none of them for {} s, so it \
                 may lack them; the subscriber was stopped, or ended without leaving",
                Delivery::PATIENCE.as_secs()
            );
        }
        if let Some(abandoned) = publisher.watch().abandoned(publisher.sent()) {
            complete = false;
            say!(
                "grainlab: {name}: {abandoned} of {sent} not acknowledged by a subscriber that was stopped, or ended without leaving"
            );
        }
        let left_behind = publisher.left_behind();
        if left_behind > 0 {
            complete = false;
            say!(
                "grainlab: {name}: {} not acknowledged by every subscriber: the warnings above name the subscribers",
                count(left_behind, "large message")
            );
        }
    }
    complete
}
