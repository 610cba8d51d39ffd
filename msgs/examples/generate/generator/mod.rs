//! Message files to Rust: parse, hash, write. Shared by the example that writes the files and the test that compares.

mod parse;
mod rust;
mod type_hash;

use parse::MessageFile;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Every message file, by "package/Name".
pub(crate) type Library = BTreeMap<String, MessageFile>;

/// Text of every generated file, by path below `src/generated`.
pub(crate) fn generate(root: &Path) -> Result<BTreeMap<PathBuf, String>, String> {
    let library = load(root)?;
    let mut files = BTreeMap::new();
    let mut packages: BTreeMap<&str, Vec<&MessageFile>> = BTreeMap::new();
    for file in library.values() {
        packages.entry(&file.package).or_default().push(file);
        let path = Path::new(&file.package).join(format!("{}.rs", rust::snake_case(&file.name)));
        files.insert(path, rust::message(file, &library)?);
    }
    for (package, messages) in &packages {
        files.insert(Path::new(package).join("mod.rs"), rust::package(package, messages));
    }
    files.insert(PathBuf::from("mod.rs"), rust::root(&library));
    Ok(files)
}

/// The messages of this project in `msg/`, the standard ones in `std/<package>/msg/`.
fn load(root: &Path) -> Result<Library, String> {
    let mut library = Library::new();
    let mut folders = vec![("grainlab_msgs".to_owned(), PathBuf::from("msg"))];
    for package in sorted(&root.join("std"))? {
        if root.join("std").join(&package).is_dir() {
            folders.push((package.clone(), Path::new("std").join(package).join("msg")));
        }
    }
    for (package, folder) in folders {
        for name in sorted(&root.join(&folder))? {
            let Some(name) = name.strip_suffix(".msg") else { continue };
            let path = folder.join(format!("{name}.msg"));
            let text =
                std::fs::read_to_string(root.join(&path)).map_err(|e| format!("{}: {e}", path.display()))?;
            let path = path.to_str().ok_or("a path that is not UTF-8")?;
            let file = MessageFile::parse(&package, name, path, &text).map_err(|e| format!("{path}: {e}"))?;
            library.insert(format!("{package}/{name}"), file);
        }
    }
    Ok(library)
}

fn sorted(folder: &Path) -> Result<Vec<String>, String> {
    let mut names = Vec::new();
    for entry in std::fs::read_dir(folder).map_err(|e| format!("{}: {e}", folder.display()))? {
        let entry = entry.map_err(|e| e.to_string())?;
        names.push(entry.file_name().into_string().map_err(|name| format!("{name:?} is not UTF-8"))?);
    }
    names.sort();
    Ok(names)
}
