//! Types and QoS of publishers and subscriptions.

use super::finding::Finding;
use crate::graph::{Endpoint, Graph, TopicEntry, is_reliable, is_transient_local};
use grainlab_msgs::TypeInfo;

pub(super) fn findings(graph: &Graph) -> Vec<Finding> {
    let topics = graph.topics();
    let mut found = Vec::new();
    for (name, topic) in &topics {
        found.extend(types(graph, name, topic));
        found.extend(definitions(graph, name, topic));
        for reader in &topic.subscriptions {
            let unheard = topic.publishers.iter().filter(|w| w.type_name == reader.type_name);
            found.extend(unheard.flat_map(|writer| policies(graph, name, writer, reader)));
        }
    }
    found.extend(unpublished(graph));
    found
}

/// Publishers and subscriptions of different types never match.
fn types(graph: &Graph, name: &str, topic: &TopicEntry<'_>) -> Option<Finding> {
    let types = topic.types();
    if types.len() < 2 {
        return None;
    }
    let of_type = |kind: &&str| {
        format!("{kind} ({})", graph.owners(topic.endpoints().filter(|e| e.type_name == *kind)))
    };
    let all: Vec<String> = types.iter().map(of_type).collect();
    Some(Finding::error(
        "type_mismatch",
        format!("{name} has more than one type: {}", all.join(" and ")),
        "give one of them another name with -r, or the type that the other has",
    ))
}

/// Endpoints with another definition of a type than this program: a reader would take one field for another.
fn definitions(graph: &Graph, name: &str, topic: &TopicEntry<'_>) -> Vec<Finding> {
    let differs = |e: &&Endpoint| {
        TypeInfo::by_name(&e.type_name).is_some_and(|t| !e.type_hash.is_empty() && e.type_hash != t.hash)
    };
    let finding = |e: &Endpoint| {
        Finding::error(
            "definition_mismatch",
            format!(
                "{name}: {} has another definition of {} than this program (hash {}...): nodes of grainlab do not read it",
                graph.owner(e),
                e.type_name,
                &e.type_hash[..19.min(e.type_hash.len())]
            ),
            "use one version of grainlab and of its message files on both sides",
        )
    };
    topic.endpoints().filter(differs).map(finding).collect()
}

/// The policies in which a subscription requests more than a publisher offers (DDS 1.4, 2.2.3).
fn policies(graph: &Graph, name: &str, writer: &Endpoint, reader: &Endpoint) -> Vec<Finding> {
    let (offered, requested) = (&writer.qos, &reader.qos);
    let between = format!("{name}: {} receives nothing from {}", graph.owner(reader), graph.owner(writer));
    let mut found = Vec::new();
    let mut add = |kind, what: &str, advice: &str| {
        found.push(Finding::error(kind, format!("{between}: {what}"), advice));
    };
    if is_reliable(requested) && !is_reliable(offered) {
        add(
            "reliability_mismatch",
            "it requests reliable, best_effort is offered",
            "subscribe with best_effort, or publish with reliable",
        );
    }
    if is_transient_local(requested) && !is_transient_local(offered) {
        add(
            "durability_mismatch",
            "it requests transient_local, volatile is offered",
            "subscribe with volatile, or publish with transient_local",
        );
    }
    // A writer uses the first one that it lists.
    if let Some(first) = writer.representations.first()
        && !reader.representations.contains(first)
    {
        let list = |all: &[i16]| all.iter().map(|r| representation(*r)).collect::<Vec<_>>().join(", ");
        add(
            "representation_mismatch",
            &format!("it reads {}, and {} is written", list(&reader.representations), representation(*first)),
            "set both to XCDR1, the only data representation of grainlab and of ROS 2 by default",
        );
    }
    if let Some(limit) = requested.deadline
        && offered.deadline.is_none_or(|offer| offer > limit)
    {
        add(
            "deadline_mismatch",
            "it requests a shorter deadline than is offered",
            "subscribe without a deadline, or publish with one that is as short",
        );
    }
    if let Some(limit) = requested.liveliness_lease
        && offered.liveliness_lease.is_none_or(|offer| offer > limit)
    {
        add(
            "liveliness_mismatch",
            "it requests a shorter liveliness lease than is offered",
            "subscribe without a lease, or publish with one that is as short",
        );
    }
    found
}

/// Name of a data representation of DDS-XTypes (1.3, 7.6.3.1).
fn representation(number: i16) -> String {
    match number {
        0 => "XCDR1".to_owned(),
        1 => "XML".to_owned(),
        2 => "XCDR2".to_owned(),
        n => format!("representation {n}"),
    }
}

/// Subscriptions without publisher, while the same type is published under the same last name elsewhere: a namespace or
/// remap that only one side has.
fn unpublished(graph: &Graph) -> Vec<Finding> {
    let topics = graph.topics();
    let last = |name: &str| name.rsplit('/').next().unwrap_or(name).to_owned();
    let mut found = Vec::new();
    for (name, topic) in topics.iter().filter(|(_, t)| t.publishers.is_empty()) {
        let elsewhere = topics.iter().find(|(other, t)| {
            *other != name
                && last(other) == last(name)
                && t.publishers.iter().any(|p| topic.types().contains(p.type_name.as_str()))
                // A lab of its own in that namespace is complete.
                && t.subscriptions.is_empty()
        });
        if let Some((other, there)) = elsewhere {
            let readers = graph.owners(topic.subscriptions.iter().copied());
            let writers = graph.owners(there.publishers.iter().copied());
            found.push(Finding::warning(
                "namespace_mismatch",
                format!(
                    "{name} is subscribed ({readers}) and not published; {other} is published ({writers}) and not subscribed"
                ),
                format!("start one of them in the namespace of the other (-r __ns:=), or remap (-r {name}:={other})"),
            ));
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::graph::NodeEntry;
    use grainlab_msgs::Guid;
    use ros2_client::QosProfile;
    use ros2_client::qos::Durability;

    const TYPE: &str = "grainlab_msgs::msg::dds_::Stress_";

    fn endpoint(n: u8, topic: &str, type_name: &str, writes: bool, qos: QosProfile) -> Endpoint {
        let mut guid = [n; 16];
        guid[15] = u8::from(writes);
        Endpoint::new(Guid(guid), topic, type_name, writes, qos)
    }

    fn graph(endpoints: Vec<Endpoint>) -> Graph {
        let node = |e: &Endpoint| NodeEntry {
            name: format!("/node_{}", e.guid.0[0]),
            participant: e.guid,
            endpoints: [e.guid].into(),
        };
        Graph { nodes: endpoints.iter().map(node).collect(), endpoints }
    }

    fn kinds(endpoints: Vec<Endpoint>) -> Vec<&'static str> {
        findings(&graph(endpoints)).into_iter().map(|f| f.kind).collect()
    }

    #[test]
    fn each_policy_that_does_not_fit_is_named_with_both_nodes() {
        let (best, reliable) = (QosProfile::subscription_default(), QosProfile::publisher_default());
        let latched = reliable.clone().durability(Durability::TransientLocal);
        let quick = reliable.clone().deadline(Some(std::time::Duration::from_millis(5)));
        let leased =
            QosProfile { liveliness_lease: Some(std::time::Duration::from_secs(1)), ..reliable.clone() };
        for (offered, requested, expected) in [
            (&best, &reliable, "reliability_mismatch"),
            (&reliable, &latched, "durability_mismatch"),
            (&reliable, &quick, "deadline_mismatch"),
            (&reliable, &leased, "liveliness_mismatch"),
        ] {
            let pair = |offered: &QosProfile, requested: &QosProfile| {
                vec![
                    endpoint(1, "rt/stress", TYPE, true, offered.clone()),
                    endpoint(2, "rt/stress", TYPE, false, requested.clone()),
                ]
            };
            let found = findings(&graph(pair(offered, requested)));
            assert_eq!(found.len(), 1, "{expected}: {found:?}");
            assert_eq!(found[0].kind, expected);
            assert!(
                found[0].what.contains("/node_1") && found[0].what.contains("/node_2"),
                "{}",
                found[0].what
            );
            assert!(kinds(pair(requested, offered)).is_empty(), "offering more is no fault: {expected}");
        }
    }

    #[test]
    fn a_representation_that_the_reader_does_not_read_is_named() {
        let qos = QosProfile::publisher_default;
        let (xcdr1, xcdr2) = (vec![0], vec![2]);
        for (written, read, expected) in [
            (Some(xcdr2.clone()), None, 1),
            (None, Some(xcdr2.clone()), 1),
            (Some(xcdr2.clone()), Some(vec![0, 2]), 0),
            (Some(Vec::new()), Some(xcdr1), 0),
            (None, None, 0),
        ] {
            let writer = endpoint(1, "rt/stress", TYPE, true, qos()).represented(written);
            let reader = endpoint(2, "rt/stress", TYPE, false, qos()).represented(read);
            let found = findings(&graph(vec![writer, reader]));
            assert_eq!(found.len(), expected, "{found:?}");
            assert!(found.iter().all(|f| f.kind == "representation_mismatch" && f.what.contains("XCDR2")));
        }
    }

    #[test]
    fn another_definition_of_a_type_is_named_and_ours_and_none_are_not() {
        let qos = QosProfile::publisher_default;
        let info = grainlab_msgs::topics::STRESS.info;
        let other = format!("typehash=RIHS01_{};", "0f".repeat(32));
        let ours = format!("typehash={};", info.hash);
        for (announced, expected) in [(other.as_str(), 1), (&ours, 0), ("", 0)] {
            let writer = endpoint(1, "rt/stress", TYPE, true, qos()).announcing(announced.as_bytes());
            let found = findings(&graph(vec![writer, endpoint(2, "rt/stress", TYPE, false, qos())]));
            assert_eq!(found.len(), expected, "{announced}: {found:?}");
            assert!(found.iter().all(|f| f.kind == "definition_mismatch" && f.what.contains("/node_1")));
        }
    }

    #[test]
    fn two_types_of_one_topic_and_a_namespace_of_one_side_are_named() {
        let qos = QosProfile::publisher_default();
        let other = "std_msgs::msg::dds_::String_";
        let mixed = vec![
            endpoint(1, "rt/stress", TYPE, true, qos.clone()),
            endpoint(2, "rt/stress", other, false, qos.clone()),
        ];
        assert_eq!(kinds(mixed), ["type_mismatch"]);
        let apart = vec![
            endpoint(1, "rt/lab/stress", TYPE, true, qos.clone()),
            endpoint(2, "rt/stress", TYPE, false, qos),
        ];
        assert_eq!(kinds(apart), ["namespace_mismatch"]);
    }
}
