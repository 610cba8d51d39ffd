//! The roles of the processes of the measurement.

use clap::ValueEnum;

/// The role of one process of the measurement.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum Role {
    /// Sends requests over the bus of grainlab.
    Ping,
    /// Answers over the bus of grainlab.
    Pong,
}
