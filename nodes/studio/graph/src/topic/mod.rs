//! The command `grainlab topic`.

mod echo;
mod hz;
mod info;
mod list;
mod listen;
mod stream;

use crate::view::Common;
use clap::Subcommand;
use grainlab_console::Failure;
use grainlab_node_kit::Exit;

/// Commands about topics.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// List the topics of the domain.
    #[command(after_help = "Example:\n  grainlab topic list --types")]
    List {
        /// Print the types, and the numbers of publishers and subscriptions
        #[arg(short = 't', long, visible_alias = "show-types")]
        types: bool,
        /// Format of the output and time limit.
        #[command(flatten)]
        common: Common,
    },
    /// Show the publishers and subscriptions of a topic, with their QoS.
    #[command(after_help = "Example:\n  grainlab topic info /stress")]
    Info {
        /// Name of the topic
        topic: String,
        /// Format of the output and time limit.
        #[command(flatten)]
        common: Common,
    },
    /// Print the messages of a topic, of any type whose definition is known.
    Echo(echo::Args),
    /// Measure the rate of a topic, and what was lost.
    #[command(
        after_help = "Example:\n  grainlab topic hz /stress --duration 5\n\nThe rate follows from the publishers' sequence \
                      numbers and times: it is right even if this process\nreceives a part of the samples only."
    )]
    Hz(hz::Window),
    /// Measure the bandwidth of a topic.
    #[command(after_help = "Example:\n  grainlab topic bw /packing_chunk --duration 5")]
    Bw(hz::Window),
    /// Measure the time from a publisher to this process, and the age of header stamps.
    #[command(after_help = "Example:\n  grainlab topic delay /stress --duration 5")]
    Delay(hz::Window),
}

/// Runs the command.
///
/// # Errors
/// With the exit code and the message for the user.
pub fn run(command: &Command) -> Result<Exit, Failure> {
    match command {
        Command::List { types, common } => list::run(*types, common),
        Command::Info { topic, common } => info::run(topic, common),
        Command::Echo(args) => echo::run(args),
        Command::Hz(window) => hz::measure(window, hz::rate_line),
        Command::Bw(window) => hz::measure(window, hz::bandwidth_line),
        Command::Delay(window) => hz::measure(window, hz::delay_line),
    }
}
