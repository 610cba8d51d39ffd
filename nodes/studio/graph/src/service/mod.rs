//! The command `grainlab service`.

mod calls;

use crate::names::{absolute, unknown};
use crate::view::{Common, Listing};
use clap::Subcommand;
use grainlab_console::{Failure, Table};
use grainlab_node_kit::Exit;
use serde::Serialize;

/// Commands about services.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// List the services of the domain.
    #[command(after_help = "Example:\n  grainlab service list --types")]
    List(Listing),
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
        /// Format of the list.
        #[command(flatten)]
        listing: Listing,
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
        Command::List(listing) => list(listing, None),
        Command::Type { service, common } => {
            let name = absolute(service);
            let graph = common.graph_with(|graph| graph.services().contains_key(name.as_str()))?;
            let services = graph.services();
            let found = services.get(name.as_str()).and_then(|servers| servers.first());
            let found = found.ok_or_else(|| unknown("service", &name, services.keys().copied()))?;
            common.show(&found.type_name, || format!("{}\n", found.type_name))
        }
        Command::Find { type_name, listing } => list(listing, Some(type_name)),
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

/// Lists the services, or those of a type.
fn list(listing: &Listing, type_name: Option<&str>) -> Result<Exit, Failure> {
    let graph = listing.common.graph()?;
    let row = |(name, servers): (&str, Vec<&crate::graph::Endpoint>)| Row {
        name: name.to_owned(),
        type_name: servers.first().map_or_else(String::new, |s| s.type_name.clone()),
        nodes: servers.iter().map(|s| graph.owner(s)).collect(),
    };
    let is_asked = |row: &Row| type_name.is_none_or(|name| row.type_name == name);
    let rows = graph.services().into_iter().map(row).filter(is_asked).collect();
    listing.print(
        rows,
        |row| &row.name,
        |rows| {
            let mut table = Table::new(["service", "type", "node"]);
            rows.iter().for_each(|r| table.row([r.name.clone(), r.type_name.clone(), r.nodes.join(", ")]));
            table.text()
        },
    )
}
