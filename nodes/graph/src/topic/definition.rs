//! Definitions of message types: of this project, of ROS 2, and of folders with message files.

use grainlab_any_message::Schema;
use grainlab_console::Failure;
use grainlab_msgs::TypeInfo;
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

/// Between the definitions of a schema text.
const SEPARATOR: &str = "================================================================================";

/// The schema of a type: known to this program, or from a folder that contains `package/msg/Type.msg`.
pub(super) fn schema(type_name: &str, folders: &[PathBuf]) -> Result<Schema, Failure> {
    let text = match folders.iter().find_map(|folder| read(folder, type_name)) {
        Some(root) => with_dependencies(root, type_name, folders),
        None => TypeInfo::by_name(type_name).map(|info| info.definition.to_owned()).ok_or_else(|| {
            Failure::failed(format!(
                "the definition of {type_name} is not known to this program: give a folder that contains {} with --msg-path",
                file(type_name).display()
            ))
        })?,
    };
    Schema::parse(type_name, &text).map_err(|e| Failure::failed(format!("{type_name}: {e}")))
}

/// `package/msg/Type.msg` in a folder.
fn file(type_name: &str) -> PathBuf {
    PathBuf::from(format!("{type_name}.msg"))
}

fn read(folder: &Path, type_name: &str) -> Option<String> {
    // A type name from the network is not a path: it has three parts of letters, digits and underscores.
    let plain = |part: &str| !part.is_empty() && part.chars().all(|c| c.is_ascii_alphanumeric() || c == '_');
    if type_name.split('/').count() != 3 || !type_name.split('/').all(plain) {
        return None;
    }
    std::fs::read_to_string(folder.join(file(type_name))).ok()
}

/// The text with the definitions of all types that it uses; those of the standard come from this program.
fn with_dependencies(root: String, type_name: &str, folders: &[PathBuf]) -> String {
    let mut text = root.clone();
    let mut done = BTreeSet::from([type_name.to_owned()]);
    let mut open = used(&root, type_name);
    while let Some(next) = open.pop() {
        if !done.insert(next.clone()) {
            continue;
        }
        let own = folders.iter().find_map(|folder| read(folder, &next));
        let Some(found) = own.or_else(|| {
            let known = TypeInfo::by_name(&next)?.definition;
            known.split(SEPARATOR).next().map(str::to_owned)
        }) else {
            continue; // The parser names the missing type.
        };
        open.extend(used(&found, &next));
        text += &format!("\n{SEPARATOR}\nMSG: {}\n{found}", next.replace("/msg/", "/"));
    }
    text
}

/// Full names of the types of the fields of a definition.
fn used(text: &str, type_name: &str) -> Vec<String> {
    let package = type_name.split('/').next().unwrap_or_default();
    let field_type = |line: &str| {
        let word = line.split('#').next()?.split_whitespace().next()?;
        let base = word.split(['[', '<']).next()?;
        let full = match base.split('/').collect::<Vec<_>>()[..] {
            [name] if name.starts_with(char::is_uppercase) => format!("{package}/msg/{name}"),
            ["Header"] => "std_msgs/msg/Header".to_owned(),
            [other, name] | [other, "msg", name] => format!("{other}/msg/{name}"),
            _ => return None,
        };
        Some(full)
    };
    text.lines().filter_map(field_type).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use grainlab_any_message::Shown;

    #[test]
    fn a_type_in_a_folder_may_use_others_there_and_those_of_ros() {
        let folder = tempfile::tempdir().unwrap();
        let messages = folder.path().join("demo_msgs/msg");
        std::fs::create_dir_all(&messages).unwrap();
        std::fs::write(messages.join("Pair.msg"), "std_msgs/Header header\nOne[] ones # two\n").unwrap();
        std::fs::write(messages.join("One.msg"), "uint8 value\n").unwrap();
        let found = schema("demo_msgs/msg/Pair", &[folder.path().to_owned()]).unwrap();
        let mut body = vec![0, 1, 0, 0];
        body.extend([5, 0, 0, 0, 6, 0, 0, 0, 2, 0, 0, 0, b'a', 0, 0, 0, 2, 0, 0, 0, 7, 8]);
        let message = found.decode(&body).unwrap();
        let expected =
            r#"{"header":{"stamp":{"sec":5,"nanosec":6},"frame_id":"a"},"ones":[{"value":7},{"value":8}]}"#;
        assert_eq!(Shown::new(&message).json(), expected);
        let error = schema("demo_msgs/msg/Other", &[folder.path().to_owned()]).unwrap_err().to_string();
        assert!(error.contains("demo_msgs/msg/Other.msg"), "{error}");
    }
}
