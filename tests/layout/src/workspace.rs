//! The crates of the workspace follow the rules.

use crate::modules::{Module, ModulePath, modules};
use crate::rules;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Roots of the crates in folders that begin with `folder`: `lib.rs` and `main.rs` of the workspace's members.
fn roots(folder: &str) -> Vec<PathBuf> {
    let top = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let manifest = std::fs::read_to_string(top.join("Cargo.toml")).unwrap();
    let members = manifest.split_once("members = [").unwrap().1.split_once(']').unwrap().0;
    let folders = members
        .split(',')
        .map(|m| m.trim().trim_matches('"'))
        .filter(|m| !m.is_empty() && m.starts_with(folder));
    let roots = folders.flat_map(|m| ["lib.rs", "main.rs"].map(|file| top.join(m).join("src").join(file)));
    let roots: Vec<PathBuf> = roots.filter(|root| root.exists()).collect();
    assert!(!roots.is_empty(), "no crate in {folder}");
    roots
}

/// Asserts that `rule` finds no violation in any crate in folders that begin with `folder`.
fn holds(rule: fn(&BTreeMap<ModulePath, Module>) -> Vec<String>, folder: &str) {
    let faults = |root: &PathBuf| {
        let place = root.display().to_string();
        rule(&modules(root)).into_iter().map(move |fault| format!("{place}: {fault}"))
    };
    let faults: Vec<String> = roots(folder).iter().flat_map(faults).collect();
    assert!(faults.is_empty(), "\n{}", faults.join("\n"));
}

#[test]
fn no_crate_has_a_circle_of_imports() {
    holds(rules::circles, "");
}

#[test]
fn no_public_module_is_also_re_exported() {
    holds(rules::doubled, "");
}

#[test]
fn no_kernel_uses_files_clocks_sockets_or_processes() {
    holds(rules::outside, "nodes/kernels");
}
