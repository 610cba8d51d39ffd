//! The command `grainlab node`.

mod info;
mod state;

pub(crate) use info::find;

use crate::names::is_hidden;
use crate::view::Common;
use clap::Subcommand;
use grainlab_console::Failure;
use grainlab_node_kit::Exit;

/// Commands about nodes.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// List the nodes of the domain.
    #[command(after_help = "Example:\n  grainlab node list --format json")]
    List(Common),
    /// Show the publishers, subscriptions and services of a node.
    #[command(after_help = "Example:\n  grainlab node info /dem_simulator")]
    Info {
        /// Fully qualified name of the node
        node: String,
        /// Format of the output and time limit.
        #[command(flatten)]
        common: Common,
    },
    /// Show what each node does or waits for, by its latest report.
    #[command(
        after_help = "Example:\n  grainlab node state --format json\n\nListens to the reports on /diagnostics for 2.5 s, of nodes that send none for 15 s. Exit 1 \
                      if a node reports an error, or does not report."
    )]
    State(Common),
}

/// Runs the command.
///
/// # Errors
/// With the exit code and the message for the user.
pub fn run(command: &Command) -> Result<Exit, Failure> {
    match command {
        Command::List(common) => {
            let nodes = common.graph()?.nodes.into_iter();
            let names: Vec<String> = nodes.map(|node| node.name).filter(|name| !is_hidden(name)).collect();
            common.show(&names, || names.iter().map(|name| format!("{name}\n")).collect())
        }
        Command::Info { node, common } => info::run(node, common),
        Command::State(common) => state::run(common),
    }
}
