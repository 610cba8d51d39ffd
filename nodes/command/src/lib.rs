//! The command line of `grainlab`: every node, the launcher and the tools as subcommands. The binary is one caller, and Python the other.
//!
//! - `cli`: the command line, [`main`]
//! - `commands`: one module per command, with the checks of its arguments
//! - [`in_memory`]: commands on data in memory
//! - `memory`: settings of the allocator
//! - `offline_recording`: a recording of the messages that a node would publish
//! - `ros2`: words of the command line of ROS 2
//! - `viewers`: the nodes of the studio

mod cli;
mod commands;
pub mod in_memory;
mod memory;
mod offline_recording;
mod ros2;
mod viewers;

pub use cli::main;
