//! The crates of the workspace follow the rules.

use crate::modules::{Module, ModulePath, modules};
use crate::rules;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Roots of all crates: `lib.rs` and `main.rs` under the folders of the workspace's members.
pub(crate) fn roots() -> Vec<PathBuf> {
    let top = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let manifest = std::fs::read_to_string(top.join("Cargo.toml")).unwrap();
    let members = manifest.split_once("members = [").unwrap().1.split_once(']').unwrap().0;
    let folders = members.split(',').map(|m| m.trim().trim_matches('"')).filter(|m| !m.is_empty());
    let roots = folders.flat_map(|m| ["lib.rs", "main.rs"].map(|file| top.join(m).join("src").join(file)));
    let roots: Vec<PathBuf> = roots.filter(|root| root.exists()).collect();
    assert!(roots.len() > 10, "{roots:?}");
    roots
}

/// Asserts that `rule` finds no violation in any crate.
fn holds(rule: fn(&BTreeMap<ModulePath, Module>) -> Vec<String>) {
    let faults = |root: &PathBuf| {
        let place = root.display().to_string();
        rule(&modules(root)).into_iter().map(move |fault| format!("{place}: {fault}"))
    };
    let faults: Vec<String> = roots().iter().flat_map(faults).collect();
    assert!(faults.is_empty(), "\n{}", faults.join("\n"));
}

#[test]
fn no_crate_has_a_circle_of_imports() {
    holds(rules::circles);
}

#[test]
fn no_public_module_is_also_re_exported() {
    holds(rules::doubled);
}

#[test]
fn no_file_is_longer_than_500_lines() {
    holds(rules::long_files);
}
