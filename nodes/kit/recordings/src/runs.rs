//! Run directories: one per run, never reused.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

/// Folder of the run directories, under the current folder.
pub const RUNS: &str = "recordings/runs";

/// Creates the next free directory `<root>/<scene>-<seed>-<n>`, n = 1, 2, …, and returns it. Two processes
/// that call it at the same time get two directories.
///
/// # Errors
/// If a directory cannot be created for another reason than that it exists.
pub fn create_run_directory(root: &Path, scene: &str, seed: u64) -> io::Result<PathBuf> {
    fs::create_dir_all(root)?;
    for n in 1u64.. {
        let directory = root.join(format!("{}-{seed}-{n}", file_name(scene)));
        match fs::create_dir(&directory) {
            Ok(()) => return Ok(directory),
            Err(e) if e.kind() == io::ErrorKind::AlreadyExists => {}
            Err(e) => return Err(e),
        }
    }
    Err(io::Error::other("no free run number"))
}

/// A scene's name as part of a file name: other characters than letters, digits, `_` and `.` become `_`.
fn file_name(scene: &str) -> String {
    let safe = |c: char| if c.is_ascii_alphanumeric() || c == '.' { c } else { '_' };
    let name: String = scene.chars().map(safe).collect();
    if name.trim_matches('.').is_empty() { "run".to_owned() } else { name }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_run_gets_a_directory_of_its_own() {
        let root = tempfile::tempdir().unwrap();
        let runs = root.path().join("a/b");
        let names: Vec<_> = (0..3).map(|_| create_run_directory(&runs, "demo", 7).unwrap()).collect();
        assert_eq!(names, ["demo-7-1", "demo-7-2", "demo-7-3"].map(|n| runs.join(n)));
    }

    #[test]
    fn a_scene_name_cannot_leave_the_directory() {
        assert_eq!(file_name("../../etc"), ".._.._etc");
        assert_eq!(file_name(".."), "run");
        let root = tempfile::tempdir().unwrap();
        let made = create_run_directory(root.path(), "../x y", 1).unwrap();
        assert_eq!(made, root.path().join(".._x_y-1-1"));
    }
}
