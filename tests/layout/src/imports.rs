//! The modules that each module uses. A re-exported name is resolved to the module that defines it, so that
//! importing through a re-export is not an import of the re-exporting module.

use crate::modules::{Module, ModulePath};
use std::collections::{BTreeMap, BTreeSet};
use syn::punctuated::Punctuated;
use syn::visit::Visit;
use syn::{Item, UseTree};

type Modules = BTreeMap<ModulePath, Module>;

/// For each module the others that it uses.
pub(crate) fn imports(modules: &Modules) -> BTreeMap<ModulePath, BTreeSet<ModulePath>> {
    let aliases: BTreeMap<&ModulePath, Aliases> =
        modules.iter().map(|(path, module)| (path, Aliases::of(path, module, modules))).collect();
    let used_by = |path: &ModulePath, module: &Module| {
        let of_the_crate = paths(module).into_iter().filter_map(|written| absolute(path, &written, modules));
        let mut used: BTreeSet<ModulePath> =
            of_the_crate.filter_map(|target| defining(&target, modules, &aliases)).collect();
        used.remove(path);
        used
    };
    modules.iter().map(|(path, module)| (path.clone(), used_by(path, module))).collect()
}

/// Names that a module imports, each with its path from the crate root.
struct Aliases(BTreeMap<String, Vec<String>>);

impl Aliases {
    fn of(path: &ModulePath, module: &Module, modules: &Modules) -> Self {
        let mut names = BTreeMap::new();
        for item in &module.items {
            let Item::Use(item) = item else { continue };
            for (target, name) in leaves(&item.tree, Vec::new()) {
                if let (Some(target), Some(name)) = (absolute(path, &target, modules), name) {
                    names.insert(name, target);
                }
            }
        }
        Self(names)
    }
}

/// The module that defines `target`, a path from the crate root.
fn defining(
    target: &[String],
    modules: &Modules,
    aliases: &BTreeMap<&ModulePath, Aliases>,
) -> Option<ModulePath> {
    let mut target = target.to_vec();
    // No chain of re-exports is longer than this.
    for _ in 0..16 {
        let depth = (0..=target.len()).rev().find(|d| modules.contains_key(&target[..*d]))?;
        let (module, rest) = (target[..depth].to_vec(), &target[depth..]);
        let passed_on = rest.first().and_then(|name| aliases.get(&module)?.0.get(name));
        match passed_on {
            Some(origin) => target = [origin.as_slice(), &rest[1..]].concat(),
            None => return Some(module),
        }
    }
    None
}

/// Returns every path of two names or more in a module, as written.
pub(crate) fn paths(module: &Module) -> Vec<Vec<String>> {
    let mut paths = Paths(Vec::new());
    module.items.iter().for_each(|item| paths.visit_item(item));
    paths.0
}

struct Paths(Vec<Vec<String>>);

impl<'ast> Visit<'ast> for Paths {
    fn visit_item_use(&mut self, item: &'ast syn::ItemUse) {
        self.0.extend(leaves(&item.tree, Vec::new()).into_iter().map(|(target, _)| target));
    }

    fn visit_path(&mut self, path: &'ast syn::Path) {
        let segments: Vec<String> = path.segments.iter().map(|s| s.ident.to_string()).collect();
        if segments.len() > 1 {
            self.0.push(segments);
        }
        syn::visit::visit_path(self, path);
    }

    // The arguments of `format!`, `assert!` and their kind.
    fn visit_macro(&mut self, called: &'ast syn::Macro) {
        let arguments = Punctuated::<syn::Expr, syn::Token![,]>::parse_terminated;
        let mut inner = Paths(Vec::new());
        called.parse_body_with(arguments).iter().flatten().for_each(|argument| inner.visit_expr(argument));
        self.0.extend(inner.0);
    }

    // In an inline module `super` means another module; inline modules contain tests and constants.
    fn visit_item_mod(&mut self, _: &'ast syn::ItemMod) {}
}

/// A path as written in `module`, from the crate root; `None` if it is outside the crate.
fn absolute(module: &ModulePath, path: &[String], modules: &Modules) -> Option<Vec<String>> {
    let (first, rest) = path.split_first()?;
    match first.as_str() {
        "crate" => Some(rest.to_vec()),
        "self" => Some([module.as_slice(), rest].concat()),
        "super" => {
            let parent = module.split_last()?.1.to_vec();
            match rest.first().map(String::as_str) {
                Some("super") => absolute(&parent, rest, modules),
                _ => Some([parent.as_slice(), rest].concat()),
            }
        }
        child => {
            let inner = [module.as_slice(), &[child.to_owned()]].concat();
            modules.contains_key(&inner).then(|| [module.as_slice(), path].concat())
        }
    }
}

/// The paths of a tree of imports with the names they get; a glob has none.
fn leaves(tree: &UseTree, mut prefix: Vec<String>) -> Vec<(Vec<String>, Option<String>)> {
    let joined = |mut prefix: Vec<String>, name: String| {
        // `x::{self}` means x.
        if name != "self" || prefix.is_empty() {
            prefix.push(name);
        }
        prefix
    };
    match tree {
        UseTree::Path(path) => {
            prefix.push(path.ident.to_string());
            leaves(&path.tree, prefix)
        }
        UseTree::Name(name) => {
            let target = joined(prefix, name.ident.to_string());
            let last = target.last().cloned();
            vec![(target, last)]
        }
        UseTree::Rename(renamed) => {
            vec![(joined(prefix, renamed.ident.to_string()), Some(renamed.rename.to_string()))]
        }
        UseTree::Glob(_) => vec![(prefix, None)],
        UseTree::Group(group) => group.items.iter().flat_map(|t| leaves(t, prefix.clone())).collect(),
    }
}
