//! `grainlab topic`.

mod echo;
mod hz;
mod info;
mod list;
mod listen;
mod stream;

use clap::Subcommand;
use grainlab_console::Failure;
use grainlab_node_kit::Exit;

/// What to do with topics.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// List the topics of the domain.
    List(list::Args),
    /// Show the publishers and subscriptions of a topic, with their QoS.
    Info(info::Args),
    /// Print the messages of a topic, of any type whose definition is known.
    Echo(echo::Args),
    /// Measure the rate of a topic, and what was lost.
    Hz(hz::RateArgs),
    /// Measure the bandwidth of a topic.
    Bw(hz::BandwidthArgs),
    /// Measure the time from a publisher to this process, and the age of header stamps.
    Delay(hz::DelayArgs),
}

/// Runs the command.
///
/// # Errors
/// With the exit code and the message for the user.
pub fn run(command: &Command) -> Result<Exit, Failure> {
    match command {
        Command::List(args) => list::run(args),
        Command::Info(args) => info::run(args),
        Command::Echo(args) => echo::run(args),
        Command::Hz(args) => hz::rate(args),
        Command::Bw(args) => hz::bandwidth(args),
        Command::Delay(args) => hz::delay(args),
    }
}
