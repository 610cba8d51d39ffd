//! The launcher: starts the processes of a launch file and supervises them until the run is done.
//!
//! - [`child`]: one process, which ends with the launcher
//! - [`progress`]: a line for each phase
//! - [`pending_results`]: results of the last packing that are still pending; [`deadline`]: their time limits
//! - [`watch`]: the messages of the run
//! - [`stopped`]: processes stopped by a signal; [`time_limit`]: a time limit that does not count the time for
//!   which they are
//! - [`supervisor`]: restarts, and ends of processes that end the run; [`ending`]: the order in which processes end

pub(crate) mod child;
mod deadline;
mod ending;
mod pending_results;
pub(crate) mod plan;
mod progress;
mod stopped;
pub(crate) mod supervisor;
mod time_limit;
pub(crate) mod watch;

use grainlab_node_kit::RunId;

/// The run that a launcher starts.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Run {
    /// Its id.
    pub(crate) id: RunId,
    /// DDS domain.
    pub(crate) domain: u16,
}
