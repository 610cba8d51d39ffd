//! The command `grainlab topic`.

mod echo;
mod hz;
mod info;
mod list;
mod listen;
mod publish;
mod qos;
mod stream;

use crate::view::{Common, Listing};
use clap::Subcommand;
use grainlab_console::Failure;
use grainlab_node_kit::Exit;

/// Commands about topics.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// List the topics of the domain.
    #[command(after_help = "Example:\n  grainlab topic list --types")]
    List(Listing),
    /// Show the publishers and subscriptions of a topic, with their QoS.
    #[command(after_help = "Example:\n  grainlab topic info /stress")]
    Info {
        /// Name of the topic
        topic: String,
        /// Print the endpoints, which is always done
        #[arg(short, long)]
        verbose: bool,
        /// Format of the output and time limit.
        #[command(flatten)]
        common: Common,
    },
    /// Print the type of a topic.
    #[command(after_help = "Example:\n  grainlab topic type /stress")]
    Type {
        /// Name of the topic
        topic: String,
        /// Format of the output and time limit.
        #[command(flatten)]
        common: Common,
    },
    /// List the topics of a type.
    #[command(after_help = "Example:\n  grainlab topic find grainlab_msgs/msg/Stress")]
    Find {
        /// Name of the type, package/msg/Type
        #[arg(value_name = "TYPE")]
        type_name: String,
        /// Format of the list.
        #[command(flatten)]
        listing: Listing,
    },
    /// Print the messages of a topic, of any type whose definition is known.
    Echo(echo::Args),
    /// Publish messages of any type whose definition is known.
    Pub(publish::Args),
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
        Command::List(listing) => list::run(listing, None),
        Command::Info { topic, common, .. } => info::run(topic, false, common),
        Command::Type { topic, common } => info::run(topic, true, common),
        Command::Find { type_name, listing } => list::run(listing, Some(type_name)),
        Command::Pub(args) => publish::run(args),
        Command::Echo(args) => echo::run(args),
        Command::Hz(window) => hz::measure(window, hz::rate_line),
        Command::Bw(window) => hz::measure(window, hz::bandwidth_line),
        Command::Delay(window) => hz::measure(window, hz::delay_line),
    }
}
