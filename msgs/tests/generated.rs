//! The checked-in types agree with the message files.

#[path = "../examples/generate/generator/mod.rs"]
mod generator;

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

#[test]
fn checked_in_types_are_what_the_generator_writes() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let files = generator::generate(root).unwrap();
    let out = root.join("src/generated");
    for (path, text) in &files {
        let checked_in = std::fs::read_to_string(out.join(path)).unwrap_or_default();
        assert!(
            checked_in == *text,
            "{} is stale: cargo run --release -p grainlab_msgs --example generate",
            path.display()
        );
    }
    let expected: BTreeSet<PathBuf> = files.into_keys().collect();
    let found = files_below(&out).into_iter().map(|p| p.strip_prefix(&out).unwrap().to_path_buf()).collect();
    assert_eq!(expected, found, "files that no message file explains");
}

fn files_below(folder: &Path) -> Vec<PathBuf> {
    let mut files = Vec::new();
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() { files.extend(files_below(&path)) } else { files.push(path) }
    }
    files
}

/// Types that other tools read differently are refused: bounded arrays, wide strings, characters.
#[test]
fn what_tools_disagree_about_is_refused() {
    let folder = tempdir("refused");
    for (declaration, why) in [
        ("float64[<=3] x", "array length"),
        ("float64[0] x", "array length"),
        ("wstring x", "unknown type wstring"),
        ("char x", "unknown type char"),
        ("string X=\"a\"", "literal"),
        ("float64 Force", "lower_snake_case"),
        ("# nothing else", "at least one field"),
        ("Missing x", "no message file defines grainlab_msgs/Missing"),
    ] {
        std::fs::write(folder.join("msg/Broken.msg"), format!("{declaration}\n")).unwrap();
        let fault = generator::generate(&folder).unwrap_err();
        assert!(fault.contains(why), "{declaration}: {fault}");
    }
    std::fs::remove_dir_all(folder).unwrap();
}

fn tempdir(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("{name}-{}", std::process::id()));
    std::fs::create_dir_all(folder.join("msg")).unwrap();
    std::fs::create_dir_all(folder.join("std")).unwrap();
    folder
}
