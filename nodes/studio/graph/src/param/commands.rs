//! The commands of `grainlab param`, by the parameter services of nodes.

use super::value::{parse, to_json, to_yaml};
use crate::call::call;
use crate::graph::Graph;
use crate::names::absolute;
use crate::node::find;
use crate::observer::Observer;
use crate::view::Common;
use grainlab_console::Failure;
use grainlab_node_kit::Exit;
use ros2_client::rcl_interfaces::{
    GetParametersRequest, GetParametersResponse, ListParametersRequest, ListParametersResponse,
    SetParametersRequest, SetParametersResponse,
};
use ros2_client::{Message, Parameter, ParameterValue};
use serde_json::json;
use std::collections::BTreeMap;

struct Client {
    observer: Observer,
    graph: Graph,
}

impl Client {
    fn new(common: &Common, is_there: impl Fn(&Graph) -> bool) -> Result<Self, Failure> {
        let mut observer = Observer::join()?;
        let graph = observer.with(common.patience(), is_there);
        Ok(Self { observer, graph })
    }

    /// A connection, and the full name of a node that is there.
    fn of(common: &Common, name: &str) -> Result<(Self, String), Failure> {
        let service = format!("{}/list_parameters", absolute(name));
        let client = Self::new(common, |graph| graph.services().contains_key(service.as_str()))?;
        let name = find(&client.graph, name)?.name.clone();
        Ok((client, name))
    }

    fn ask<Req: Message + Clone + 'static, Resp: Message + 'static>(
        &mut self,
        service: &str,
        kind: &str,
        request: &Req,
    ) -> Result<Resp, Failure> {
        call(&mut self.observer, &self.graph, service, kind, request)
    }

    fn list(&mut self, node: &str) -> Result<Vec<String>, Failure> {
        let request = ListParametersRequest { prefixes: Vec::new(), depth: 0 };
        let service = format!("{node}/list_parameters");
        self.ask(&service, "ListParameters", &request).map(|a: ListParametersResponse| a.result.names)
    }
}

pub(super) fn list(node: Option<&str>, common: &Common) -> Result<Exit, Failure> {
    let (mut client, nodes) = match node {
        Some(node) => Client::of(common, node).map(|(client, name)| (client, vec![name]))?,
        None => {
            let client = Client::new(common, |_| false)?;
            let services = client.graph.services();
            let has_parameters =
                |node: &String| services.contains_key(format!("{node}/list_parameters").as_str());
            let all = client.graph.nodes.iter().map(|n| n.name.clone());
            let nodes = all.filter(has_parameters).collect();
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
    let request = GetParametersRequest { names: vec![parameter.to_owned()] };
    let answer: GetParametersResponse =
        client.ask(&format!("{node}/get_parameters"), "GetParameters", &request)?;
    match answer.values.into_iter().next().map(ParameterValue::from) {
        None | Some(ParameterValue::NotSet) => {
            let known = client.list(&node)?.join(", ");
            Err(Failure::failed(format!("{node} has no parameter {parameter:?}; it has: {known}")))
        }
        Some(value) => common.show(&to_json(&value), || format!("{}\n", to_yaml(&value))),
    }
}

pub(super) fn set(node: &str, parameter: &str, value: &str, common: &Common) -> Result<Exit, Failure> {
    let value = parse(value)?;
    let (mut client, node) = Client::of(common, node)?;
    let given = Parameter { name: parameter.to_owned(), value };
    let request = SetParametersRequest { parameter: vec![given.into()] };
    let service = format!("{node}/set_parameters");
    let answer: SetParametersResponse = client.ask(&service, "SetParameters", &request)?;
    let missing = || Failure::failed(format!("{service} answered without a result"));
    let result = answer.results.into_iter().next().ok_or_else(missing)?;
    if !result.successful {
        return Err(Failure::failed(format!("{node} refuses it: {}", result.reason)));
    }
    common.show(&json!({ "successful": true }), || format!("{parameter} set\n"))
}
