//! Runs several nodes of one process in one thread, over the bus in memory and in real time.
//!
//! Nodes are stepped in the order of the launch file, each when a sample has arrived or its waiting time is over. Long
//! computations run on the threads of a [`crate::Worker`].

use crate::bus::Bus;
use crate::housekeeping::{DriveError, Housekeeping};
use crate::logging::Logger;
use crate::memory::{Hub, MemoryBus};
use crate::node::{Next, Node, NodeError};
use grainlab_msgs::Exit;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::time::Duration;

/// One node of several in this process.
pub struct Component {
    name: String,
    node: Box<dyn Node>,
    bus: MemoryBus,
    housekeeping: Housekeeping,
    logger: &'static Logger,
    /// Latest time of its next step.
    due: Duration,
    exit: Option<Exit>,
}

impl Component {
    /// A node that `build` makes on `bus`; its log lines go to `logger`. `name` is fully qualified.
    ///
    /// # Errors
    /// That of `build`, which is logged, too.
    pub fn new(
        mut bus: MemoryBus,
        name: String,
        logger: &'static Logger,
        build: impl FnOnce(&mut dyn Bus) -> Result<Box<dyn Node>, NodeError>,
    ) -> Result<Self, NodeError> {
        logger.enter();
        let node = build(&mut bus).inspect_err(|error| log::error!("{error}"))?;
        let housekeeping = Housekeeping::new(&mut bus, &name, Some(logger))?;
        Ok(Self { name, node, bus, housekeeping, logger, due: Duration::ZERO, exit: None })
    }

    /// The exit of a node that has ended.
    pub fn exit(&self) -> Option<Exit> {
        self.exit
    }

    /// Steps the node if it is due; false if it is not, or has ended.
    fn step(&mut self, now: Duration) -> bool {
        if self.exit.is_some() || (self.due > now && !self.bus.has_data()) {
            return false;
        }
        let next = self.guarded(|this| {
            let until_beat = this.housekeeping.tend(this.node.as_mut(), &mut this.bus)?;
            Ok(match this.node.step(&mut this.bus) {
                Ok(Next::Wait(time)) => Ok(now + time.min(until_beat)),
                Ok(Next::Again) => Ok(now),
                Ok(Next::Finished(exit)) => Err(exit),
                Err(error) => Err(failed(&error)),
            })
        });
        match next {
            Ok(due) => self.due = due,
            Err(exit) => self.leave(exit),
        }
        true
    }

    /// Ends a node that has not ended, as on a request to stop, and returns its exit.
    pub fn end(&mut self) -> Exit {
        if self.exit.is_none() {
            let ended = self.guarded(|this| {
                log::info!("stopping on request");
                Ok(this.node.on_shutdown(&mut this.bus).map_err(|error| failed(&error)))
            });
            self.leave(ended.unwrap_or_else(|exit| exit));
        }
        self.exit.unwrap_or(Exit::Failure)
    }

    /// Runs a part of the node; a panic and a failed bus end it with exit 1.
    fn guarded<T>(
        &mut self,
        part: impl FnOnce(&mut Self) -> Result<Result<T, Exit>, DriveError>,
    ) -> Result<T, Exit> {
        self.logger.enter();
        match catch_unwind(AssertUnwindSafe(|| part(self))) {
            Ok(Ok(done)) => done,
            Ok(Err(error)) => {
                log::error!("{error}");
                Err(Exit::Failure)
            }
            Err(panic) => {
                let text = panic.downcast_ref::<String>().map(String::as_str);
                let text = text.or(panic.downcast_ref::<&str>().copied()).unwrap_or("no text");
                log::error!("{} panicked: {text}; this is a bug", self.name);
                Err(Exit::Failure)
            }
        }
    }

    fn leave(&mut self, exit: Exit) {
        self.exit = Some(exit);
        if let Err(error) = self.housekeeping.leave(self.node.as_ref(), &mut self.bus, exit) {
            log::error!("{error}");
        }
    }
}

fn failed(error: &NodeError) -> Exit {
    log::error!("{error}");
    error.exit
}

/// Steps every node that is due, and all once a worker has a result. If none is, waits until then, until one is due, the user asks
/// to stop, or for 50 ms.
pub fn step_all(hub: &Hub, components: &mut [Component]) {
    if hub.was_called() {
        components.iter_mut().for_each(|c| c.due = Duration::ZERO);
    }
    // Every node is stepped, also after the first that was.
    let now = hub.now();
    let stepped = components.iter_mut().fold(false, |any, component| component.step(now) | any);
    if !stepped {
        let due = components.iter().filter(|c| c.exit.is_none()).map(|c| c.due).min();
        hub.wait(due.map_or(Duration::MAX, |due| due.saturating_sub(now)));
    }
}
