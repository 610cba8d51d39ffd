//! `grainlab topic info`.

use crate::graph::{Endpoint, Graph, QosView};
use crate::names::{absolute, unknown};
use crate::view::Common;
use grainlab_console::{Failure, Table};
use grainlab_node_kit::Exit;
use serde::Serialize;

#[derive(Serialize)]
struct View {
    name: String,
    types: Vec<String>,
    endpoints: Vec<EndpointView>,
}

#[derive(Serialize)]
struct EndpointView {
    node: String,
    kind: &'static str,
    #[serde(rename = "type")]
    type_name: String,
    guid: String,
    #[serde(flatten)]
    qos: QosView,
}

fn view(graph: &Graph, endpoint: &Endpoint) -> EndpointView {
    EndpointView {
        node: graph.owner(endpoint),
        kind: if endpoint.writes { "publisher" } else { "subscription" },
        type_name: endpoint.type_name.clone(),
        guid: endpoint.guid.to_string(),
        qos: QosView::from(&endpoint.qos),
    }
}

pub(super) fn run(topic: &str, common: &Common) -> Result<Exit, Failure> {
    let name = absolute(topic);
    let graph = common.graph_with(|graph| graph.topics().contains_key(name.as_str()))?;
    let topics = graph.topics();
    let Some(topic) = topics.get(name.as_str()) else {
        return Err(unknown("topic", &name, topics.keys().copied()));
    };
    let types: Vec<String> = topic.types().into_iter().map(str::to_owned).collect();
    let shown = View { name, types, endpoints: topic.endpoints().map(|e| view(&graph, e)).collect() };
    common.show(&shown, || {
        let mut table = Table::new(["node", "kind", "reliability", "durability", "guid"]);
        for e in &shown.endpoints {
            table.row([&e.node, e.kind, e.qos.reliability, e.qos.durability, &e.guid].map(str::to_owned));
        }
        format!("{}: {}\n{}", shown.name, shown.types.join(" and "), table.text())
    })
}
