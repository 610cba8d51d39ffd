//! Packages that the crates of the workspace link, directly and through others.

use cargo_metadata::{DependencyKind, Metadata, MetadataCommand, PackageId};
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

/// RustDDS with our changes.
const DDS: &str = "grainlab_rustdds";

/// Packages of the workspace that may link DDS.
const LINK_DDS: usize = 15;

/// Packages that the binary links, with those of the workspace and procedural macros.
const IN_BINARY: usize = 255;

/// Crates that read files and must link neither the engine nor a node.
const READERS: [&str; 2] = ["grainlab_recordings", "grainlab_pictures"];

/// Crates of pages. None links the bus; only the live page does.
const PAGES: [&str; 4] = ["grainlab_page", "grainlab_report", "grainlab_reproduce", "grainlab_viewer"];

/// Packages by name, each with the names of those it links and with its folder if it is in the workspace. Names of several
/// versions are one.
#[derive(Clone)]
struct Graph {
    links: BTreeMap<String, BTreeSet<String>>,
    folders: BTreeMap<String, String>,
    /// Packages that the metadata list for optional features which nothing switches on.
    never_built: BTreeSet<String>,
}

impl Graph {
    fn of_workspace() -> Self {
        let mut graph = Self::built();
        let built = in_command(&[]);
        assert!(built.contains(DDS), "cargo tree has no {DDS}");
        graph.never_built = graph.links.keys().filter(|p| !built.contains(*p)).cloned().collect();
        graph
    }

    fn built() -> Self {
        let manifest = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../Cargo.toml");
        // One platform: otherwise crates of all systems count.
        let options = ["--locked", "--filter-platform", "x86_64-unknown-linux-gnu"];
        let command = &mut MetadataCommand::new();
        let options = options.map(str::to_owned).to_vec();
        Self::of(&command.manifest_path(manifest).other_options(options).exec().unwrap())
    }

    fn of(metadata: &Metadata) -> Self {
        let name = |id: &PackageId| metadata[id].name.to_string();
        let nodes = &metadata.resolve.as_ref().unwrap().nodes;
        let links = nodes.iter().map(|node| {
            let linked =
                node.deps.iter().filter(|d| d.dep_kinds.iter().any(|k| k.kind == DependencyKind::Normal));
            (name(&node.id), linked.map(|d| name(&d.pkg)).collect())
        });
        let top = &metadata.workspace_root;
        let folders = metadata.workspace_packages().into_iter().map(|package| {
            let folder = package.manifest_path.parent().unwrap().strip_prefix(top).unwrap();
            (package.name.to_string(), folder.to_string())
        });
        let mut graph =
            Self { links: BTreeMap::new(), folders: folders.collect(), never_built: BTreeSet::new() };
        for (from, to) in links.collect::<Vec<(String, BTreeSet<String>)>>() {
            graph.links.entry(from).or_default().extend(to);
        }
        graph
    }

    /// All that `name` links, directly or through others.
    fn closure(&self, name: &str) -> BTreeSet<&str> {
        let mut found = BTreeSet::new();
        let mut open: Vec<&str> = self.links.keys().map(String::as_str).filter(|n| *n == name).collect();
        while let Some(next) = open.pop() {
            let new = self.links.get(next).into_iter().flatten().map(String::as_str);
            open.extend(new.filter(|n| found.insert(*n)));
        }
        found
    }

    /// Packages of the workspace that link `target`, without tests and vendored crates.
    fn linking(&self, target: &str) -> Vec<&str> {
        let outside = |folder: &str| folder.starts_with("tests") || folder.contains("vendor");
        let members =
            self.folders.iter().filter(|(_, folder)| !outside(folder)).map(|(name, _)| name.as_str());
        members.filter(|name| self.closure(name).contains(target)).collect()
    }

    /// More than `limit` packages of the workspace link `target`.
    fn spread(&self, target: &str, limit: usize) -> Option<String> {
        assert!(self.links.contains_key(target), "no package {target}");
        let linking = self.linking(target);
        let text = || format!("{} packages link {target}, at most {limit} may: {linking:?}", linking.len());
        (linking.len() > limit).then(text)
    }

    /// Packages of `forbidden` that `names` link, a test of a package's name and its folder.
    fn forbidden(&self, names: &[&str], forbidden: impl Fn(&str, &str) -> bool) -> Vec<String> {
        let of = |name: &&str| -> Vec<String> {
            assert!(self.folders.contains_key(*name), "no crate {name}");
            let folder = |linked: &str| self.folders.get(linked).map_or("", String::as_str);
            let closure = self.closure(name);
            let linked = closure.into_iter().filter(|linked| forbidden(linked, folder(linked)));
            linked.map(|linked| format!("{name} links {linked}")).collect()
        };
        names.iter().flat_map(of).collect()
    }

    /// Crates in folders that begin with `folder`.
    fn under(&self, folder: &str) -> Vec<&str> {
        let members = self.folders.iter().filter(|(_, f)| f.starts_with(folder));
        members.map(|(name, _)| name.as_str()).collect()
    }

    fn faults(&self) -> Vec<String> {
        let mut faults = Vec::new();
        faults.extend(self.spread(DDS, LINK_DDS));
        faults.extend(self.forbidden(&READERS, |name, folder| name == "grainlab_dem" || is_node(folder)));
        faults.extend(self.forbidden(&PAGES, |name, _| [DDS, "grainlab_node_kit"].contains(&name)));
        for laboratory in ["msgs", "recordings", "nodes/kernels", "nodes/kit", "nodes/laboratory"] {
            let studio = |_: &str, folder: &str| folder.starts_with("nodes/studio");
            faults.extend(self.forbidden(&self.under(laboratory), studio));
        }
        let packages =
            self.closure("grainlab_command").iter().filter(|p| !self.never_built.contains(**p)).count();
        if packages > IN_BINARY {
            faults.push(format!("the binary has {packages} packages, at most {IN_BINARY} are allowed"));
        }
        faults
    }
}

/// Packages that the command links with these options. Metadata would add the features that other members switch on.
fn in_command(options: &[&str]) -> BTreeSet<String> {
    let tree = ["tree", "--locked", "-p", "grainlab_command", "-e", "normal", "--prefix", "none"];
    let found = std::process::Command::new(env!("CARGO"))
        .args([&tree, options].concat())
        .current_dir(Path::new(env!("CARGO_MANIFEST_DIR")).join("../.."))
        .output()
        .unwrap();
    let text = String::from_utf8(found.stdout).unwrap();
    text.lines().filter_map(|line| Some(line.split(' ').next()?.to_owned())).collect()
}

fn is_node(folder: &str) -> bool {
    const NOT_NODES: [&str; 2] = ["launcher", "results"];
    folder.strip_prefix("nodes/laboratory/").is_some_and(|name| !NOT_NODES.contains(&name))
}

#[test]
fn layers_hold_through_all_dependencies() {
    let faults = Graph::of_workspace().faults();
    assert!(faults.is_empty(), "\n{}", faults.join("\n"));
}

/// Every rule, on the workspace with one more dependency.
#[test]
fn a_planted_dependency_is_a_fault() {
    let workspace = Graph::of_workspace();
    for (from, to, expected) in [
        ("grainlab_core", DDS, "packages link grainlab_rustdds"),
        ("grainlab_recordings", "grainlab_dem", "grainlab_recordings links grainlab_dem"),
        ("grainlab_msgs", "grainlab_recorder", "grainlab_recordings links grainlab_recorder"),
        ("grainlab_page", "grainlab_node_kit", "grainlab_report links grainlab_node_kit"),
        ("grainlab_results", "grainlab_report", "grainlab_results links grainlab_report"),
        ("grainlab_launcher", "grainlab_foxglove_bridge", "grainlab_launcher links grainlab_foxglove_bridge"),
        ("grainlab_command", "one more", "the binary has"),
    ] {
        let mut graph = workspace.clone();
        graph.links.get_mut(from).unwrap().insert(to.to_owned());
        let faults = graph.faults();
        assert!(faults.iter().any(|fault| fault.contains(expected)), "{from} -> {to}: {faults:?}");
    }
}

#[test]
fn the_laboratory_is_built_without_the_studio() {
    let workspace = Graph::of_workspace();
    let studio = |options: &[&str]| {
        let linked = in_command(options);
        workspace.under("nodes/studio").into_iter().filter(|name| linked.contains(*name)).count()
    };
    assert_eq!(studio(&["--no-default-features"]), 0);
    assert!(studio(&[]) > 0);
}

/// A folder whose names fit on a line shows what there is.
#[test]
fn nodes_has_at_most_12_names() {
    let nodes = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../nodes");
    let names: Vec<_> = std::fs::read_dir(nodes).unwrap().map(|entry| entry.unwrap().file_name()).collect();
    let too_many = |names: &[_]| names.len() > 12;
    assert!(!too_many(&names), "{} names: {names:?}", names.len());
    assert!(too_many(&vec!["planted".into(); 13]));
}
