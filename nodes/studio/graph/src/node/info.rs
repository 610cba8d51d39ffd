//! `grainlab node info`.

use crate::graph::{Endpoint, Graph, NodeEntry};
use crate::names::{RosName, absolute, unknown};
use crate::view::Common;
use grainlab_console::Failure;
use grainlab_node_kit::Exit;
use serde::Serialize;
use std::collections::BTreeMap;

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
        let of = |requests: bool, writes: bool| {
            names(&move |e| match &e.name {
                RosName::Topic(name) if !requests && e.writes == writes => Some(name),
                RosName::Request(name) if requests && e.writes == writes => Some(name),
                _ => None,
            })
        };
        Self {
            name: node.name.clone(),
            publishers: of(false, true),
            subscriptions: of(false, false),
            service_servers: of(true, false),
            service_clients: of(true, true),
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

pub(super) fn run(node: &str, common: &Common) -> Result<Exit, Failure> {
    let graph = common.graph_with(|graph| find(graph, node).is_ok())?;
    let view = View::of(&graph, find(&graph, node)?);
    common.show(&view, || view.text())
}

/// Errors with the names of all nodes, if none has this one.
pub(crate) fn find<'a>(graph: &'a Graph, name: &str) -> Result<&'a NodeEntry, Failure> {
    let name = absolute(name);
    let known = || unknown("node", &name, graph.nodes.iter().map(|n| n.name.as_str()));
    graph.nodes.iter().find(|n| n.name == name).ok_or_else(known)
}
