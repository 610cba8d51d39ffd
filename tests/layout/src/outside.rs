//! A crate outside of the workspace, which has none of its `[patch]` sections, uses ours.

use cargo_metadata::MetadataCommand;
use std::path::Path;

#[test]
fn a_crate_outside_takes_the_bus_by_path_and_has_one_dds() {
    let top = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..").canonicalize().unwrap();
    let folder = tempfile::tempdir().unwrap();
    let path = |krate: &str| format!("{{ path = {:?} }}", top.join(krate));
    let manifest = format!(
        "[package]\nname = \"outside\"\nversion = \"0.1.0\"\nedition = \"2024\"\n\n[dependencies]\ngrainlab = {}\ngrainlab_node_kit = {}\n",
        path("nodes/grainlab"),
        path("nodes/kit/node_kit")
    );
    std::fs::write(folder.path().join("Cargo.toml"), manifest).unwrap();
    std::fs::create_dir(folder.path().join("src")).unwrap();
    std::fs::write(folder.path().join("src/lib.rs"), "").unwrap();
    // Versions that are on this machine already.
    std::fs::copy(top.join("Cargo.lock"), folder.path().join("Cargo.lock")).unwrap();
    let found = MetadataCommand::new()
        .manifest_path(folder.path().join("Cargo.toml"))
        .other_options(["--filter-platform", "x86_64-unknown-linux-gnu"].map(str::to_owned))
        .exec()
        .unwrap();
    let of_dds = |name: &str| {
        ["rustdds", "ros2-client"].iter().any(|n| name.ends_with(&n.replace('-', "_")) || name == *n)
    };
    let mut dds: Vec<&str> = found.packages.iter().map(|p| p.name.as_str()).filter(|n| of_dds(n)).collect();
    dds.sort_unstable();
    assert_eq!(dds, ["grainlab_ros2_client", "grainlab_rustdds"]);
}
