//! The command `grainlab service`.

mod calls;

use crate::view::Common;
use clap::Subcommand;
use grainlab_console::{Failure, Table};
use grainlab_node_kit::Exit;
use serde::Serialize;

/// Commands about services.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// List the services of the domain.
    #[command(after_help = "Example:\n  grainlab service list --types")]
    List {
        /// Print the types and the nodes
        #[arg(short = 't', long, visible_alias = "show-types")]
        types: bool,
        /// Format of the output and time limit.
        #[command(flatten)]
        common: Common,
    },
    /// Call a service of the parameters, or of the package std_srvs.
    Call(calls::Args),
}

/// Runs the command.
///
/// # Errors
/// With the exit code and the message for the user.
pub fn run(command: &Command) -> Result<Exit, Failure> {
    match command {
        Command::List { types, common } => list(*types, common),
        Command::Call(args) => calls::run(args),
    }
}

#[derive(Serialize)]
struct Row {
    name: String,
    #[serde(rename = "type")]
    type_name: String,
    nodes: Vec<String>,
}

fn list(types: bool, common: &Common) -> Result<Exit, Failure> {
    let graph = common.graph()?;
    let row = |(name, servers): (&str, Vec<&crate::graph::Endpoint>)| Row {
        name: name.to_owned(),
        type_name: servers.first().map_or_else(String::new, |s| s.type_name.clone()),
        nodes: servers.iter().map(|s| graph.owner(s)).collect(),
    };
    let rows: Vec<Row> = graph.services().into_iter().map(row).collect();
    common.show(&rows, || {
        if !types {
            return rows.iter().map(|r| format!("{}\n", r.name)).collect();
        }
        let mut table = Table::new(["service", "type", "node"]);
        rows.iter().for_each(|r| table.row([r.name.clone(), r.type_name.clone(), r.nodes.join(", ")]));
        table.text()
    })
}
