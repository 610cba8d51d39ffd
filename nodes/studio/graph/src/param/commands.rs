//! The commands of `grainlab param`.

use super::client::Client;
use super::value::{parse, to_json, to_yaml, type_name};
use crate::view::Common;
use grainlab_console::{Failure, Table};
use grainlab_node_kit::{Exit, parameters_of_file};
use ros2_client::ParameterValue;
use serde_json::{Map, json};
use std::collections::BTreeMap;
use std::path::Path;

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

pub(super) fn load(node: &str, file: &Path, common: &Common) -> Result<Exit, Failure> {
    let (mut client, node) = Client::of(common, node)?;
    let given = parameters_of_file(file, &node).map_err(Failure::usage)?;
    if given.is_empty() {
        return Err(Failure::usage(format!("{} has no parameters of {node}", file.display())));
    }
    let (mut set, mut refused) = (Vec::new(), Vec::new());
    let names: Vec<String> = given.iter().map(|(name, _)| name.clone()).collect();
    // A value that the node has already is not set: most are read-only.
    let now = client.get(&node, &names)?;
    for ((name, value), now) in given.into_iter().zip(now) {
        if to_json(&value) != to_json(&now) {
            let result = client.set(&node, &name, value)?;
            match result.successful {
                true => set.push(name),
                false => refused.push(format!("{name}: {}", result.reason)),
            }
        }
    }
    if !refused.is_empty() {
        return Err(Failure::failed(format!("{node} refuses {}", refused.join("; "))));
    }
    common.show(&json!({ "set": set }), || match set.is_empty() {
        true => "every value is there already\n".to_owned(),
        false => set.iter().map(|name| format!("{name} set\n")).collect(),
    })
}

pub(super) fn describe(node: &str, parameters: &[String], common: &Common) -> Result<Exit, Failure> {
    let (mut client, node) = Client::of(common, node)?;
    let names = if parameters.is_empty() { client.list(&node)? } else { parameters.to_vec() };
    let found = client.describe(&node, &names)?;
    if let Some(unknown) = found.iter().find(|d| d.r#type == 0) {
        return Err(Failure::failed(format!("{node} has no parameter {:?}", unknown.name)));
    }
    common.show(&found, || {
        let mut table = Table::new(["parameter", "type", "settable", "meaning", "valid"]);
        for d in &found {
            let settable = if d.read_only { "no" } else { "yes" };
            let valid = d.additional_constraints.split("; read-only").next().unwrap_or("");
            let valid = if valid.starts_with("read-only") { "" } else { valid };
            table.row([&d.name, type_name(d.r#type), settable, &d.description, valid].map(str::to_owned));
        }
        table.text()
    })
}

pub(super) fn dump(node: &str, common: &Common) -> Result<Exit, Failure> {
    let (mut client, node) = Client::of(common, node)?;
    let names = client.list(&node)?;
    let values = client.get(&node, &names)?;
    let map: Map<_, _> = names.iter().cloned().zip(values.iter().map(to_json)).collect();
    common.show(&map, || {
        let lines: String =
            names.iter().zip(&values).map(|(n, v)| format!("    {n}: {}\n", to_yaml(v))).collect();
        format!("{node}:\n  ros__parameters:\n{lines}")
    })
}
