//! The launcher: a launch file becomes processes, which are watched until the run is done.
//!
//! - [`plan`]: launch files, the YAML form of ROS 2 launch
//! - [`child`]: one process, which cannot outlive this one
//! - [`progress`]: a line for each phase
//! - [`debts`]: what it still owes of its last packing
//! - [`watch`]: what the run says of itself over DDS
//! - [`supervisor`]: who is restarted, whose death ends the run, and in which order all end

pub(crate) mod child;
mod debts;
pub(crate) mod plan;
mod progress;
pub(crate) mod supervisor;
mod watch;
