//! Names, simulators, reports and parameters of nodes.

use super::finding::Finding;
use crate::call::call;
use crate::graph::{Endpoint, Graph};
use crate::observer::Observer;
use crate::reports::LATEST;
use grainlab_console::Failure;
use grainlab_node_kit::{Report, run_of};
use ros2_client::ParameterValue;
use ros2_client::rcl_interfaces::{GetParametersRequest, GetParametersResponse};
use std::collections::{BTreeMap, BTreeSet};

/// Topics that one process of a run publishes, and what it is.
const SINGLE: [(&str, &str); 4] = [
    ("grainlab_msgs/msg/Stress", "simulators"),
    ("grainlab_msgs/msg/StrainRate", "servos"),
    ("grainlab_msgs/msg/RunState", "simulators"),
    ("rosgraph_msgs/msg/Clock", "clocks"),
];

pub(super) fn findings(graph: &Graph) -> Vec<Finding> {
    let mut found = Vec::new();
    let mut names: BTreeMap<&str, usize> = BTreeMap::new();
    graph.nodes.iter().for_each(|node| *names.entry(&node.name).or_default() += 1);
    for (name, count) in names.into_iter().filter(|(_, count)| *count > 1) {
        found.push(Finding::error(
            "duplicate_node",
            format!("{count} nodes are named {name}: which of them answers a service is undefined"),
            "rename one with -r __node:=NAME, or give it a namespace with -r __ns:=/NAME",
        ));
    }
    for (name, topic) in graph.topics() {
        let single = SINGLE.iter().find(|(kind, _)| topic.types().contains(kind));
        let Some((_, what)) = single else { continue };
        // Runs with an identity of their own share a domain without mixing.
        let by_hand = || topic.publishers.iter().filter(|p| run_of_endpoint(p).is_none());
        let count = by_hand().map(|p| p.participant()).collect::<BTreeSet<[u8; 12]>>().len();
        if count > 1 {
            let owners = graph.owners(by_hand().copied());
            found.push(Finding::error(
                "duplicate_publisher",
                format!("{count} {what} publish {name}: {owners}"),
                "end one of them, give each lab a namespace (-r __ns:=) or a domain (ROS_DOMAIN_ID) of its own, or name their \
                 runs (GRAINLAB_RUN)",
            ));
        }
    }
    found
}

fn run_of_endpoint(endpoint: &Endpoint) -> Option<grainlab_node_kit::RunId> {
    run_of(&endpoint.participant())
}

/// Nodes that publish reports and sent none, and those that report a fault.
pub(super) fn of_reports(graph: &Graph, heard: &BTreeMap<String, Report>) -> Vec<Finding> {
    let silent = graph.reporting().into_iter().filter(|node| !heard.contains_key(node)).map(|node| {
        Finding::error(
            "silent_node",
            format!("{node} sent no report for {} s", LATEST.as_secs()),
            "see whether its process is stopped (Ctrl-Z, a debugger), hangs, or was killed less than a minute ago",
        )
    });
    let ailing = heard.values().filter(|r| r.health.level > grainlab_node_kit::Level::Warn).map(|report| {
        Finding::warning(
            "failing_node",
            format!("{} reports: {}", report.node, report.health.message),
            format!("see its log, and the log of process {}", report.pid),
        )
    });
    silent.chain(ailing).collect()
}

/// Nodes that wait for a clock that nobody publishes.
pub(super) fn of_sim_time(observer: &mut Observer, graph: &Graph) -> Result<Vec<Finding>, Failure> {
    let topics = graph.topics();
    let clock = topics.get("/clock").is_some_and(|t| !t.publishers.is_empty());
    let mut found = Vec::new();
    if clock {
        return Ok(found);
    }
    let services = graph.services();
    for node in &graph.nodes {
        let service = format!("{}/get_parameters", node.name);
        if services.get(service.as_str()).is_none_or(|servers| servers.len() != 1) {
            continue;
        }
        let request = GetParametersRequest { names: vec!["use_sim_time".into()] };
        // A node that does not answer was named by its report, or is none of ours.
        let Ok(answer) =
            call::<_, GetParametersResponse>(observer, graph, &service, "GetParameters", &request)
        else {
            continue;
        };
        let value = answer.values.into_iter().next().map(ParameterValue::from);
        if value == Some(ParameterValue::Boolean(true)) {
            found.push(Finding::error(
                "no_clock",
                format!(
                    "{} has use_sim_time true, and nobody publishes /clock: its time stands still",
                    node.name
                ),
                format!("start a simulator, or: grainlab param set {} use_sim_time false", node.name),
            ));
        }
    }
    Ok(found)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::graph::NodeEntry;
    use grainlab_msgs::Guid;
    use ros2_client::QosProfile;

    fn simulator(prefix: [u8; 12], name: &str) -> (Endpoint, NodeEntry) {
        let guid = Guid::of_participant(prefix);
        let qos = QosProfile::publisher_default();
        let endpoint = Endpoint::new(guid, "rt/stress", "grainlab_msgs::msg::dds_::Stress_", true, qos);
        (endpoint, NodeEntry { name: name.into(), participant: guid, endpoints: [guid].into() })
    }

    fn kinds(nodes: [(Endpoint, NodeEntry); 2]) -> Vec<&'static str> {
        let (endpoints, nodes) = nodes.into_iter().unzip();
        findings(&Graph { nodes, endpoints }).into_iter().map(|f| f.kind).collect()
    }

    #[test]
    fn a_program_of_another_maker_owes_no_report_and_a_node_of_ours_does() {
        let of = |prefix: [u8; 12]| {
            let (endpoint, node) = simulator(prefix, "/x");
            let qos = endpoint.qos.clone();
            let kind = "diagnostic_msgs::msg::dds_::DiagnosticArray_";
            let reports = Endpoint::new(endpoint.guid, "rt/diagnostics", kind, true, qos);
            of_reports(&Graph { nodes: vec![node], endpoints: vec![reports] }, &BTreeMap::new()).len()
        };
        assert_eq!(of([0x01, 0x10, 9, 9, 9, 9, 9, 9, 1, 1, 1, 1]), 0, "CycloneDDS");
        assert_eq!(of(grainlab_node_kit::Identity::default().guid_prefix()), 1);
        let run = grainlab_node_kit::RunId::named("left");
        assert_eq!(of(grainlab_node_kit::Identity::member_of(run, 1).guid_prefix()), 1);
    }

    #[test]
    fn two_simulators_by_hand_are_a_fault_and_two_runs_are_not() {
        let [a, b] = [[1; 12], [2; 12]];
        assert_eq!(kinds([simulator(a, "/a"), simulator(b, "/b")]), ["duplicate_publisher"]);
        assert_eq!(
            kinds([simulator(a, "/a"), simulator(b, "/a")]),
            ["duplicate_node", "duplicate_publisher"]
        );
        let run = |name: &str| {
            grainlab_node_kit::Identity::member_of(grainlab_node_kit::RunId::named(name), 1).guid_prefix()
        };
        let runs = kinds([simulator(run("left"), "/left/sim"), simulator(run("right"), "/right/sim")]);
        assert!(runs.is_empty(), "{runs:?}");
    }
}
