//! `pip install msgs` would install somebody else's package of that name: texts write `pip install ./msgs`.

use std::path::{Path, PathBuf};

/// Folders of the top that are Python packages or look like ones.
const FOLDERS: [&str; 4] = ["nodes", "msgs", "recordings", "tests"];

/// The folders of the top that `text` installs by a bare name.
fn bare_installs(text: &str) -> Vec<&str> {
    let names = text.split("pip install ").skip(1).filter_map(|rest| rest.split([' ', '`', '\n']).next());
    names.filter(|name| FOLDERS.contains(name)).collect()
}

/// Every text under `folder` that a user may read.
fn texts(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let is_ours = |name: &str| !["vendor", "target", "golden"].contains(&name);
        if path.is_dir() && path.file_name().and_then(|name| name.to_str()).is_some_and(is_ours) {
            texts(&path, found);
        } else if path.extension().is_some_and(|e| ["md", "rs", "py", "html"].iter().any(|known| e == *known))
        {
            found.push(path);
        }
    }
}

#[test]
fn no_text_installs_a_folder_of_the_top_from_the_registry_of_pip() {
    assert_eq!(bare_installs("`pip install msgs` and pip install ./msgs"), ["msgs"]);
    let top = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let mut all = vec![top.join("README.md")];
    ["nodes", "msgs", "recordings", ".github"].iter().for_each(|folder| texts(&top.join(folder), &mut all));
    for file in all {
        let text = String::from_utf8_lossy(&std::fs::read(&file).unwrap()).into_owned();
        assert_eq!(bare_installs(&text), Vec::<&str>::new(), "{}", file.display());
    }
}
