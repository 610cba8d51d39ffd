//! Definitions of message types: of this project, of ROS 2, and of folders with message files.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use grainlab_any_message::Schema;
use grainlab_msgs::{INTERFACES, TypeInfo};

use grainlab_console::input;

const SEPARATOR: &str = "================================================================================";

/// The types of this program's nodes, then those in folders that contain `package/msg/Type.msg`, then the common interfaces of ROS 2.
#[derive(Clone, Debug, Default)]
pub struct Definitions {
    folders: Vec<PathBuf>,
}

impl Definitions {
    /// With these folders, the first of which takes precedence.
    pub fn with_folders(folders: &[PathBuf]) -> Self {
        Self { folders: folders.to_owned() }
    }

    /// The schema text of `package/msg/Type` with all types that it uses, as rosbag2 writes it (`ros2msg`).
    ///
    /// `hash` is that of the writer, or empty: a type of this program with another hash is another version, and not taken.
    ///
    /// # Errors
    /// If no definition is found, or one is not valid.
    pub fn text(&self, type_name: &str, hash: &str) -> Result<String, String> {
        let same = |info: &&TypeInfo| hash.is_empty() || hash == info.hash;
        if let Some(info) = TypeInfo::by_name(type_name).filter(same) {
            return Ok(info.definition.to_owned());
        }
        let Some(root) = self.read(type_name)? else {
            return Err(format!(
                "the definition of {type_name} is not known to this program: give a folder that contains {type_name}.msg with \
                 --msg-path"
            ));
        };
        let text = self.with_dependencies(root, type_name)?;
        match Schema::parse(type_name, &text) {
            Ok(_) => Ok(text),
            Err(fault) => Err(format!("{type_name} from --msg-path: {fault}")),
        }
    }

    /// Place of the definition of a type, in words.
    pub fn place(&self, type_name: &str) -> String {
        let path = self.file(type_name).filter(|_| TypeInfo::by_name(type_name).is_none());
        path.map_or_else(|| "that of this program".to_owned(), |path| path.display().to_string())
    }

    /// Full names of all types: messages, and services of the common interfaces.
    pub fn names(&self) -> BTreeSet<String> {
        let files = self.folders.iter().flat_map(|folder| files_below(folder));
        let paths = files.chain(INTERFACES.iter().map(|(path, _)| PathBuf::from(path)));
        let known = TypeInfo::all().iter().map(|info| info.type_name.to_owned());
        known.chain(paths.map(|path| path.with_extension("").to_string_lossy().into_owned())).collect()
    }

    /// The two texts of a service of the common interfaces: request, `---`, answer.
    pub fn service(&self, type_name: &str) -> Option<&'static str> {
        interface(&format!("{type_name}.srv"))
    }

    fn file(&self, type_name: &str) -> Option<PathBuf> {
        // A type name from the network is not a path: it has three parts of letters, digits and underscores.
        let plain =
            |part: &str| !part.is_empty() && part.chars().all(|c| c.is_ascii_alphanumeric() || c == '_');
        let is_plain = type_name.split('/').count() == 3 && type_name.split('/').all(plain);
        let files = self.folders.iter().map(|folder| folder.join(format!("{type_name}.msg")));
        files.filter(|_| is_plain).find(|path| path.exists())
    }

    fn read(&self, type_name: &str) -> Result<Option<String>, String> {
        let Some(path) = self.file(type_name) else {
            return Ok(interface(&format!("{type_name}.msg")).map(str::to_owned));
        };
        let unread = |e| format!("{}: cannot read the definition of a message: {e}", path.display());
        input::text(&path, input::SETTINGS).map(Some).map_err(unread)
    }

    fn with_dependencies(&self, root: String, type_name: &str) -> Result<String, String> {
        let mut text = root.clone();
        let mut done = BTreeSet::from([type_name.to_owned()]);
        let mut open = used(&root, type_name);
        while let Some(next) = open.pop() {
            if !done.insert(next.clone()) {
                continue;
            }
            let known = TypeInfo::by_name(&next).and_then(|info| info.definition.split(SEPARATOR).next());
            // The parser names a type that is missing.
            let Some(found) = known.map(|t| Ok(t.to_owned())).or_else(|| self.read(&next).transpose()) else {
                continue;
            };
            let found = found?;
            open.extend(used(&found, &next));
            text += &format!("\n{SEPARATOR}\nMSG: {}\n{found}", next.replace("/msg/", "/"));
        }
        Ok(text)
    }
}

fn interface(file: &str) -> Option<&'static str> {
    INTERFACES.iter().find(|(path, _)| *path == file).map(|(_, text)| *text)
}

/// Paths `package/msg/Type.msg` below a folder.
fn files_below(folder: &Path) -> Vec<PathBuf> {
    let entries = |path: PathBuf| std::fs::read_dir(path).into_iter().flatten().flatten().map(|e| e.path());
    let files = entries(folder.to_owned()).flat_map(|package| entries(package.join("msg")));
    let is_message = |path: &PathBuf| path.extension().is_some_and(|e| e == "msg");
    files.filter(is_message).filter_map(|path| Some(path.strip_prefix(folder).ok()?.to_owned())).collect()
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

    fn folder(files: &[(&str, &str)]) -> (tempfile::TempDir, Definitions) {
        let folder = tempfile::tempdir().unwrap();
        for (name, text) in files {
            let path = folder.path().join(name);
            std::fs::create_dir_all(path.parent().unwrap()).unwrap();
            std::fs::write(path, text).unwrap();
        }
        let definitions = Definitions::with_folders(&[folder.path().to_owned()]);
        (folder, definitions)
    }

    #[test]
    fn a_type_in_a_folder_may_use_others_there_and_those_of_ros() {
        let (_folder, definitions) = folder(&[
            ("demo_msgs/msg/Pair.msg", "std_msgs/Header header\nOne[] ones # two\n"),
            ("demo_msgs/msg/One.msg", "uint8 value\n"),
        ]);
        let text = definitions.text("demo_msgs/msg/Pair", "").unwrap();
        let schema = Schema::parse("demo_msgs/msg/Pair", &text).unwrap();
        let mut body = vec![0, 1, 0, 0];
        body.extend([5, 0, 0, 0, 6, 0, 0, 0, 2, 0, 0, 0, b'a', 0, 0, 0, 2, 0, 0, 0, 7, 8]);
        let message = schema.decode(&body).unwrap();
        let expected =
            r#"{"header":{"stamp":{"sec":5,"nanosec":6},"frame_id":"a"},"ones":[{"value":7},{"value":8}]}"#;
        assert_eq!(grainlab_any_message::Shown::new(&message).json(), expected);
        let error = definitions.text("demo_msgs/msg/Other", "").unwrap_err();
        assert!(error.contains("demo_msgs/msg/Other.msg") && error.contains("--msg-path"), "{error}");
        assert!(definitions.text("../../etc/passwd", "").is_err());
    }

    #[test]
    fn our_own_type_comes_first_unless_the_writer_has_another_version() {
        let (_folder, definitions) = folder(&[("rosgraph_msgs/msg/Clock.msg", "uint8 other\n")]);
        let ours = TypeInfo::by_name("rosgraph_msgs/msg/Clock").unwrap();
        assert_eq!(definitions.text(ours.type_name, "").unwrap(), ours.definition);
        assert_eq!(definitions.text(ours.type_name, ours.hash).unwrap(), ours.definition);
        assert_eq!(definitions.text(ours.type_name, "RIHS01_00").unwrap(), "uint8 other\n");
    }

    #[test]
    fn a_message_file_that_is_not_valid_is_named_with_its_line() {
        let (_folder, definitions) = folder(&[("a_msgs/msg/B.msg", "uint8 a\nuint8 1a\n")]);
        let error = definitions.text("a_msgs/msg/B", "").unwrap_err();
        assert!(error.contains("a_msgs/msg/B") && error.contains("line 2"), "{error}");
    }
}
