//! `grainlab service call`: requests and answers as JSON.

use crate::call::call;
use crate::graph::Graph;
use crate::names::{absolute, unknown};
use crate::observer::Observer;
use crate::view::Common;
use grainlab_console::{Failure, json, print};
use grainlab_node_kit::Exit;
use ros2_client::Message;
use ros2_client::rcl_interfaces as rcl;
use serde::{Deserialize, Serialize};
use serde_json::Value;

/// Arguments of `grainlab service call`.
#[derive(Debug, clap::Args)]
#[command(
    after_help = "Example:\n  grainlab service call /dem_simulator/list_parameters '{prefixes: [], depth: 0}'\n  grainlab service call /recorder/get_parameters rcl_interfaces/srv/GetParameters '{names: [append]}'"
)]
pub struct Args {
    /// Name of the service
    service: String,
    /// Type of the service, if given, and the request as YAML or JSON [default: an empty one]
    #[arg(value_name = "TYPE] [REQUEST", num_args = 0..=2)]
    words: Vec<String>,
    #[command(flatten)]
    common: Common,
}

/// `std_srvs/srv/Empty` and the request of `Trigger`: a message without fields has one byte on the wire.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
struct Nothing {
    structure_needs_at_least_one_member: u8,
}

/// The request of `std_srvs/srv/SetBool`.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Switch {
    data: bool,
}

/// The answer of `Trigger` and `SetBool`.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct Outcome {
    success: bool,
    message: String,
}

impl Message for Nothing {}
impl Message for Switch {}
impl Message for Outcome {}

/// One call: the service, its type and the request.
struct Call<'a> {
    observer: &'a mut Observer,
    graph: &'a Graph,
    service: &'a str,
    kind: &'a str,
    request: &'a str,
}

impl Call<'_> {
    fn make<Req, Resp>(self) -> Result<String, Failure>
    where
        Req: Message + Clone + for<'de> Deserialize<'de> + 'static,
        Resp: Message + Serialize + 'static,
    {
        let kind = self.kind;
        let request: Req = request(self.request)
            .map_err(|e| Failure::usage(format!("the request is not one of {kind}: {e}")))?;
        let kind = kind.split_once("/srv/").unwrap_or(("", kind));
        let answer: Resp = call(self.observer, self.graph, self.service, kind, &request)?;
        json(&answer)
    }
}

/// A request from its text, which may have no field that the request has not.
fn request<Req: Message>(text: &str) -> Result<Req, String> {
    let read: Req = serde_saphyr::from_str(text).map_err(|e| e.to_string())?;
    let given: Value = serde_saphyr::from_str(text).map_err(|e| e.to_string())?;
    let known = serde_json::to_value(&read).map_err(|e| e.to_string())?;
    let names = |value: &Value| value.as_object().into_iter().flat_map(|m| m.keys().cloned()).collect();
    let [given, known]: [Vec<String>; 2] = [&given, &known].map(names);
    match given.iter().find(|name| !known.contains(name)) {
        Some(name) => Err(format!("it has no field {name:?}; its fields are: {}", known.join(", "))),
        None => Ok(read),
    }
}

pub(super) fn run(args: &Args) -> Result<Exit, Failure> {
    let mut observer = Observer::join()?;
    let service = absolute(&args.service);
    let is_there = |graph: &Graph| graph.services().contains_key(service.as_str());
    let graph = observer.with(args.common.patience(), is_there);
    let services = graph.services();
    let Some(kind) = services.get(service.as_str()).and_then(|s| s.first()).map(|s| s.type_name.clone())
    else {
        return Err(unknown("service", &service, services.keys().copied()));
    };
    let (named, request) = match &args.words[..] {
        [] => (None, None),
        // A type has no brace and no space.
        [one] if one.contains("/srv/") && !one.contains([' ', '{']) => (Some(one), None),
        [one] => (None, Some(one)),
        [named, request, ..] => (Some(named), Some(request)),
    };
    if let Some(named) = named.filter(|named| **named != kind) {
        return Err(Failure::usage(format!("{service} has the type {kind}, not {named}")));
    }
    let empty = match kind.as_str() {
        "rcl_interfaces/srv/ListParameters" => "{prefixes: [], depth: 0}",
        rcl if rcl.starts_with("rcl_interfaces/srv/") => "{names: []}",
        _ => "{}",
    };
    let request = request.map_or(empty, String::as_str);
    let call = Call { observer: &mut observer, graph: &graph, service: &service, kind: &kind, request };
    let answer = match kind.as_str() {
        "rcl_interfaces/srv/ListParameters" => {
            call.make::<rcl::ListParametersRequest, rcl::ListParametersResponse>()
        }
        "rcl_interfaces/srv/GetParameters" => {
            call.make::<rcl::GetParametersRequest, rcl::GetParametersResponse>()
        }
        "rcl_interfaces/srv/GetParameterTypes" => {
            call.make::<rcl::GetParameterTypesRequest, rcl::GetParameterTypesResponse>()
        }
        "rcl_interfaces/srv/DescribeParameters" => {
            call.make::<rcl::DescribeParametersRequest, rcl::DescribeParametersResponse>()
        }
        "std_srvs/srv/Empty" => call.make::<Nothing, Nothing>(),
        "std_srvs/srv/Trigger" => call.make::<Nothing, Outcome>(),
        "std_srvs/srv/SetBool" => call.make::<Switch, Outcome>(),
        "rcl_interfaces/srv/SetParameters" | "rcl_interfaces/srv/SetParametersAtomically" => {
            Err(Failure::usage("use grainlab param set, which knows the types of values"))
        }
        other => Err(Failure::failed(format!(
            "the definition of {other} is not known to this program: it calls the parameter services and std_srvs"
        ))),
    }?;
    print(&answer)?;
    Ok(Exit::Done)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_unknown_field_of_a_request_is_refused_with_those_there_are() {
        let list = |text: &str| request::<rcl::ListParametersRequest>(text);
        assert_eq!(list("{prefixes: [a], depth: 2}").unwrap().depth, 2);
        let error = list("{prefixes: [], depth: 0, dephts: 3}").unwrap_err();
        assert!(["\"dephts\"", "depth", "prefixes"].iter().all(|name| error.contains(name)), "{error}");
        assert!(list("{prefixes: []}").unwrap_err().contains("depth"));
        assert!(request::<Switch>("{data: true}").unwrap().data && request::<Nothing>("{}").is_ok());
        assert!(request::<Nothing>("{data: true}").is_err());
    }
}
