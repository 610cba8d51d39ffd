//! `grainlab node info`.

use crate::graph::{Endpoint, Graph, NodeEntry};
use crate::names::{RosName, absolute};
use crate::observer::Observer;
use crate::view::Common;
use grainlab_console::Failure;
use grainlab_node_kit::Exit;
use serde::Serialize;
use std::collections::BTreeMap;

/// Arguments of `grainlab node info`.
#[derive(Debug, clap::Args)]
#[command(after_help = "Example:\n  grainlab node info /dem_simulator")]
pub struct Args {
    /// Fully qualified name of the node
    node: String,
    #[command(flatten)]
    common: Common,
}

/// Names and types.
type Names = BTreeMap<String, String>;

#[derive(Serialize)]
struct View {
    name: String,
    publishers: Names,
    subscriptions: Names,
    service_servers: Names,
    service_clients: Names,
}

impl View {
    fn of(graph: &Graph, node: &NodeEntry) -> Self {
        let endpoints = graph.endpoints_of(node);
        let names = |pick: &dyn Fn(&Endpoint) -> Option<&String>| -> Names {
            let pair = |e: &&Endpoint| Some((pick(e)?.clone(), e.type_name.clone()));
            endpoints.iter().filter_map(pair).collect()
        };
        let topic = |writes: bool| {
            names(&move |e| match &e.name {
                RosName::Topic(name) if e.writes == writes => Some(name),
                _ => None,
            })
        };
        let request = |writes: bool| {
            names(&move |e| match &e.name {
                RosName::Request(name) if e.writes == writes => Some(name),
                _ => None,
            })
        };
        Self {
            name: node.name.clone(),
            publishers: topic(true),
            subscriptions: topic(false),
            service_servers: request(false),
            service_clients: request(true),
        }
    }

    fn text(&self) -> String {
        let section = |title: &str, names: &Names| {
            let lines: String = names.iter().map(|(name, kind)| format!("    {name}: {kind}\n")).collect();
            format!("  {title}:\n{lines}")
        };
        format!(
            "{}\n{}{}{}{}",
            self.name,
            section("Subscribers", &self.subscriptions),
            section("Publishers", &self.publishers),
            section("Service Servers", &self.service_servers),
            section("Service Clients", &self.service_clients),
        )
    }
}

pub(super) fn run(args: &Args) -> Result<Exit, Failure> {
    let graph = Observer::join()?.settled(args.common.patience());
    let node = find(&graph, &args.node)?;
    let view = View::of(&graph, node);
    args.common.show(&view, || view.text())?;
    Ok(Exit::Done)
}

/// The node of this name.
///
/// # Errors
/// With the names of all nodes, if none has it.
pub(crate) fn find<'a>(graph: &'a Graph, name: &str) -> Result<&'a NodeEntry, Failure> {
    let name = absolute(name);
    graph.nodes.iter().find(|n| n.name == name).ok_or_else(|| {
        let known: Vec<&str> = graph.nodes.iter().map(|n| n.name.as_str()).collect();
        let list = if known.is_empty() { "none".to_owned() } else { known.join(", ") };
        Failure::failed(format!("no node {name} in this domain (ROS_DOMAIN_ID); nodes are: {list}"))
    })
}
