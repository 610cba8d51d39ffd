//! Violations of the rules, as text.

use crate::imports::{imports, paths};
use crate::modules::{Module, ModulePath, declaration};
use petgraph::algo::tarjan_scc;
use petgraph::graphmap::DiGraphMap;
use std::collections::{BTreeMap, BTreeSet};
use syn::{Item, UseTree, Visibility};

/// Groups of modules in which each uses all others of its group, directly or indirectly.
pub(crate) fn circles(modules: &BTreeMap<ModulePath, Module>) -> Vec<String> {
    let imports = imports(modules);
    let number: BTreeMap<&ModulePath, usize> =
        imports.keys().enumerate().map(|(i, path)| (path, i)).collect();
    let names: Vec<String> = imports.keys().map(name).collect();
    let edges = imports.iter().flat_map(|(from, used)| used.iter().map(|to| (number[from], number[to])));
    let graph = DiGraphMap::<usize, ()>::from_edges(edges);
    let in_words = |circle: Vec<usize>| {
        let members: BTreeSet<usize> = circle.into_iter().collect();
        let arrows = graph.all_edges().filter(|(a, b, ())| members.contains(a) && members.contains(b));
        arrows.map(|(a, b, ())| format!("{} -> {}", names[a], names[b])).collect::<Vec<_>>().join(", ")
    };
    tarjan_scc(&graph).into_iter().filter(|group| group.len() > 1).map(in_words).collect()
}

/// Items with two paths: re-exported by a module although the module that defines them is public, too.
pub(crate) fn doubled(modules: &BTreeMap<ModulePath, Module>) -> Vec<String> {
    let mut found = Vec::new();
    for (path, module) in modules {
        let public: BTreeSet<String> = (module.items.iter().filter_map(declaration))
            .filter(|m| matches!(m.vis, Visibility::Public(_)))
            .map(|m| m.ident.to_string())
            .collect();
        for item in &module.items {
            let Item::Use(item) = item else { continue };
            let Some(child) = first_child(&item.tree) else { continue };
            if matches!(item.vis, Visibility::Public(_)) && public.contains(&child) {
                found.push(format!("{}: `{child}` is public and re-exported", name(path)));
            }
        }
    }
    found
}

/// Uses of files, clocks, sockets and processes, and of the environment.
pub(crate) fn outside(modules: &BTreeMap<ModulePath, Module>) -> Vec<String> {
    const OUTSIDE: [&str; 6] = ["env", "fs", "net", "os", "process", "time"];
    let is_outside = |used: &Vec<String>| {
        used[0] == "std" && used.get(1).is_some_and(|part| OUTSIDE.contains(&part.as_str()))
    };
    let of_module = |(path, module): (&ModulePath, &Module)| -> Vec<String> {
        let used = paths(module).into_iter().filter(is_outside);
        used.map(|used| format!("{} uses {}", name(path), used.join("::"))).collect()
    };
    modules.iter().flat_map(of_module).collect()
}

/// The first name of an import that is not `self` or `crate`.
fn first_child(tree: &UseTree) -> Option<String> {
    let UseTree::Path(path) = tree else { return None };
    match path.ident.to_string().as_str() {
        "self" | "crate" => first_child(&path.tree),
        child => Some(child.to_owned()),
    }
}

fn name(path: &ModulePath) -> String {
    if path.is_empty() { "the root".to_owned() } else { path.join("::") }
}
