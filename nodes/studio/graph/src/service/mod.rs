//! `grainlab service`.

mod calls;

use crate::observer::Observer;
use crate::view::Common;
use clap::Subcommand;
use grainlab_console::{Failure, Table};
use grainlab_node_kit::Exit;
use serde::Serialize;

/// What to do with services.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// List the services of the domain.
    List(ListArgs),
    /// Call a service of the parameters, or of the package std_srvs.
    Call(calls::Args),
}

/// Arguments of `grainlab service list`.
#[derive(Debug, clap::Args)]
#[command(after_help = "Example:\n  grainlab service list --types")]
pub struct ListArgs {
    /// Print the types and the nodes
    #[arg(short = 't', long, visible_alias = "show-types")]
    types: bool,
    #[command(flatten)]
    common: Common,
}

/// Runs the command.
///
/// # Errors
/// With the exit code and the message for the user.
pub fn run(command: &Command) -> Result<Exit, Failure> {
    match command {
        Command::List(args) => list(args),
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

fn list(args: &ListArgs) -> Result<Exit, Failure> {
    let graph = Observer::join()?.settled(args.common.patience());
    let row = |(name, servers): (&str, Vec<&crate::graph::Endpoint>)| Row {
        name: name.to_owned(),
        type_name: servers.first().map_or_else(String::new, |s| s.type_name.clone()),
        nodes: servers.iter().map(|s| graph.owner(s)).collect(),
    };
    let rows: Vec<Row> = graph.services().into_iter().map(row).collect();
    args.common.show(&rows, || {
        if !args.types {
            return rows.iter().map(|r| format!("{}\n", r.name)).collect();
        }
        let mut table = Table::new(["service", "type", "node"]);
        rows.iter().for_each(|r| table.row([r.name.clone(), r.type_name.clone(), r.nodes.join(", ")]));
        table.text()
    })?;
    Ok(Exit::Done)
}
