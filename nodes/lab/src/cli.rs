//! The command line.

use crate::commands::{analyze, bag, calibrate, campaign, invert, launch, probe, reproduce, run, scene};
use clap::{Parser, Subcommand};
use grainlab_bench as bench;
use grainlab_console::Failure;
use grainlab_graph::{doctor, node, param, service, topic};
use grainlab_node_kit::Exit;
use std::process::ExitCode;

/// Exit codes, shown by every help.
const EXIT_CODES: &str = "\
Exit codes: 0 done, 1 failure, 2 usage, scene or parameters, 3 done with data loss, 4 physics invalid, 130 interrupted.
Results go to stdout, everything else to stderr. All quantities are in SI units.";

/// A laboratory for granular packings: prepares them, measures them, and infers their microstructure.
///
/// Without a command, the demo scene is run: every node as its own process over DDS on this host, everything recorded.
#[derive(Debug, Parser)]
#[command(name = "grainlab", version, after_help = EXIT_CODES, arg_required_else_help = false)]
struct Cli {
    #[command(subcommand)]
    command: Option<Command>,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Run a scene: every node as its own process, recorded, measured, inverted. The default.
    Launch(launch::Args),
    /// Run many scenes: each a recorded run in a folder of its own, on this machine or a cluster.
    Campaign(campaign::Args),
    /// Reproduce the tables and figures of the paper: sixteen states, one page.
    Reproduce(reproduce::Args),
    /// List, show, check and create scenes: what a run simulates.
    #[command(subcommand)]
    Scene(scene::Command),
    /// Run one node as this process, with ROS 2 arguments.
    Run(run::Args),
    /// Record, play and inspect recordings.
    #[command(subcommand)]
    Bag(bag::Command),
    /// List and measure topics: rate, bandwidth, delay, publishers and subscriptions.
    #[command(subcommand)]
    Topic(topic::Command),
    /// List nodes, and what each publishes, subscribes to and serves.
    #[command(subcommand)]
    Node(node::Command),
    /// Read, describe and set parameters of running nodes.
    #[command(subcommand)]
    Param(param::Command),
    /// List and call services.
    #[command(subcommand)]
    Service(service::Command),
    /// Find what keeps nodes from working together: QoS, types, names, network.
    Doctor(doctor::Args),
    /// Infer the microstructure from moduli: coordination and anisotropy with uncertainty.
    Invert(invert::Args),
    /// Learn the constants of the models from measured packings.
    Calibrate(calibrate::Args),
    /// Measure packings from files: structure, stress and the full stiffness.
    Analyze(analyze::Args),
    /// Send waves through packings from files: their speeds, and the moduli that follow.
    Probe(probe::Args),
    /// Measure cost and accuracy on this machine.
    #[command(subcommand)]
    Bench(bench::Command),
}

/// Parses, runs, reports.
pub(crate) fn main() -> ExitCode {
    let cli = Cli::parse();
    let outcome = match cli.command {
        None => launch::run(&launch::Args::default()),
        Some(Command::Launch(args)) => launch::run(&args),
        Some(Command::Campaign(args)) => campaign::run(&args),
        Some(Command::Reproduce(args)) => reproduce::run(&args),
        Some(Command::Scene(command)) => scene::run(&command),
        Some(Command::Run(args)) => run::run(&args),
        Some(Command::Bag(command)) => bag::run(&command),
        Some(Command::Topic(command)) => topic::run(&command),
        Some(Command::Node(command)) => node::run(&command),
        Some(Command::Param(command)) => param::run(&command),
        Some(Command::Service(command)) => service::run(&command),
        Some(Command::Doctor(args)) => doctor::run(&args),
        Some(Command::Invert(args)) => invert::run(&args),
        Some(Command::Calibrate(args)) => calibrate::run(&args),
        Some(Command::Analyze(args)) => analyze::run(&args),
        Some(Command::Probe(args)) => probe::run(&args),
        Some(Command::Bench(command)) => bench::run(&command),
    };
    match outcome {
        Ok(exit) => exit.into(),
        Err(failure) => report(&failure).into(),
    }
}

fn report(failure: &Failure) -> Exit {
    grainlab_console::say!("grainlab: {failure}");
    failure.exit
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    #[test]
    fn no_two_flags_of_a_command_have_one_name() {
        Cli::command().debug_assert();
    }
}
