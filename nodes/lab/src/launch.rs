//! The launcher: a launch file becomes processes, which are watched until the run is done.
//!
//! - [`plan`]: launch files, the YAML form of ROS 2 launch
//! - [`child`]: one process, which cannot outlive this one
//! - [`progress`]: a line for each phase
//! - [`debts`]: what is still to come about its last packing
//! - [`watch`]: what the run says of itself over DDS
//! - [`stopped`]: which processes are stopped by a signal; [`patience`]: how long something may take
//! - [`supervisor`]: who is restarted, whose death ends the run; [`ending`]: in which order all end

pub(crate) mod child;
mod deadline;
mod debts;
mod ending;
mod patience;
pub(crate) mod plan;
mod progress;
mod stopped;
pub(crate) mod supervisor;
pub(crate) mod watch;

use grainlab_node_kit::RunId;

/// The run that a launcher starts.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Run {
    /// Its id, made afresh.
    pub(crate) id: RunId,
    /// DDS domain.
    pub(crate) domain: u16,
}
