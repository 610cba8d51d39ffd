//! The modules of a crate, one file each.

use std::collections::BTreeMap;
use std::path::Path;
use syn::{Attribute, Item, ItemMod};

/// A module's path from the crate root; empty for the root itself.
pub(crate) type ModulePath = Vec<String>;

/// One module: a file, or the root.
pub(crate) struct Module {
    /// Items without those of tests.
    pub(crate) items: Vec<Item>,
}

/// Every module of the crate with the root file `root`. Inline modules belong to the file around them.
///
/// # Panics
/// With the file's name if it cannot be read or parsed.
pub(crate) fn modules(root: &Path) -> BTreeMap<ModulePath, Module> {
    let mut found = BTreeMap::new();
    read(root, root.parent().expect("a file in a folder"), Vec::new(), &mut found);
    found
}

fn read(file: &Path, children: &Path, path: ModulePath, found: &mut BTreeMap<ModulePath, Module>) {
    let text = std::fs::read_to_string(file).unwrap_or_else(|e| panic!("{}: {e}", file.display()));
    let parsed = syn::parse_file(&text).unwrap_or_else(|e| panic!("{}: {e}", file.display()));
    let items: Vec<Item> = parsed.items.into_iter().filter(|item| !is_test(attributes(item))).collect();
    for declared in items.iter().filter_map(declaration) {
        let name = declared.ident.to_string();
        let own_file = children.join(format!("{name}.rs"));
        let file = if own_file.exists() { own_file } else { children.join(&name).join("mod.rs") };
        let path = [path.clone(), vec![name.clone()]].concat();
        read(&file, &children.join(&name), path, found);
    }
    found.insert(path, Module { items });
}

/// The declaration of a module in a separate file.
pub(crate) fn declaration(item: &Item) -> Option<&ItemMod> {
    match item {
        Item::Mod(module) if module.content.is_none() => Some(module),
        _ => None,
    }
}

fn is_test(attributes: &[Attribute]) -> bool {
    attributes
        .iter()
        .any(|a| a.path().is_ident("cfg") && a.parse_args::<syn::Ident>().is_ok_and(|i| i == "test"))
}

fn attributes(item: &Item) -> &[Attribute] {
    match item {
        Item::Const(i) => &i.attrs,
        Item::Fn(i) => &i.attrs,
        Item::Impl(i) => &i.attrs,
        Item::Mod(i) => &i.attrs,
        Item::Struct(i) => &i.attrs,
        Item::Trait(i) => &i.attrs,
        Item::Use(i) => &i.attrs,
        _ => &[],
    }
}
