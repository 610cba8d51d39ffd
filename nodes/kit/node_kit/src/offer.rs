//! Offers of writers of other processes, and the names of topics and types in DDS.

use grainlab_msgs::{Guid, Qos, TypeInfo};

/// A writer of another process on a topic of ROS.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Offer {
    /// Writer that offers it.
    pub writer: Guid,
    /// Full name of the topic: `/lab/stress`.
    pub topic: String,
    /// Type of the messages: `grainlab_msgs/msg/Stress`.
    pub type_name: String,
    /// QoS of the writer; a depth of 0 is unknown.
    pub qos: Qos,
    /// Hash of the type, `RIHS01_…`, or empty if it is not announced.
    pub type_hash: String,
}

impl Offer {
    /// Why messages of this writer must not be read as those of `info`, whose fields come in another order or have other
    /// types. A writer that announces no hash is taken at its word.
    pub(crate) fn misfit(&self, info: &TypeInfo) -> Option<String> {
        if self.type_name != info.type_name {
            return Some(format!("its messages are {}", self.type_name));
        }
        let (found, known) = (&self.type_hash, !self.type_hash.is_empty() && !info.hash.is_empty());
        let start = &found[..19.min(found.len())];
        (known && found != info.hash)
            .then(|| format!("it has another definition of the type (hash {start}...)"))
    }

    /// From the names in DDS and the user data of the writer; `None` unless they are those of a topic of ROS.
    pub(crate) fn of_wire(
        writer: Guid,
        topic: &str,
        type_name: &str,
        qos: Qos,
        user_data: &[u8],
    ) -> Option<Self> {
        // Names from the network become names of files and lines of logs.
        let plain =
            |part: &str| !part.is_empty() && part.bytes().all(|b| b.is_ascii_alphanumeric() || b == b'_');
        let name = topic.strip_prefix("rt")?;
        let parts: Vec<&str> = type_name.split("::").collect();
        let [package, kind, "dds_", last] = parts[..] else { return None };
        let last = last.strip_suffix('_').unwrap_or(last);
        let is_ros =
            name.strip_prefix('/')?.split('/').all(plain) && [package, kind, last].into_iter().all(plain);
        is_ros.then(|| Self {
            writer,
            topic: name.to_owned(),
            type_name: format!("{package}/{kind}/{last}"),
            qos,
            type_hash: type_hash(user_data),
        })
    }
}

const HASH_KEY: &str = "typehash=";

/// The user data of a writer of this type, as rmw writes it; none if the hash is not known.
pub(crate) fn user_data(info: &TypeInfo) -> Option<Vec<u8>> {
    (!info.hash.is_empty()).then(|| format!("{HASH_KEY}{};", info.hash).into_bytes())
}

/// The hash in `typehash=RIHS01_…;`, as rmw writes it into the user data of an endpoint; empty if there is none.
pub fn type_hash(user_data: &[u8]) -> String {
    let text = String::from_utf8_lossy(user_data);
    let found = text.split(';').find_map(|entry| entry.strip_prefix(HASH_KEY));
    let is_hash = |hash: &&str| {
        hash.strip_prefix("RIHS01_")
            .is_some_and(|d| d.len() == 64 && d.bytes().all(|b| b.is_ascii_hexdigit()))
    };
    found.filter(is_hash).unwrap_or_default().to_owned()
}

/// `grainlab_msgs/msg/Stress` as DDS has it: `grainlab_msgs::msg::dds_::Stress_`.
pub(crate) fn wire_type(type_name: &str) -> String {
    match type_name.rsplit_once('/') {
        Some((package, name)) => format!("{}::dds_::{name}_", package.replace('/', "::")),
        None => type_name.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_writer_of_another_type_or_definition_does_not_fit_and_one_without_a_hash_is_believed() {
        let qos = Qos { reliable: true, depth: 0, transient_local: false };
        let info = grainlab_msgs::topics::STRESS.info;
        let misfit = |type_name: &str, data: &[u8]| {
            Offer::of_wire(Guid([1; 16]), "rt/stress", &wire_type(type_name), qos, data)
                .unwrap()
                .misfit(&info)
        };
        assert_eq!(misfit(info.type_name, &user_data(&info).unwrap()), None);
        assert_eq!(misfit(info.type_name, b""), None);
        let other = format!("RIHS01_{}", "0f".repeat(32));
        let announced = format!("typehash={other};");
        assert!(
            misfit(info.type_name, announced.as_bytes()).unwrap().contains("(hash RIHS01_0f0f0f0f0f0f...)")
        );
        assert_eq!(misfit("std_msgs/msg/String", b"").unwrap(), "its messages are std_msgs/msg/String");
    }

    #[test]
    fn names_on_the_wire_are_those_of_ros_or_no_offer() {
        let qos = Qos { reliable: true, depth: 0, transient_local: false };
        let of = |topic: &str, kind: &str, data: &[u8]| {
            let offer = Offer::of_wire(Guid([1; 16]), topic, kind, qos, data)?;
            Some((offer.topic, offer.type_name, offer.type_hash))
        };
        let hash = format!("RIHS01_{}", "0f".repeat(32));
        let data = format!("enclave=/;typehash={hash};");
        let name = "/lab/_action/feedback".to_owned();
        assert_eq!(
            of("rt/lab/_action/feedback", "p::action::dds_::F_FeedbackMessage_", data.as_bytes()),
            Some((name, "p/action/F_FeedbackMessage".to_owned(), hash))
        );
        let string = "std_msgs::msg::dds_::String_";
        assert_eq!(of("rt/a", string, b"typehash=RIHS01_0;").unwrap().2, "");
        assert_eq!(wire_type("std_msgs/msg/String"), string);
        for (topic, kind) in [
            ("ros_discovery_info", string),
            ("rq/a/getRequest", string),
            ("rt/a\x1b[31m", string),
            ("rt/a//b", string),
            ("rt/a", "Plain"),
            ("rt/a", "..::msg::dds_::String_"),
        ] {
            assert_eq!(of(topic, kind, b""), None, "{topic} {kind}");
        }
    }
}
