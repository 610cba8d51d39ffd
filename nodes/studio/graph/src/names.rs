//! Names of topics, services and types on the wire (ROS 2 design, "Topic and Service name mapping to DDS").

use grainlab_console::{Failure, escape_name};

/// A topic of DDS as ROS knows it.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum RosName {
    Topic(String),
    /// The requests of a service, `/dem_simulator/get_parameters`.
    Request(String),
    /// No topic or request of ROS.
    Other(String),
}

impl RosName {
    pub(crate) fn of(dds: &str) -> Self {
        let dds = escape_name(dds);
        let dds = dds.as_ref();
        let other = || Self::Other(dds.to_owned());
        match dds.split_once('/') {
            Some(("rt", rest)) => Self::Topic(format!("/{rest}")),
            Some(("rq", rest)) => {
                rest.strip_suffix("Request").map_or_else(other, |name| Self::Request(format!("/{name}")))
            }
            _ => other(),
        }
    }
}

/// `grainlab_msgs::msg::dds_::Stress_` as `grainlab_msgs/msg/Stress`; for a service without `_Request` and `_Response`.
pub(crate) fn ros_type(dds: &str) -> String {
    let dds = escape_name(dds);
    let parts: Vec<&str> = dds.split("::").collect();
    match parts[..] {
        [package, kind, "dds_", name] => {
            let name = name.strip_suffix('_').unwrap_or(name);
            let name = match kind {
                "srv" => name.strip_suffix("_Request").or(name.strip_suffix("_Response")).unwrap_or(name),
                _ => name,
            };
            format!("{package}/{kind}/{name}")
        }
        _ => dds.to_string(),
    }
}

/// There is no such topic, node or service; with those that there are.
pub(crate) fn unknown<'a>(kind: &str, name: &str, known: impl Iterator<Item = &'a str>) -> Failure {
    let known: Vec<&str> = known.collect();
    let list = if known.is_empty() { "none".to_owned() } else { known.join(", ") };
    Failure::failed(format!(
        "no {kind} {name} in this domain (ROS_DOMAIN_ID); {kind}s are: {list}. See grainlab doctor"
    ))
}

/// A name as typed, with a slash before it.
pub(crate) fn absolute(name: &str) -> String {
    format!("/{}", name.trim_matches('/'))
}

/// True for a name of which a part begins with an underscore: lists leave it out.
pub(crate) fn is_hidden(name: &str) -> bool {
    name.split('/').any(|part| part.starts_with('_'))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_on_the_wire_become_those_of_ros() {
        assert_eq!(RosName::of("rt/lab/stress"), RosName::Topic("/lab/stress".into()));
        assert_eq!(
            RosName::of("rq/sim/get_parametersRequest"),
            RosName::Request("/sim/get_parameters".into())
        );
        assert_eq!(RosName::of("ros_discovery_info"), RosName::Other("ros_discovery_info".into()));
        assert_eq!(ros_type("grainlab_msgs::msg::dds_::Stress_"), "grainlab_msgs/msg/Stress");
        assert_eq!(
            ros_type("rcl_interfaces::srv::dds_::GetParameters_Request_"),
            "rcl_interfaces/srv/GetParameters"
        );
        assert_eq!(ros_type("Plain"), "Plain");
        assert_eq!(RosName::of("rt/a\x1b[31m\nb"), RosName::Topic("/a\\u{1b}[31m\\nb".into()));
        assert_eq!(absolute("stress/"), "/stress");
    }

    #[test]
    fn a_type_is_shown_without_what_a_terminal_obeys() {
        assert_eq!(ros_type("a\x1b[31m::msg::dds_::B\n_"), r"a\u{1b}[31m/msg/B\n");
        assert_eq!(ros_type("a\x1b[31m"), r"a\u{1b}[31m");
    }
}
