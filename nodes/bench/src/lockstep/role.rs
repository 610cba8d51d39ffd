//! The parts that processes of the measurement take.

use clap::ValueEnum;

/// What one process of the measurement does.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum Role {
    /// Asks, over our bus.
    Ping,
    /// Answers, over our bus.
    Pong,
    /// Asks, over bare ros2-client.
    BarePing,
    /// Answers, over bare ros2-client.
    BarePong,
}
