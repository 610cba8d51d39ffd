//! The commands of `grainlab param`.

use super::client::Client;
use super::value::{parse, to_json, to_yaml, type_name};
use crate::view::Common;
use grainlab_console::{Failure, Table, print};
use grainlab_node_kit::Exit;
use ros2_client::ParameterValue;
use serde_json::{Map, json};
use std::collections::BTreeMap;

/// Arguments of `grainlab param list`.
#[derive(Debug, clap::Args)]
#[command(after_help = "Example:\n  grainlab param list /dem_simulator")]
pub struct ListArgs {
    /// Name of the node [default: every node that has parameters]
    node: Option<String>,
    #[command(flatten)]
    common: Common,
}

/// Arguments of `grainlab param get`.
#[derive(Debug, clap::Args)]
#[command(after_help = "Example:\n  grainlab param get /dem_simulator threads")]
pub struct GetArgs {
    /// Name of the node
    node: String,
    /// Name of the parameter
    parameter: String,
    #[command(flatten)]
    common: Common,
}

/// Arguments of `grainlab param set`.
#[derive(Debug, clap::Args)]
#[command(
    after_help = "Example:\n  grainlab param set /dem_simulator use_sim_time true\n\nExit 1 if the node refuses the value. What a \
                  run computes follows from the values at its start, so that\nmost parameters are read-only."
)]
pub struct SetArgs {
    /// Name of the node
    node: String,
    /// Name of the parameter
    parameter: String,
    /// Value, as YAML
    #[arg(allow_negative_numbers = true)]
    value: String,
    #[command(flatten)]
    common: Common,
}

/// Arguments of `grainlab param describe`.
#[derive(Debug, clap::Args)]
#[command(after_help = "Example:\n  grainlab param describe /dem_simulator threads simd")]
pub struct DescribeArgs {
    /// Name of the node
    node: String,
    /// Names of the parameters [default: all]
    parameters: Vec<String>,
    #[command(flatten)]
    common: Common,
}

/// Arguments of `grainlab param dump`.
#[derive(Debug, clap::Args)]
#[command(after_help = "Example:\n  grainlab param dump /dem_simulator > simulator.yaml")]
pub struct DumpArgs {
    /// Name of the node
    node: String,
    #[command(flatten)]
    common: Common,
}

pub(super) fn list(args: &ListArgs) -> Result<Exit, Failure> {
    let mut client = Client::new(&args.common)?;
    let nodes = match &args.node {
        Some(node) => vec![client.node(node)?],
        None => {
            let all: Vec<String> = client.graph.nodes.iter().map(|n| n.name.clone()).collect();
            all.into_iter().filter(|node| client.has_parameters(node)).collect()
        }
    };
    let mut found: BTreeMap<String, Vec<String>> = BTreeMap::new();
    for node in nodes {
        let names = client.list(&node)?;
        found.insert(node, names);
    }
    args.common.show(&found, || {
        let of_node = |(node, names): (&String, &Vec<String>)| {
            let lines: String = names.iter().map(|name| format!("  {name}\n")).collect();
            format!("{node}:\n{lines}")
        };
        found.iter().map(of_node).collect()
    })?;
    Ok(Exit::Done)
}

pub(super) fn get(args: &GetArgs) -> Result<Exit, Failure> {
    let mut client = Client::new(&args.common)?;
    let node = client.node(&args.node)?;
    let values = client.get(&node, std::slice::from_ref(&args.parameter))?;
    match values.first() {
        None | Some(ParameterValue::NotSet) => {
            let known = client.list(&node)?.join(", ");
            Err(Failure::failed(format!("{node} has no parameter {:?}; it has: {known}", args.parameter)))
        }
        Some(value) => {
            args.common.show(&to_json(value), || format!("{}\n", to_yaml(value)))?;
            Ok(Exit::Done)
        }
    }
}

pub(super) fn set(args: &SetArgs) -> Result<Exit, Failure> {
    let value = parse(&args.value)?;
    let mut client = Client::new(&args.common)?;
    let node = client.node(&args.node)?;
    let result = client.set(&node, &args.parameter, value)?;
    if !result.successful {
        return Err(Failure::failed(format!("{node} refuses it: {}", result.reason)));
    }
    args.common.show(&json!({ "successful": true }), || format!("{} set\n", args.parameter))?;
    Ok(Exit::Done)
}

pub(super) fn describe(args: &DescribeArgs) -> Result<Exit, Failure> {
    let mut client = Client::new(&args.common)?;
    let node = client.node(&args.node)?;
    let names = if args.parameters.is_empty() { client.list(&node)? } else { args.parameters.clone() };
    let found = client.describe(&node, &names)?;
    if let Some(unknown) = found.iter().find(|d| d.r#type == 0) {
        return Err(Failure::failed(format!("{node} has no parameter {:?}", unknown.name)));
    }
    args.common.show(&found, || {
        let mut table = Table::new(["parameter", "type", "settable", "meaning", "valid"]);
        for d in &found {
            let settable = if d.read_only { "no" } else { "yes" };
            let valid = d.additional_constraints.split("; read-only").next().unwrap_or("");
            let valid = if valid.starts_with("read-only") { "" } else { valid };
            table.row([&d.name, type_name(d.r#type), settable, &d.description, valid].map(str::to_owned));
        }
        table.text()
    })?;
    Ok(Exit::Done)
}

pub(super) fn dump(args: &DumpArgs) -> Result<Exit, Failure> {
    let mut client = Client::new(&args.common)?;
    let node = client.node(&args.node)?;
    let names = client.list(&node)?;
    let values = client.get(&node, &names)?;
    match args.common.format {
        crate::view::OutputFormat::Text => {
            let lines: String =
                names.iter().zip(&values).map(|(n, v)| format!("    {n}: {}\n", to_yaml(v))).collect();
            print(&format!("{node}:\n  ros__parameters:\n{lines}"))?;
        }
        crate::view::OutputFormat::Json => {
            let map: Map<_, _> = names.into_iter().zip(values.iter().map(to_json)).collect();
            args.common.show(&map, String::new)?;
        }
    }
    Ok(Exit::Done)
}
