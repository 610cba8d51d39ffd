//! Packages that the crates of the workspace link, directly and through others.

use cargo_metadata::{DependencyKind, Metadata, MetadataCommand, PackageId};
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

/// RustDDS with our changes.
const DDS: &str = "grainlab_rustdds";

/// Packages that may link DDS: what the nodes are made of, the nodes, and what starts or watches them.
const LINK_DDS: [&str; 13] = [
    "grainlab_acoustic_probe",
    "grainlab_command",
    "grainlab_dem_simulator",
    "grainlab_emt_inversion",
    "grainlab_fabric_analyzer",
    "grainlab_graph",
    "grainlab_launcher",
    "grainlab_live",
    "grainlab_node_kit",
    "grainlab_packing_pictures",
    "grainlab_python",
    "grainlab_recorder",
    "grainlab_servo_controller",
];

/// Crates that read files and must link neither the engine nor a node.
const READERS: [&str; 2] = ["grainlab_recordings", "grainlab_pictures"];

/// Packages by name, each with the names of those it links and with its folder if it is in the workspace. Names of several
/// versions are one.
#[derive(Clone)]
pub(crate) struct Graph {
    pub(crate) links: BTreeMap<String, BTreeSet<String>>,
    pub(crate) folders: BTreeMap<String, String>,
}

impl Graph {
    pub(crate) fn of_workspace() -> Self {
        let manifest = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../Cargo.toml");
        // One platform: otherwise crates of all systems count.
        let options = ["--locked", "--filter-platform", "x86_64-unknown-linux-gnu"].map(str::to_owned);
        let metadata = MetadataCommand::new().manifest_path(manifest).other_options(options).exec().unwrap();
        Self::of(&metadata)
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
        let mut graph = Self { links: BTreeMap::new(), folders: folders.collect() };
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
        assert!(self.links.contains_key(DDS), "no package {DDS}");
        let linking = self.linking(DDS).into_iter().filter(|name| !LINK_DDS.contains(name));
        faults.extend(linking.map(|name| format!("{name} links {DDS}")));
        faults.extend(self.forbidden(&READERS, |name, folder| name == "grainlab_dem" || is_node(folder)));
        for laboratory in ["msgs", "nodes/kernels", "nodes/kit", "nodes/laboratory"] {
            let studio = |_: &str, folder: &str| folder.starts_with("nodes/studio");
            faults.extend(self.forbidden(&self.under(laboratory), studio));
        }
        faults
    }
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
        ("grainlab_core", DDS, "grainlab_emt links grainlab_rustdds"),
        ("grainlab_recordings", "grainlab_dem", "grainlab_recordings links grainlab_dem"),
        ("grainlab_msgs", "grainlab_recorder", "grainlab_recordings links grainlab_recorder"),
        ("grainlab_page", "grainlab_node_kit", "grainlab_report links grainlab_rustdds"),
        ("grainlab_results", "grainlab_report", "grainlab_results links grainlab_report"),
        ("grainlab_launcher", "grainlab_graph", "grainlab_launcher links grainlab_graph"),
    ] {
        let mut graph = workspace.clone();
        graph.links.get_mut(from).unwrap().insert(to.to_owned());
        let faults = graph.faults();
        assert!(faults.iter().any(|fault| fault.contains(expected)), "{from} -> {to}: {faults:?}");
    }
}

/// Names of the packages that the program is built of with these options.
fn tree(more: &[&str]) -> BTreeSet<String> {
    let options = ["tree", "--locked", "-p", "grainlab_command", "-e", "normal", "--prefix", "none"];
    let tree = std::process::Command::new(env!("CARGO"))
        .args([&options, more].concat())
        .current_dir(Path::new(env!("CARGO_MANIFEST_DIR")).join("../.."))
        .output()
        .unwrap();
    let tree = String::from_utf8(tree.stdout).unwrap();
    tree.lines().filter_map(|line| line.split(' ').next()).map(str::to_owned).collect()
}

#[test]
fn the_laboratory_is_built_without_the_studio() {
    let workspace = Graph::of_workspace();
    let studio: BTreeSet<String> = workspace.under("nodes/studio").into_iter().map(str::to_owned).collect();
    assert_eq!(tree(&["--no-default-features"]).intersection(&studio).count(), 0);
    assert_ne!(tree(&[]).intersection(&studio).count(), 0);
}
