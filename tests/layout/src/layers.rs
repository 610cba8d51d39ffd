//! The order of crates: each one uses those of its own layer and of the layers below it only.

use std::collections::BTreeMap;
use std::path::Path;

/// The layer of each crate by its folder, 0 at the top, as the table `Layers` of nodes/README.md has them.
fn layers(readme: &str) -> BTreeMap<String, usize> {
    let table = readme.split_once("| layer | crates |").unwrap().1;
    let rows = table.lines().skip(2).take_while(|line| line.starts_with('|'));
    let crates = |row: &str| {
        let cell = row.split('|').nth(2).unwrap().to_owned();
        let names = cell.split('`').skip(1).step_by(2).map(str::to_owned);
        names.collect::<Vec<_>>()
    };
    rows.enumerate().flat_map(|(layer, row)| crates(row).into_iter().map(move |name| (name, layer))).collect()
}

/// The layer of the crate in `folder`, as in `nodes/kernels/dem`.
fn layer_of(folder: &str, layers: &BTreeMap<String, usize>) -> Option<usize> {
    let short = folder.strip_prefix("nodes/").unwrap_or(folder);
    let short = if short.starts_with("kernels/") { "kernels/*" } else { short };
    layers.get(short).copied()
}

/// The uses that go from a lower layer to a higher one, among `members` with their manifests.
fn upward(members: &[(String, String)], layers: &BTreeMap<String, usize>) -> Vec<String> {
    let package = |manifest: &str| {
        let name = manifest.split_once("name = \"").unwrap().1;
        name.split_once('"').unwrap().0.to_owned()
    };
    let folders: BTreeMap<String, &String> = members.iter().map(|(f, m)| (package(m), f)).collect();
    let mut found = Vec::new();
    for (folder, manifest) in members {
        let Some(layer) = layer_of(folder, layers) else {
            found.push(format!("{folder} is in no layer of nodes/README.md"));
            continue;
        };
        let used = manifest.split_once("\n[dependencies]").map_or("", |(_, rest)| rest);
        let used = used.split("\n[").next().unwrap();
        for line in used.lines() {
            let name = line.split(['.', ' ', '=']).next().unwrap();
            let Some(target) = folders.get(name) else { continue };
            if layer_of(target, layers).is_some_and(|below| below < layer) {
                found.push(format!("{folder} uses {target}, which is in a layer above it"));
            }
        }
    }
    found
}

#[test]
fn no_crate_uses_one_of_a_layer_above_it() {
    let top = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let read = |path: &str| std::fs::read_to_string(top.join(path)).unwrap();
    let manifest = read("Cargo.toml");
    let members = manifest.split_once("members = [").unwrap().1.split_once(']').unwrap().0;
    let members = members.split(',').map(|m| m.trim().trim_matches('"')).filter(|m| !m.is_empty());
    let members: Vec<(String, String)> = members
        .filter(|m| !m.starts_with("tests"))
        .map(|m| (m.to_owned(), read(&format!("{m}/Cargo.toml"))))
        .collect();
    let faults = upward(&members, &layers(&read("nodes/README.md")));
    assert!(faults.is_empty(), "\n{}", faults.join("\n"));
}

#[test]
fn a_kernel_that_uses_a_node_is_a_fault() {
    let readme = "| layer | crates | may use |\n|---|---|---|\n| nodes | `a` | all |\n| kernels | `kernels/*` | none |\n";
    let manifest =
        |name: &str, used: &str| format!("[package]\nname = \"{name}\"\n\n[dependencies]\n{used}\n");
    let members = [
        ("nodes/a".to_owned(), manifest("grainlab_a", "grainlab_b.workspace = true")),
        ("nodes/kernels/b".to_owned(), manifest("grainlab_b", "grainlab_a.workspace = true")),
        ("nodes/c".to_owned(), manifest("grainlab_c", "")),
    ];
    let found = upward(&members, &layers(readme));
    assert_eq!(
        found,
        [
            "nodes/kernels/b uses nodes/a, which is in a layer above it",
            "nodes/c is in no layer of nodes/README.md"
        ]
    );
}
