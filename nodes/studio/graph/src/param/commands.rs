//! The commands of `grainlab param`.

use super::client::Client;
use super::value::{parse, to_json, to_yaml};
use crate::view::Common;
use grainlab_console::Failure;
use grainlab_node_kit::Exit;
use ros2_client::ParameterValue;
use serde_json::json;
use std::collections::BTreeMap;

pub(super) fn list(node: Option<&str>, common: &Common) -> Result<Exit, Failure> {
    let (mut client, nodes) = match node {
        Some(node) => Client::of(common, node).map(|(client, name)| (client, vec![name]))?,
        None => {
            let client = Client::new(common, |_| false)?;
            let all: Vec<String> = client.graph.nodes.iter().map(|n| n.name.clone()).collect();
            let nodes = all.into_iter().filter(|node| client.has_parameters(node)).collect();
            (client, nodes)
        }
    };
    let mut found: BTreeMap<String, Vec<String>> = BTreeMap::new();
    for node in nodes {
        let names = client.list(&node)?;
        found.insert(node, names);
    }
    common.show(&found, || {
        let of_node = |(node, names): (&String, &Vec<String>)| {
            let lines: String = names.iter().map(|name| format!("  {name}\n")).collect();
            format!("{node}:\n{lines}")
        };
        found.iter().map(of_node).collect()
    })
}

pub(super) fn get(node: &str, parameter: &str, common: &Common) -> Result<Exit, Failure> {
    let (mut client, node) = Client::of(common, node)?;
    let values = client.get(&node, &[parameter.to_owned()])?;
    match values.first() {
        None | Some(ParameterValue::NotSet) => {
            let known = client.list(&node)?.join(", ");
            Err(Failure::failed(format!("{node} has no parameter {parameter:?}; it has: {known}")))
        }
        Some(value) => common.show(&to_json(value), || format!("{}\n", to_yaml(value))),
    }
}

pub(super) fn set(node: &str, parameter: &str, value: &str, common: &Common) -> Result<Exit, Failure> {
    let value = parse(value)?;
    let (mut client, node) = Client::of(common, node)?;
    let result = client.set(&node, parameter, value)?;
    if !result.successful {
        return Err(Failure::failed(format!("{node} refuses it: {}", result.reason)));
    }
    common.show(&json!({ "successful": true }), || format!("{parameter} set\n"))
}
