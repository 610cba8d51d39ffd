//! The crates of the workspace follow the rules.

use layout::modules::{Module, ModulePath, modules};
use layout::rules;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Crates that still have circles of imports or public modules that are re-exported. No crate may be added.
const UNFINISHED: [&str; 0] = [];

/// Roots of all crates: `lib.rs` and `main.rs` under the folders of the workspace's members.
fn roots() -> Vec<PathBuf> {
    let top = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let manifest = std::fs::read_to_string(top.join("Cargo.toml")).unwrap();
    let members = manifest.split_once("members = [").unwrap().1.split_once(']').unwrap().0;
    let folders = members.split(',').map(|m| m.trim().trim_matches('"')).filter(|m| !m.is_empty());
    let roots = folders.flat_map(|m| ["lib.rs", "main.rs"].map(|file| top.join(m).join("src").join(file)));
    let roots: Vec<PathBuf> = roots.filter(|root| root.exists()).collect();
    assert!(roots.len() > 10, "{roots:?}");
    roots
}

/// Asserts that `rule` finds no violation in any crate except these.
fn holds(rule: fn(&BTreeMap<ModulePath, Module>) -> Vec<String>, but: &[&str]) {
    let faults: Vec<String> = roots()
        .iter()
        .filter(|root| !but.iter().any(|krate| root.parent().unwrap().ends_with(format!("{krate}/src"))))
        .flat_map(|root| {
            rule(&modules(root)).into_iter().map(move |fault| format!("{}: {fault}", root.display()))
        })
        .collect();
    assert!(faults.is_empty(), "\n{}", faults.join("\n"));
}

#[test]
fn no_crate_has_a_circle_of_imports() {
    holds(rules::circles, &UNFINISHED);
}

#[test]
fn no_public_module_is_also_re_exported() {
    holds(rules::doubled, &UNFINISHED);
}

#[test]
fn no_file_is_longer_than_500_lines() {
    holds(rules::long_files, &[]);
}
