//! Steps several nodes in one thread, in a fixed order and in virtual time.

use super::bus::MemoryBus;
use super::hub::Hub;
use crate::node::{Next, Node, NodeError};
use grainlab_msgs::Exit;
use std::time::Duration;

/// One node on its bus.
pub struct Actor {
    /// The node.
    pub node: Box<dyn Node>,
    /// Bus of the node.
    pub bus: MemoryBus,
    /// Latest time of its next step.
    due: Duration,
    /// Exit of the node, if it has ended.
    pub ended: Option<Result<Exit, NodeError>>,
}

impl Actor {
    /// A node that was made on `bus`.
    pub fn new(node: Box<dyn Node>, bus: MemoryBus) -> Self {
        Self { node, bus, due: Duration::ZERO, ended: None }
    }

    /// Returns the time of the next step, which is past or `now` if a sample has arrived or the waiting time is over; `None` if the
    /// node has ended.
    pub fn next_step(&self, now: Duration) -> Option<Duration> {
        let due = if self.bus.has_data() { now } else { self.due };
        self.ended.is_none().then_some(due)
    }

    /// Steps the node if its next step is due; true if it was stepped.
    pub fn step(&mut self, now: Duration) -> bool {
        let is_due = self.next_step(now).is_some_and(|due| due <= now);
        if is_due {
            match self.node.step(&mut self.bus) {
                Ok(Next::Again) => self.due = now,
                Ok(Next::Wait(time)) => self.due = now.saturating_add(time),
                Ok(Next::Finished(exit)) => self.ended = Some(Ok(exit)),
                Err(error) => self.ended = Some(Err(error)),
            }
        }
        is_due
    }
}

/// Steps all actors in turn until `done`, until all ended, or until virtual time `limit`; true in the first case. Time advances only
/// when no actor can step.
pub fn run_until(
    hub: &Hub,
    actors: &mut [Actor],
    limit: Duration,
    mut done: impl FnMut(&mut [Actor]) -> bool,
) -> bool {
    loop {
        let now = hub.now();
        // Every node is stepped, also after the first that was.
        let stepped = actors.iter_mut().fold(false, |any, actor| actor.step(now) | any);
        if done(actors) {
            return true;
        }
        if stepped {
            continue;
        }
        let waiting = actors.iter().filter_map(|actor| actor.next_step(now)).min();
        let next = waiting.into_iter().chain(hub.next_arrival()).min();
        match next {
            Some(next) if waiting.is_some() && next <= limit => hub.advance(next.saturating_sub(now)),
            _ => return false,
        }
    }
}
