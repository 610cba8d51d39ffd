//! RIHS01 type hashes: SHA-256 of the type description in canonical JSON (REP-2016).

use super::Library;
use super::parse::{Base, Field, MessageFile, Shape};
use sha2::{Digest, Sha256};
use std::collections::BTreeSet;
use std::fmt::Write;

/// The hash of `file`, as `RIHS01_` and 64 hexadecimal digits.
pub(crate) fn rihs01(file: &MessageFile, library: &Library) -> Result<String, String> {
    let mut names = BTreeSet::new();
    references(file, library, &mut names)?;
    let mut referenced = Vec::new();
    for name in &names {
        referenced.push(description(lookup(name, library)?));
    }
    let json = format!(
        r#"{{"type_description": {}, "referenced_type_descriptions": [{}]}}"#,
        description(file),
        referenced.join(", ")
    );
    let mut hash = String::from("RIHS01_");
    for byte in Sha256::digest(json.as_bytes()) {
        write!(hash, "{byte:02x}").map_err(|e| e.to_string())?;
    }
    Ok(hash)
}

/// The message called "package/Name".
pub(crate) fn lookup<'a>(name: &str, library: &'a Library) -> Result<&'a MessageFile, String> {
    library.get(name).ok_or_else(|| format!("no message file defines {name}"))
}

fn references(file: &MessageFile, library: &Library, names: &mut BTreeSet<String>) -> Result<(), String> {
    for name in file.dependencies() {
        if names.insert(name.to_owned()) {
            references(lookup(name, library)?, library, names)?;
        }
    }
    Ok(())
}

fn description(file: &MessageFile) -> String {
    let fields: Vec<String> = file.fields.iter().map(field).collect();
    format!(r#"{{"type_name": "{}/msg/{}", "fields": [{}]}}"#, file.package, file.name, fields.join(", "))
}

/// Number of the type, capacity and nested type of a field, as in `type_description_interfaces/msg/FieldType`.
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
