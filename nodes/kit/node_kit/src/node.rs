//! A node as a state machine: it never sleeps, spawns threads or exits; the run loop steps it.

use crate::bus::Bus;
use crate::bus_error::BusError;
use grainlab_msgs::{Exit, Health};
use std::time::Duration;

/// Next action of the run loop after a step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Next {
    /// Step again at once.
    Again,
    /// Step when something arrives, or after this time at the latest.
    Wait(Duration),
    /// End with this exit.
    Finished(Exit),
}

/// The failure that ends a node: the exit of the process, and the text of the error with its place and what to do.
pub use grainlab_console::Failure as NodeError;

impl From<BusError> for NodeError {
    fn from(error: BusError) -> Self {
        let exit = if matches!(error, BusError::Name(_)) { Exit::Usage } else { Exit::Failure };
        Self::new(exit, error)
    }
}

/// A node: decode, compute, encode. In each step it takes all samples that arrived; a sample left untaken ends the next
/// wait at once.
pub trait Node {
    /// One step: takes what arrived and publishes the results. May compute for long.
    fn step(&mut self, bus: &mut dyn Bus) -> Result<Next, NodeError>;

    /// The state of the node, good by default; called once a second.
    fn health(&self) -> Health {
        Health::default()
    }

    /// Called when the user or the launcher stops the node: publishes final results and returns the exit.
    /// [`Exit::Interrupted`] if the result is incomplete.
    fn on_shutdown(&mut self, _bus: &mut dyn Bus) -> Result<Exit, NodeError> {
        Ok(Exit::Done)
    }
}
