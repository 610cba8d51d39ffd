//! The command `grainlab service`.

mod calls;

use crate::names::{absolute, unknown};
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
        /// Print their number only
        #[arg(short, long)]
        count_services: bool,
        /// Format of the output and time limit.
        #[command(flatten)]
        common: Common,
    },
    /// Print the type of a service.
    #[command(after_help = "Example:\n  grainlab service type /dem_simulator/get_parameters")]
    Type {
        /// Name of the service
        service: String,
        /// Format of the output and time limit.
        #[command(flatten)]
        common: Common,
    },
    /// List the services of a type.
    #[command(after_help = "Example:\n  grainlab service find rcl_interfaces/srv/GetParameters")]
    Find {
        /// Name of the type, package/srv/Type
        #[arg(value_name = "TYPE")]
        type_name: String,
        /// Print their number only
        #[arg(short, long)]
        count_services: bool,
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
        Command::List { types, count_services, common } => list(|_| true, *types, *count_services, common),
        Command::Type { service, common } => {
            let name = absolute(service);
            let graph = common.graph_with(|graph| graph.services().contains_key(name.as_str()))?;
            let services = graph.services();
            let found = services.get(name.as_str()).and_then(|servers| servers.first());
            let found = found.ok_or_else(|| unknown("service", &name, services.keys().copied()))?;
            common.show(&found.type_name, || format!("{}\n", found.type_name))
        }
        Command::Find { type_name, count_services, common } => {
            list(|row| row.type_name == *type_name, false, *count_services, common)
        }
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

fn list(is_asked: impl Fn(&Row) -> bool, types: bool, count: bool, common: &Common) -> Result<Exit, Failure> {
    let graph = common.graph()?;
    let row = |(name, servers): (&str, Vec<&crate::graph::Endpoint>)| Row {
        name: name.to_owned(),
        type_name: servers.first().map_or_else(String::new, |s| s.type_name.clone()),
        nodes: servers.iter().map(|s| graph.owner(s)).collect(),
    };
    let rows: Vec<Row> = graph.services().into_iter().map(row).filter(is_asked).collect();
    if count {
        return common.show(&rows.len(), || format!("{}\n", rows.len()));
    }
    common.show(&rows, || {
        if !types {
            return rows.iter().map(|r| format!("{}\n", r.name)).collect();
        }
        let mut table = Table::new(["service", "type", "node"]);
        rows.iter().for_each(|r| table.row([r.name.clone(), r.type_name.clone(), r.nodes.join(", ")]));
        table.text()
    })
}
