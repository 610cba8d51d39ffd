//! The order of crates: each one uses those of its own layer and of the layers below it only.

use crate::dependencies::Graph;
use std::collections::BTreeMap;

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

/// The uses that go from a lower layer to a higher one.
fn upward(graph: &Graph, layers: &BTreeMap<String, usize>) -> Vec<String> {
    let mut found = Vec::new();
    for (name, folder) in
        graph.folders.iter().filter(|(_, folder)| !folder.starts_with("tests") && !folder.contains("vendor"))
    {
        let Some(layer) = layer_of(folder, layers) else {
            found.push(format!("{folder} is in no layer of nodes/README.md"));
            continue;
        };
        for target in graph.links[name].iter().filter_map(|used| graph.folders.get(used)) {
            if layer_of(target, layers).is_some_and(|below| below < layer) {
                found.push(format!("{folder} uses {target}, which is in a layer above it"));
            }
        }
    }
    found
}

#[test]
fn no_crate_uses_one_of_a_layer_above_it() {
    let readme = concat!(env!("CARGO_MANIFEST_DIR"), "/../../nodes/README.md");
    let layers = layers(&std::fs::read_to_string(readme).unwrap());
    let faults = upward(&Graph::of_workspace(), &layers);
    assert!(faults.is_empty(), "\n{}", faults.join("\n"));
}

#[test]
fn a_kernel_that_uses_a_node_is_a_fault() {
    let readme = "| layer | crates | may use |\n|---|---|---|\n| nodes | `a` | all |\n| kernels | `kernels/*` | none |\n";
    let uses = [("a", "nodes/a", &["b"][..]), ("b", "nodes/kernels/b", &["a"]), ("c", "nodes/c", &[])];
    let links = uses.map(|(name, _, used)| (name.to_owned(), used.iter().map(|u| (*u).to_owned()).collect()));
    let folders = uses.map(|(name, folder, _)| (name.to_owned(), folder.to_owned()));
    let graph = Graph { links: links.into(), folders: folders.into() };
    assert_eq!(
        upward(&graph, &layers(readme)),
        [
            "nodes/kernels/b uses nodes/a, which is in a layer above it",
            "nodes/c is in no layer of nodes/README.md"
        ]
    );
}
