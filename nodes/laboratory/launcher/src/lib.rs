//! The launcher: starts the processes of a launch file and supervises them until the run is done.
//!
//! - `launch_file`: the YAML form of ROS 2 launch; `plan`: processes to start
//! - [`agreement`]: what the processes of a launch file must agree on
//! - `child`: one process, which ends with the launcher
//! - `progress`: a line for each phase; `phase_line`: that of a terminal; `said`: other lines
//! - `watch`: the messages of the run
//! - `stopped`: processes stopped by a signal; `time_limit`: a time limit that does not count the time for which they are
//! - `followed`: progress and end of a run by its messages; `one_process`: all nodes in this process
//! - `supervisor`: restarts, and ends of processes that end the run; `ending`: the order in which processes end
//! - `nodes`: every node of ours, and how it is started; [`last_packing`] and `recorded_speeds`: what a simulator continues from
//! - `without_run`: processes of a launch file that has no simulator
//! - [`pipe`]: ends a node whose launcher was killed

pub mod agreement;
mod child;
mod ending;
mod followed;
pub mod last_packing;
mod launch_file;
mod nodes;
mod one_process;
mod phase_line;
pub mod pipe;
mod plan;
mod progress;
mod recorded_speeds;
mod said;
mod stopped;
mod supervisor;
mod time_limit;
mod watch;
mod without_run;

pub use child::Run;
pub use followed::{Outline, Received};
pub use launch_file::{BUILT_IN, LaunchFile};
pub use nodes::NodeKind;
pub use one_process::{check_one_process, run_in_one_process};
pub use plan::NodePlan;
pub use supervisor::{Supervised, Supervisor};
pub use without_run::start_all;
