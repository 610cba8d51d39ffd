//! The commit that the recorder is built from, for the metadata of its recordings.

use std::process::Command;

/// Changes with every commit and checkout. A package has no such file, and its commit is unknown.
const LOG: &str = "../../../.git/logs/HEAD";

fn main() {
    println!("cargo:rerun-if-changed=build.rs");
    if !std::path::Path::new(LOG).exists() {
        return;
    }
    println!("cargo:rerun-if-changed={LOG}");
    let described =
        Command::new("git").args(["describe", "--always", "--exclude=*", "--abbrev=40", "--dirty"]).output();
    if let Some(output) = described.ok().filter(|output| output.status.success()) {
        println!("cargo:rustc-env=GRAINLAB_COMMIT={}", String::from_utf8_lossy(&output.stdout).trim());
    }
}
