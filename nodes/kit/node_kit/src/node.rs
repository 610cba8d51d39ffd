//! A node as a state machine: it never sleeps, spawns threads or exits; the run loop steps it.

use crate::bus::Bus;
use crate::bus_error::BusError;
use crate::peers::Peers;
use grainlab_msgs::{Exit, Health};
use std::time::Duration;

/// What the run loop does after a step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Next {
    /// Step again at once.
    Again,
    /// Step when something arrives, or after this time at the latest.
    Wait(Duration),
    /// End with this exit.
    Finished(Exit),
}

/// Errors that end a node.
#[derive(Debug, thiserror::Error)]
pub enum NodeError {
    /// The bus failed.
    #[error(transparent)]
    Bus(#[from] BusError),
    /// Any other error, with its exit code.
    #[error("{message}")]
    Failed {
        /// The exit of the process.
        exit: Exit,
        /// The error, its place, and what to do.
        message: String,
    },
}

impl NodeError {
    /// An error that ends the process with `exit`.
    pub fn new(exit: Exit, message: impl Into<String>) -> Self {
        Self::Failed { exit, message: message.into() }
    }

    /// The exit of the process.
    pub fn exit(&self) -> Exit {
        match self {
            Self::Bus(BusError::Name(_)) => Exit::Usage,
            Self::Bus(_) => Exit::Failure,
            Self::Failed { exit, .. } => *exit,
        }
    }
}

/// A node: decode, compute, encode. In each step it takes all samples that arrived; a sample left untaken ends the next
/// wait at once.
pub trait Node {
    /// One step: takes what arrived and publishes the results. May compute for long.
    fn step(&mut self, bus: &mut dyn Bus) -> Result<Next, NodeError>;

    /// The state of the node; called once a second.
    fn health(&self) -> Health;

    /// The known peers; called whenever a heartbeat arrives. A node that waits for another one finds its state here.
    fn on_peers(&mut self, _peers: &Peers) {}

    /// Called when the user or the launcher stops the node: publishes final results and returns the exit.
    /// [`Exit::Interrupted`] if the result is incomplete.
    fn on_shutdown(&mut self, _bus: &mut dyn Bus) -> Result<Exit, NodeError> {
        Ok(Exit::Done)
    }
}
