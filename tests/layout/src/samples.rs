//! The rules detect violations, in small crates made for the tests.

use crate::modules::modules;
use crate::rules::{circles, doubled, outside};
use std::path::PathBuf;

/// A crate of these files, removed when dropped.
struct Sample(tempfile::TempDir);

impl Sample {
    fn new(files: &[(&str, &str)]) -> Self {
        let folder = tempfile::tempdir().unwrap();
        for (name, text) in files {
            let path = folder.path().join(name);
            std::fs::create_dir_all(path.parent().unwrap()).unwrap();
            std::fs::write(path, text).unwrap();
        }
        Self(folder)
    }

    fn root(&self) -> PathBuf {
        self.0.path().join("lib.rs")
    }
}

#[test]
fn two_files_that_use_each_other_are_a_circle() {
    let sample = Sample::new(&[
        ("lib.rs", "mod a; mod b;"),
        ("a.rs", "use crate::b::B; pub struct A(B);"),
        ("b.rs", "pub struct B; fn f() { super::a::A; }"),
    ]);
    assert_eq!(circles(&modules(&sample.root())), ["a -> b, b -> a"]);
}

#[test]
fn what_the_argument_of_a_macro_uses_counts() {
    let sample = Sample::new(&[
        ("lib.rs", "mod a; mod b;"),
        ("a.rs", "use crate::b::B; pub struct A(B);"),
        ("b.rs", "pub struct B; fn f() { format!(\"{}\", super::a::A(B)); }"),
    ]);
    assert_eq!(circles(&modules(&sample.root())), ["a -> b, b -> a"]);
}

#[test]
fn a_parent_and_a_child_that_use_each_other_are_a_circle() {
    let sample = Sample::new(&[
        ("lib.rs", "mod a;"),
        ("a.rs", "mod inner; use inner::Inner; pub struct Settings; fn f(_: Inner) {}"),
        ("a/inner.rs", "use super::Settings; pub struct Inner(Settings);"),
    ]);
    assert_eq!(circles(&modules(&sample.root())), ["a -> a::inner, a::inner -> a"]);
}

#[test]
fn a_name_taken_through_the_root_leads_to_the_file_that_defines_it() {
    let sample = Sample::new(&[
        ("lib.rs", "mod a; mod b; pub use a::A; pub use b::B;"),
        ("a.rs", "pub struct A;"),
        ("b.rs", "use crate::A; pub struct B(A);"),
    ]);
    assert!(circles(&modules(&sample.root())).is_empty());
}

#[test]
fn what_tests_import_does_not_count() {
    let sample = Sample::new(&[
        ("lib.rs", "mod a; mod b;"),
        ("a.rs", "use crate::b::B; pub struct A(B);"),
        ("b.rs", "pub struct B; #[cfg(test)] mod tests { use crate::a::A; }"),
    ]);
    assert!(circles(&modules(&sample.root())).is_empty());
}

#[test]
fn a_public_module_whose_items_are_re_exported_has_two_paths() {
    let sample = Sample::new(&[
        ("lib.rs", "pub mod a; mod b; pub use a::A; pub use b::B;"),
        ("a.rs", "pub struct A;"),
        ("b.rs", "pub struct B;"),
    ]);
    assert_eq!(doubled(&modules(&sample.root())), ["the root: `a` is public and re-exported"]);
}

#[test]
fn files_clocks_sockets_and_processes_are_outside() {
    let sample = Sample::new(&[
        ("lib.rs", "mod a; use std::{collections::BTreeMap, fs}; fn f() { std::process::exit(1); }"),
        ("a.rs", "use std::time::Instant; fn f() { format!(\"{:?}\", std::net::Ipv4Addr::LOCALHOST); }"),
    ]);
    assert_eq!(
        outside(&modules(&sample.root())),
        [
            "the root uses std::fs",
            "the root uses std::process::exit",
            "a uses std::time::Instant",
            "a uses std::net::Ipv4Addr::LOCALHOST"
        ]
    );
}
