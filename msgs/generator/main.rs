//! Writes the Rust types of the message files to `OUT_DIR`, as rosidl does for other languages.

mod parse;
mod rust;
mod type_hash;

use parse::MessageFile;
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

/// Every message file, by "package/Name".
pub(crate) type Library = BTreeMap<String, MessageFile>;

fn main() {
    for folder in ["msg", "std", "interfaces"] {
        println!("cargo::rerun-if-changed={folder}");
    }
    let out = PathBuf::from(std::env::var_os("OUT_DIR").expect("cargo sets OUT_DIR"));
    let write = |(name, text): (&str, String)| {
        let path = out.join(name);
        fs::write(&path, text).map_err(|e| format!("{}: {e}", path.display()))
    };
    // Cargo runs this in the folder of the crate.
    if let Err(fault) = generate(Path::new("")).and_then(|files| files.into_iter().try_for_each(write)) {
        println!("cargo::error={fault}");
    }
}

/// Returns the generated files, each with its name: the types, and for tests a macro that goes through them.
pub(crate) fn generate(root: &Path) -> Result<[(&'static str, String); 2], String> {
    let library = library(root)?;
    let types = rust::types(&library) + &rust::interfaces(&texts(&root.join("interfaces"))?);
    Ok([("types.rs", types), ("for_every_type.rs", rust::for_every_type(&library))])
}

/// Reads the messages of this project in `msg/` and the standard ones in `std/PACKAGE/msg/`.
fn library(root: &Path) -> Result<Library, String> {
    let mut library = Library::new();
    for folder in ["msg", "std"] {
        for (path, text) in texts(&root.join(folder))? {
            let package = path.split_once('/').map_or("grainlab_msgs", |(package, _)| package);
            let file = MessageFile::parse(package, &format!("{folder}/{path}"), text)?;
            library.insert(format!("{package}/{}", file.name), file);
        }
    }
    library.values().try_for_each(|file| file.check_nested(&library))?;
    Ok(library)
}

/// Returns the texts of the message and service files under a folder, by their path in it.
fn texts(folder: &Path) -> Result<BTreeMap<String, String>, String> {
    let mut found = BTreeMap::new();
    for entry in fs::read_dir(folder).map_err(|e| format!("{}: {e}", folder.display()))? {
        let path = entry.map_err(|e| format!("{}: {e}", folder.display()))?.path();
        let fault = |problem: String| format!("{}: {problem}", path.display());
        let name = path.file_name().and_then(|name| name.to_str());
        let name = name.ok_or_else(|| fault("the name is not UTF-8".into()))?;
        if path.is_dir() {
            found.extend(texts(&path)?.into_iter().map(|(inner, text)| (format!("{name}/{inner}"), text)));
        } else if name.ends_with(".msg") || name.ends_with(".srv") {
            found.insert(name.to_owned(), fs::read_to_string(&path).map_err(|e| fault(e.to_string()))?);
        }
    }
    Ok(found)
}
