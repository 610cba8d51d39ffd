//! The `grainlab` binary: every node, the launcher and the tools as subcommands.
//!
//! - [`cli`]: the command line
//! - [`commands`]: one module per command, with the checks of its arguments
//! - [`memory`]: settings of the allocator
//! - [`offline_recording`]: a recording of the messages that a node would publish
//! - [`ros2`]: words of the command line of ROS 2
//! - [`viewers`]: the nodes of the studio

mod cli;
mod commands;
mod memory;
mod offline_recording;
mod ros2;
mod viewers;

fn main() -> std::process::ExitCode {
    memory::bound();
    cli::main()
}
