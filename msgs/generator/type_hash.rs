//! RIHS01 type hashes: SHA-256 of the type description in canonical JSON (REP-2016).

use super::Library;
use super::parse::{Base, Field, MessageFile, Shape};
use hmac_sha256::Hash;

/// Returns the hash of `file`, as `RIHS01_` and 64 hexadecimal digits.
pub(crate) fn rihs01(file: &MessageFile, library: &Library) -> String {
    let mut nested = file.nested(library);
    nested.sort_by_key(|file| (&file.package, &file.name));
    let referenced: Vec<String> = nested.into_iter().map(description).collect();
    let json = format!(
        r#"{{"type_description": {}, "referenced_type_descriptions": [{}]}}"#,
        description(file),
        referenced.join(", ")
    );
    let digits = Hash::hash(json.as_bytes()).iter().map(|byte| format!("{byte:02x}")).collect::<String>();
    format!("RIHS01_{digits}")
}

fn description(file: &MessageFile) -> String {
    let fields: Vec<String> = file.fields.iter().map(field).collect();
    format!(r#"{{"type_name": "{}/msg/{}", "fields": [{}]}}"#, file.package, file.name, fields.join(", "))
}

/// Returns the number of the type, the capacity and the nested type of a field, as in `type_description_interfaces/msg/FieldType`.
pub(crate) fn described(field: &Field) -> (u32, usize, String) {
    let (increment, capacity) = match field.shape {
        Shape::One => (0, 0),
        Shape::Array(length) => (48, length),
        Shape::Sequence => (144, 0),
    };
    let (id, nested) = match &field.base {
        Base::Primitive(p) => (p.type_id, String::new()),
        Base::Message(name) => (1, name.replacen('/', "/msg/", 1)),
    };
    (id + increment, capacity, nested)
}

/// Default values are not part of it.
fn field(field: &Field) -> String {
    let (id, capacity, nested) = described(field);
    format!(
        r#"{{"name": "{}", "type": {{"type_id": {id}, "capacity": {capacity}, "string_capacity": 0, "nested_type_name": "{nested}"}}}}"#,
        field.name
    )
}
