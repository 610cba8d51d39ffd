//! A node as a state machine: it never sleeps, spawns or exits; it is stepped.

use crate::bus::Bus;
use crate::bus_error::BusError;
use crate::exit::Exit;
use crate::peers::Peers;
use std::time::Duration;

/// What a node wants after a step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Next {
    /// Another step at once.
    Again,
    /// A step when something arrives, or after this time at the latest.
    Wait(Duration),
    /// Nothing more: leave with this exit.
    Finished(Exit),
}

/// Why a node cannot go on.
#[derive(Debug, thiserror::Error)]
pub enum NodeError {
    /// The bus failed.
    #[error(transparent)]
    Bus(#[from] BusError),
    /// Anything else, with the exit code it means.
    #[error("{message}")]
    Failed {
        /// How the process ends.
        exit: Exit,
        /// What happened, where, and what to do.
        message: String,
    },
}

impl NodeError {
    /// An error that ends the process with `exit`.
    pub fn new(exit: Exit, message: impl Into<String>) -> Self {
        Self::Failed { exit, message: message.into() }
    }

    /// How the process ends.
    pub fn exit(&self) -> Exit {
        match self {
            Self::Bus(BusError::Name(_)) => Exit::Usage,
            Self::Bus(_) => Exit::Failure,
            Self::Failed { exit, .. } => *exit,
        }
    }
}

/// A node: decode, compute, encode. It takes everything that arrived in each step; what it leaves untaken ends the next
/// wait at once.
pub trait Node {
    /// One step: takes what arrived, publishes what follows from it. May compute for long.
    fn step(&mut self, bus: &mut dyn Bus) -> Result<Next, NodeError>;

    /// How the node is; asked for once a second.
    fn health(&self) -> Health;

    /// The peers, whenever one of them was heard. A node that waits for a partner finds here whether it lives.
    fn on_peers(&mut self, _peers: &Peers) {}

    /// The user or the launcher asks to end: publish what is final, and say how it ends. [`Exit::Interrupted`] if the
    /// result is incomplete.
    fn on_shutdown(&mut self, _bus: &mut dyn Bus) -> Result<Exit, NodeError> {
        Ok(Exit::Done)
    }
}
