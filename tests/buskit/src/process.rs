//! One process of a run, which may crash and be restarted.

use crate::bench::{Bench, Kind};
use grainlab_node_kit::{Actor, NodeError};
use std::time::Duration;

/// A node running on its bus.
pub(crate) struct Process {
    pub(crate) kind: Kind,
    /// `None` between a crash and the restart.
    pub(crate) running: Option<Actor>,
    /// Earliest time of its next step.
    pub(crate) stopped_until: Duration,
    /// Time of its restart after a crash.
    pub(crate) restart_at: Option<Duration>,
}

impl Process {
    pub(crate) fn start(kind: Kind, bench: &Bench) -> Result<Self, NodeError> {
        Ok(Self { kind, running: Some(bench.start(kind)?), stopped_until: Duration::ZERO, restart_at: None })
    }
}
