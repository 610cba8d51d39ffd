//! The standard services of one node, served through ros2-client: six of its parameters, and that of type descriptions.

use super::type_description::{GetTypeDescriptionRequest, GetTypeDescriptionResponse, described};
use crate::bus_error::{BusError, create_error};
use crate::lock::lock;
use crate::parameters::{Parameters, coerce};
use mio::{Interest, Registry, Token};
use ros2_client::parameters::raw::{self, SetParametersResult};
use ros2_client::qos::{History, WhenFull};
use ros2_client::rcl_interfaces::{
    DescribeParametersRequest, DescribeParametersResponse, GetParameterTypesRequest,
    GetParameterTypesResponse, GetParametersRequest, GetParametersResponse, ListParametersRequest,
    ListParametersResponse, ListParametersResult, SetParametersAtomicallyResponse, SetParametersRequest,
    SetParametersResponse,
};
use ros2_client::{
    Message, Name, Node, Parameter, ParameterValue, QosProfile, Server, ServiceMapping, ServiceTypeName,
};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex};

/// Requests that wait for an answer, and answers that are kept for a client. ROS 2 has 1000, which a client outside the run
/// could make as many megabytes.
const DEPTH: usize = 16;

/// Maximum number of names in a request, and of bytes of a name; a request beyond is answered without values.
const NAMES: usize = 1000;
const NAME: usize = 255;

const TYPE_DESCRIPTION: (&str, &str) = ("type_description_interfaces", "GetTypeDescription");

pub(super) struct NodeServers {
    list: Server<ListParametersRequest, ListParametersResponse>,
    get: Server<GetParametersRequest, GetParametersResponse>,
    types: Server<GetParameterTypesRequest, GetParameterTypesResponse>,
    describe: Server<DescribeParametersRequest, DescribeParametersResponse>,
    set: Server<SetParametersRequest, SetParametersResponse>,
    set_atomically: Server<SetParametersRequest, SetParametersAtomicallyResponse>,
    type_description: Server<GetTypeDescriptionRequest, GetTypeDescriptionResponse>,
    declared: Parameters,
    node: Arc<Mutex<Node>>,
    log: SparseLog,
}

fn server<Req: Message + Clone + 'static, Resp: Message + 'static>(
    node: &mut Node,
    name: &str,
    (package, type_name): (&str, &str),
) -> Result<Server<Req, Resp>, BusError> {
    let qos = QosProfile::publisher_default()
        .reliability_reliable(WhenFull::DEFAULT)
        .history(History::KeepLast { depth: DEPTH as _ });
    let failed = |reason: String| BusError::Network { what: format!("serve {name}"), reason };
    let full = Name::new(&node.fully_qualified_name(), name).map_err(|e| failed(format!("{e:?}")))?;
    let service_type = ServiceTypeName::new(package, type_name);
    node.create_server(ServiceMapping::ByClient, &full, &service_type, qos.clone(), qos)
        .map_err(|e| create_error(name, &e))
}

impl NodeServers {
    pub(super) fn new(node: &Arc<Mutex<Node>>, declared: Parameters) -> Result<Self, BusError> {
        let mut held = lock(node);
        Ok(Self {
            list: server(&mut held, "list_parameters", ("rcl_interfaces", "ListParameters"))?,
            get: server(&mut held, "get_parameters", ("rcl_interfaces", "GetParameters"))?,
            types: server(&mut held, "get_parameter_types", ("rcl_interfaces", "GetParameterTypes"))?,
            describe: server(&mut held, "describe_parameters", ("rcl_interfaces", "DescribeParameters"))?,
            set: server(&mut held, "set_parameters", ("rcl_interfaces", "SetParameters"))?,
            set_atomically: server(
                &mut held,
                "set_parameters_atomically",
                ("rcl_interfaces", "SetParametersAtomically"),
            )?,
            type_description: server(&mut held, "get_type_description", TYPE_DESCRIPTION)?,
            declared,
            node: Arc::clone(node),
            log: SparseLog::default(),
        })
    }

    /// Registers all servers under one token: any request ends the wait.
    pub(super) fn register(&mut self, registry: &Registry, token: Token) -> std::io::Result<()> {
        registry.register(&mut self.list, token, Interest::READABLE)?;
        registry.register(&mut self.get, token, Interest::READABLE)?;
        registry.register(&mut self.types, token, Interest::READABLE)?;
        registry.register(&mut self.describe, token, Interest::READABLE)?;
        registry.register(&mut self.set, token, Interest::READABLE)?;
        registry.register(&mut self.set_atomically, token, Interest::READABLE)?;
        registry.register(&mut self.type_description, token, Interest::READABLE)
    }

    pub(super) fn answer(&self) {
        let value = |name: &String| lock(&self.node).get_parameter(name).unwrap_or(ParameterValue::NotSet);
        let log = &self.log;
        answer_all(&self.list, log, |request| ListParametersResponse {
            result: listed(self.declared.names(), &request),
        });
        answer_all(&self.get, log, |request| GetParametersResponse {
            values: within(&request.names).iter().map(|name| value(name).into()).collect(),
        });
        answer_all(&self.types, log, |request| GetParameterTypesResponse {
            values: within(&request.names)
                .iter()
                .map(|name| ParameterValue::to_parameter_type_raw(&value(name)))
                .collect(),
        });
        answer_all(&self.describe, log, |request| DescribeParametersResponse {
            values: self.declared.describe(within(&request.names)),
        });
        answer_all(&self.set, log, |request| SetParametersResponse {
            results: bounded(request.parameter).into_iter().map(|parameter| self.set(parameter)).collect(),
        });
        answer_all(&self.set_atomically, log, |request| SetParametersAtomicallyResponse {
            result: self.set_together(bounded(request.parameter)),
        });
        answer_all(&self.type_description, log, |request| described(&request));
    }

    /// Sets one parameter; ros2-client publishes the change on `/parameter_events`.
    fn set(&self, parameter: raw::Parameter) -> SetParametersResult {
        let Parameter { name, value } = self.adapted(parameter);
        let set = lock(&self.node).set_parameter(&name, value.clone());
        if set.is_ok()
            && let Some(number) = due(&self.log.set)
        {
            log::info!("parameter {name} set to {value:?} ({number} changes so far)");
        }
        set.into()
    }

    fn set_together(&self, parameters: Vec<raw::Parameter>) -> SetParametersResult {
        let adapted: Vec<Parameter> = parameters.iter().cloned().map(|p| self.adapted(p)).collect();
        let pairs = adapted.iter().map(|p| (p.name.as_str(), p.value.clone()));
        if let Err(reason) = self.declared.check_all(pairs) {
            return Err(reason).into();
        }
        let results = parameters.into_iter().map(|parameter| self.set(parameter));
        results.into_iter().find(|r| !r.successful).unwrap_or_else(|| Ok(()).into())
    }

    /// An integer for a parameter that is a double, as `ros2 param set` sends one, becomes that double.
    fn adapted(&self, parameter: raw::Parameter) -> Parameter {
        let Parameter { name, value } = Parameter::from(parameter);
        let value = match self.declared.spec(&name) {
            Some(spec) => coerce(value, &spec.default).unwrap_or_else(|unfit| unfit),
            None => value,
        };
        Parameter { name, value }
    }
}

/// The names below the prefixes, with the rules of rclcpp: `depth` counts dots, 0 is no limit.
fn listed(names: Vec<String>, request: &ListParametersRequest) -> ListParametersResult {
    let shallow = |rest: &str| request.depth == 0 || (rest.matches('.').count() as u64) < request.depth;
    let below = |name: &str, prefix: &str| {
        name == prefix
            || name
                .strip_prefix(prefix)
                .and_then(|rest| rest.strip_prefix('.'))
                .is_some_and(|rest| shallow(&format!(".{rest}")))
    };
    let wanted = |name: &String| {
        (request.prefixes.is_empty() && shallow(name)) || request.prefixes.iter().any(|p| below(name, p))
    };
    let names: Vec<String> = names.into_iter().filter(wanted).collect();
    let mut prefixes: Vec<String> =
        names.iter().filter_map(|name| Some(name.rsplit_once('.')?.0.to_owned())).collect();
    prefixes.dedup();
    ListParametersResult { names, prefixes }
}

/// The names of a request, or none if it has too many or too long ones.
fn within(names: &[String]) -> &[String] {
    if names.len() <= NAMES && names.iter().all(|name| name.len() <= NAME) { names } else { &[] }
}

/// The parameters of a request to set, or none if it has too many or too long names.
fn bounded(parameters: Vec<raw::Parameter>) -> Vec<raw::Parameter> {
    let fits = parameters.len() <= NAMES && parameters.iter().all(|p| p.name.len() <= NAME);
    if fits { parameters } else { Vec::new() }
}

/// Logs the 1st, 2nd, 4th, 8th, … of messages that a client can cause: a flood must fill no disk.
#[derive(Default)]
struct SparseLog {
    refused: AtomicU64,
    set: AtomicU64,
}

/// Number of this message if it is logged.
fn due(counter: &AtomicU64) -> Option<u64> {
    let number = counter.fetch_add(1, Ordering::Relaxed) + 1;
    number.is_power_of_two().then_some(number)
}

fn answer_all<Req: Message + 'static, Resp: Message + 'static>(
    server: &Server<Req, Resp>,
    log: &SparseLog,
    answer: impl Fn(Req) -> Resp,
) {
    loop {
        match server.receive_request() {
            Ok(Some((id, request))) => {
                if let Err(error) = server.send_response(id, answer(request))
                    && let Some(number) = due(&log.refused)
                {
                    log::warn!("a request of a service could not be answered ({number} so far): {error:?}");
                }
            }
            Ok(None) => return,
            // A request that does not decode is gone; the next call reads the one after it.
            Err(error) => {
                if let Some(number) = due(&log.refused) {
                    log::warn!(
                        "a request of a service does not decode and is left out ({number} so far): {error:?}"
                    );
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ask(prefixes: &[&str], depth: u64) -> (Vec<String>, Vec<String>) {
        let names = ["a", "b.c", "b.d.e", "f"].map(str::to_owned).to_vec();
        let prefixes = prefixes.iter().map(|p| (*p).to_owned()).collect();
        let found = listed(names, &ListParametersRequest { prefixes, depth });
        (found.names, found.prefixes)
    }

    #[test]
    fn a_request_with_too_many_or_too_long_names_gets_no_values() {
        let names = |count: usize, length: usize| vec!["a".repeat(length); count];
        assert_eq!(within(&names(NAMES, NAME)).len(), NAMES);
        assert!(within(&names(NAMES + 1, 1)).is_empty());
        assert!(within(&names(1, NAME + 1)).is_empty());
    }

    #[test]
    fn names_are_listed_by_prefix_and_depth_as_in_rclcpp() {
        assert_eq!(ask(&[], 0).0, ["a", "b.c", "b.d.e", "f"]);
        assert_eq!(ask(&[], 1).0, ["a", "f"]);
        assert_eq!(ask(&["b"], 0), (vec!["b.c".into(), "b.d.e".into()], vec!["b".into(), "b.d".into()]));
        assert_eq!(ask(&["a"], 5), (vec!["a".into()], vec![]));
        assert_eq!(ask(&["g"], 0), (vec![], vec![]));
    }
}
