//! Steps several nodes in one thread, in a fixed order and in virtual time.

use super::bus::MemoryBus;
use super::hub::Hub;
use crate::node::{Next, Node, NodeError};
use grainlab_msgs::Exit;
use std::time::Duration;

/// One node on its bus.
pub struct Actor<'a> {
    node: &'a mut dyn Node,
    /// Bus of the node.
    pub bus: MemoryBus,
    /// Latest time of its next step.
    due: Duration,
    /// Exit of the node, if it has ended.
    pub ended: Option<Result<Exit, NodeError>>,
}

impl<'a> Actor<'a> {
    /// A node that was made on `bus`.
    pub fn new(node: &'a mut dyn Node, bus: MemoryBus) -> Self {
        Self { node, bus, due: Duration::ZERO, ended: None }
    }
}

/// Steps all actors in turn until `done`, until all ended, or until virtual time `limit`; true in the first case.
///
/// An actor is stepped when a sample arrived for it or its waiting time is over. Time advances only when no actor can
/// step.
pub fn run_until(
    hub: &Hub,
    actors: &mut [Actor],
    limit: Duration,
    mut done: impl FnMut(&mut [Actor]) -> bool,
) -> bool {
    loop {
        let now = hub.now();
        let mut stepped = false;
        for actor in actors.iter_mut() {
            if actor.ended.is_some() || (actor.due > now && !actor.bus.has_data()) {
                continue;
            }
            stepped = true;
            match actor.node.step(&mut actor.bus) {
                Ok(Next::Again) => actor.due = now,
                Ok(Next::Wait(time)) => actor.due = now + time,
                Ok(Next::Finished(exit)) => actor.ended = Some(Ok(exit)),
                Err(error) => actor.ended = Some(Err(error)),
            }
        }
        if done(actors) {
            return true;
        }
        if stepped {
            continue;
        }
        let waiting = actors.iter().filter(|a| a.ended.is_none()).map(|a| a.due).min();
        let next = waiting.into_iter().chain(hub.next_arrival()).min();
        match next {
            Some(next) if waiting.is_some() && next <= limit => hub.advance(next.saturating_sub(now)),
            _ => return false,
        }
    }
}
