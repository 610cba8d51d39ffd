//! `~/get_type_description`: the fields of a type by name and hash (REP-2016).

use grainlab_msgs::{TypeDescription, TypeInfo};
use ros2_client::Message;
use serde::{Deserialize, Serialize};

/// The request of `type_description_interfaces/srv/GetTypeDescription`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct GetTypeDescriptionRequest {
    pub(super) type_name: String,
    pub(super) type_hash: String,
    pub(super) include_type_sources: bool,
}

#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct GetTypeDescriptionResponse {
    pub(super) successful: bool,
    pub(super) failure_reason: String,
    pub(super) type_description: TypeDescription,
    pub(super) type_sources: Vec<TypeSource>,
    pub(super) extra_information: Vec<KeyValue>,
}

/// `type_description_interfaces/msg/TypeSource`: the text of a message file.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct TypeSource {
    type_name: String,
    encoding: String,
    raw_file_contents: String,
}

/// `type_description_interfaces/msg/KeyValue`: an entry of extra information.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct KeyValue {
    key: String,
    value: String,
}

impl Message for GetTypeDescriptionRequest {}
impl Message for GetTypeDescriptionResponse {}

/// Between the message files of a schema text.
const SEPARATOR: &str =
    "\n================================================================================\n";

pub(super) fn described(request: &GetTypeDescriptionRequest) -> GetTypeDescriptionResponse {
    let failed = |failure_reason: String| GetTypeDescriptionResponse {
        failure_reason,
        ..GetTypeDescriptionResponse::default()
    };
    let Some(info) = TypeInfo::by_name(&request.type_name) else {
        return failed(format!("no type {:?} is used by this node", request.type_name));
    };
    if request.type_hash != info.hash {
        return failed(format!(
            "{} has the hash {} here, not {:?}",
            info.type_name, info.hash, request.type_hash
        ));
    }
    let type_description = info.description();
    let sources = || {
        let referenced = type_description.referenced_type_descriptions.iter().map(|r| r.type_name.as_str());
        [info.type_name].into_iter().chain(referenced).filter_map(source).collect()
    };
    let type_sources = if request.include_type_sources { sources() } else { Vec::new() };
    GetTypeDescriptionResponse {
        successful: true,
        failure_reason: String::new(),
        type_description,
        type_sources,
        extra_information: Vec::new(),
    }
}

fn source(type_name: &str) -> Option<TypeSource> {
    let text = TypeInfo::by_name(type_name)?.definition;
    let own = text.split(SEPARATOR).next().unwrap_or(text);
    Some(TypeSource { type_name: type_name.into(), encoding: "msg".into(), raw_file_contents: own.into() })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ask(type_name: &str, type_hash: &str) -> GetTypeDescriptionResponse {
        let request = GetTypeDescriptionRequest {
            type_name: type_name.into(),
            type_hash: type_hash.into(),
            include_type_sources: true,
        };
        described(&request)
    }

    #[test]
    fn a_type_is_described_with_its_sources_and_wrong_hashes_are_refused() {
        let stress = TypeInfo::by_name("grainlab_msgs/msg/Stress").unwrap();
        let answer = ask(stress.type_name, stress.hash);
        assert!(answer.successful, "{}", answer.failure_reason);
        assert_eq!(answer.type_description.type_description.fields[0].name, "header");
        let names: Vec<&str> = answer.type_sources.iter().map(|s| s.type_name.as_str()).collect();
        assert!(names.contains(&"std_msgs/msg/Header"), "{names:?}");
        assert!(!answer.type_sources[0].raw_file_contents.contains("MSG:"));
        assert!(ask(stress.type_name, "RIHS01_00").failure_reason.contains(stress.hash));
        assert!(ask("demo_msgs/msg/None", "").failure_reason.contains("demo_msgs/msg/None"));
    }
}
