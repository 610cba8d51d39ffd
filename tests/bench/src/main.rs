//! `cargo run --release -p grainlab_bench`: cost and accuracy of the laboratory on this machine.
//!
//! A bench is one file with an `Args` and a `run`, and a variant of [`Command`].
//!
//! - `overview`: time against error of every method; `stiffness`, `acoustics`: those of one packing
//! - `engine`, `inversion`: runs of the engine and models of the inversion, for `overview`
//! - `row`, `output`, `plot`: rows of time against error, their table, CSV, JSON and figure
//! - `dem`, `faults`, `lockstep`: the other benches
//! - `packing`: the packings to measure; `cpu_time`: the clock; `numbers`: means and limits

mod acoustics;
mod cpu_time;
mod dem;
mod engine;
mod faults;
mod inversion;
mod lockstep;
mod numbers;
mod output;
mod overview;
mod packing;
mod plot;
mod row;
mod stiffness;

use clap::Parser;

/// Measure cost and accuracy on this machine.
#[derive(Debug, Parser)]
#[command(version)]
enum Command {
    /// Wave speeds of packings: time against error of dispersion and time of flight.
    Acoustics(acoustics::Args),
    /// The particle engine: particle-steps per second by size, threads, instruction set and features.
    Dem(dem::Args),
    /// Runs under all kinds of faults, each drawn from a seed: they end with the same results or with an
    /// error.
    Faults(faults::Args),
    /// One exchange of the lockstep between two processes, with a recorder and without.
    Lockstep(lockstep::Args),
    /// Time against error of every method and setting of the laboratory, in one table and one figure.
    Overview(overview::Args),
    /// The stiffness of a packing: time against error of every method and tolerance.
    Stiffness(stiffness::Args),
}

fn main() -> std::process::ExitCode {
    grainlab_console::memory::bound();
    let outcome = match Command::parse() {
        Command::Acoustics(args) => acoustics::run(&args),
        Command::Dem(args) => dem::run(&args),
        Command::Faults(args) => faults::run(&args),
        Command::Lockstep(args) => lockstep::run(&args),
        Command::Overview(args) => overview::run(&args),
        Command::Stiffness(args) => stiffness::run(&args),
    };
    let exit = outcome.unwrap_or_else(|failure| {
        grainlab_console::say!("grainlab: {failure}");
        failure.exit
    });
    exit.into()
}
