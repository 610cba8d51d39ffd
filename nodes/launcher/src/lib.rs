//! The launcher: starts the processes of a launch file and supervises them until the run is done.
//!
//! - `child`: one process, which ends with the launcher
//! - `progress`: a line for each phase
//! - `pending_results`: results of the last packing that are still pending; `deadline`: their time limits
//! - `watch`: the messages of the run
//! - `stopped`: processes that are stopped by a signal; `patience`: a time limit that does not count those
//! - `supervisor`: restarts, and ends of processes that end the run; `ending`: the order in which processes end
//! - `nodes`: every node of ours, and how it is started; [`last_packing`]: what a simulator continues from
//! - [`pipe`]: ends a node whose launcher was killed

mod child;
mod deadline;
mod ending;
pub mod last_packing;
mod nodes;
mod patience;
mod pending_results;
pub mod pipe;
mod plan;
mod progress;
mod stopped;
mod supervisor;
mod watch;

pub use nodes::{NodeKind, UnknownNode};
pub use plan::{BUILT_IN, LaunchFile, NodePlan};
pub use supervisor::{Heard, Supervised, Supervisor};

use grainlab_node_kit::RunId;

/// The run that a launcher starts.
#[derive(Clone, Copy, Debug)]
pub struct Run {
    /// Its id.
    pub id: RunId,
    /// DDS domain.
    pub domain: u16,
}
