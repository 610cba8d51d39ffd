//! Type descriptions (REP-2016): the fields of a type and of all types in it.

use crate::message::TypeInfo;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Message `type_description_interfaces/msg/TypeDescription` of ROS 2.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct TypeDescription {
    /// Description of the type.
    pub type_description: MessageDescription,
    /// All types in it, sorted by name.
    pub referenced_type_descriptions: Vec<MessageDescription>,
}

/// Message `type_description_interfaces/msg/IndividualTypeDescription` of ROS 2.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct MessageDescription {
    /// Full name, `package/msg/Name`.
    pub type_name: String,
    /// Fields in the order of the type.
    pub fields: Vec<FieldDescription>,
}

/// Message `type_description_interfaces/msg/Field` of ROS 2.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct FieldDescription {
    /// Name of the field.
    pub name: String,
    /// Type of the field.
    #[serde(rename = "type")]
    pub kind: FieldTypeDescription,
    /// Default value; always empty here.
    pub default_value: String,
}

/// Message `type_description_interfaces/msg/FieldType` of ROS 2.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct FieldTypeDescription {
    /// Number of the type: see [`crate::FieldInfo::type_id`].
    pub type_id: u8,
    /// Length of an array, else 0.
    pub capacity: u64,
    /// Maximum length of a bounded string; always 0 here.
    pub string_capacity: u64,
    /// Full name of a message in it, else empty.
    pub nested_type_name: String,
}

impl TypeInfo {
    /// The description of this type, from which its hash follows.
    pub fn description(&self) -> TypeDescription {
        let mut referenced = BTreeMap::new();
        let mut open = vec![self];
        while let Some(info) = open.pop() {
            let nested = info.fields.iter().filter_map(|field| Self::by_name(field.nested));
            for inner in nested {
                if referenced.insert(inner.type_name, inner.own_description()).is_none() {
                    open.push(inner);
                }
            }
        }
        TypeDescription {
            type_description: self.own_description(),
            referenced_type_descriptions: referenced.into_values().collect(),
        }
    }

    fn own_description(&self) -> MessageDescription {
        let field = |field: &crate::FieldInfo| FieldDescription {
            name: field.name.into(),
            kind: FieldTypeDescription {
                type_id: field.type_id,
                capacity: field.capacity,
                string_capacity: 0,
                nested_type_name: field.nested.into(),
            },
            default_value: String::new(),
        };
        MessageDescription {
            type_name: self.type_name.into(),
            fields: self.fields.iter().map(field).collect(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use hmac_sha256::Hash;
    use serde_json::Value;

    /// JSON with spaces behind colons and commas, as REP-2016 hashes it.
    fn canonical(value: &Value) -> String {
        match value {
            Value::Array(items) => {
                format!("[{}]", items.iter().map(canonical).collect::<Vec<_>>().join(", "))
            }
            Value::Object(map) => {
                // serde_json sorts keys; the order of the message is that of REP-2016.
                const ORDER: [&str; 10] = [
                    "type_description",
                    "referenced_type_descriptions",
                    "type_name",
                    "fields",
                    "name",
                    "type",
                    "type_id",
                    "capacity",
                    "string_capacity",
                    "nested_type_name",
                ];
                let pairs =
                    ORDER.iter().filter_map(|key| Some(format!("\"{key}\": {}", canonical(map.get(*key)?))));
                format!("{{{}}}", pairs.collect::<Vec<_>>().join(", "))
            }
            other => other.to_string(),
        }
    }

    #[test]
    fn the_hash_of_every_type_follows_from_its_description() {
        for info in TypeInfo::all() {
            let json = canonical(&serde_json::to_value(info.description()).unwrap());
            let digest = Hash::hash(json.as_bytes());
            let hash: String = digest.iter().map(|byte| format!("{byte:02x}")).collect();
            assert_eq!(format!("RIHS01_{hash}"), info.hash, "{}", info.type_name);
        }
    }
}
