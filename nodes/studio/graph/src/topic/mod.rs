//! The command `grainlab topic`.

mod echo;
mod hz;
mod info;
mod list;
mod listen;
mod publish;
mod qos;
mod stream;

use crate::view::Common;
use clap::Subcommand;
use grainlab_console::Failure;
use grainlab_node_kit::Exit;

/// Commands about topics.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// List the topics of the domain.
    List(list::Args),
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
    /// Publish messages of any type whose definition is known.
    Pub(publish::Args),
    /// Measure the rate of a topic, and what was lost.
    Hz(hz::Args),
}

/// Runs the command.
///
/// # Errors
/// With the exit code and the message for the user.
pub fn run(command: &Command) -> Result<Exit, Failure> {
    match command {
        Command::List(args) => list::run(args),
        Command::Info { topic, common } => info::run(topic, common),
        Command::Pub(args) => publish::run(args),
        Command::Echo(args) => echo::run(args),
        Command::Hz(args) => hz::run(args),
    }
}
