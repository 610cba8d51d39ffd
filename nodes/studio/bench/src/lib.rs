//! `grainlab bench`: cost and accuracy of the laboratory on this machine.
//!
//! A bench is one file with an `Args` and a `run`, and a variant of [`Command`].
//!
//! - `accuracy`, `acoustics`, `dem`, `faults`, `lockstep`, `stiffness`: the benches
//! - `overview`: time against error of all of them
//! - `packing`: the packings to measure; `cpu_time`: the clocks; `numbers`, `folder`: reports

mod accuracy;
mod acoustics;
mod cpu_time;
mod dem;
mod faults;
mod folder;
mod lockstep;
mod numbers;
mod overview;
mod packing;
mod stiffness;

use clap::Subcommand;
use grainlab_console::Failure;
use grainlab_node_kit::Exit;

/// The bench to run.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Time against error of every numerical setting, relative to a converged run, with the Pareto front.
    Accuracy(accuracy::Args),
    /// Wave speeds of a packing: time against error of dispersion and time of flight.
    Acoustics(acoustics::Args),
    /// The particle engine: particle-steps per second by size, threads, instruction set and features.
    Dem(dem::Args),
    /// Runs under all kinds of faults, each drawn from a seed: they end with the same results or with an
    /// error.
    Faults(faults::Args),
    /// One exchange of the lockstep between two processes, with a recorder, compared with bare ros2-client.
    Lockstep(lockstep::Args),
    /// Time against error of every method of the laboratory, in one table and one figure.
    Overview(overview::Args),
    /// The stiffness of a packing: time against error of every method and tolerance.
    Stiffness(stiffness::Args),
}

/// Runs the command.
///
/// # Errors
/// With the exit code and the message for the user.
pub fn run(command: &Command) -> Result<Exit, Failure> {
    match command {
        Command::Accuracy(args) => accuracy::run(args),
        Command::Acoustics(args) => acoustics::run(args),
        Command::Dem(args) => dem::run(args),
        Command::Faults(args) => faults::run(args),
        Command::Lockstep(args) => lockstep::run(args),
        Command::Overview(args) => overview::run(args),
        Command::Stiffness(args) => stiffness::run(args),
    }
}
