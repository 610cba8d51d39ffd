//! Progress of a run, by the files of its directory.

use serde::Deserialize;
use std::path::Path;

/// Progress of the run in a directory.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RunState {
    /// There is no run.
    Absent,
    /// The run began, and was not reported: it is under way, or its launcher was killed.
    Begun,
    /// The run was reported with this exit code; 0 if its recording is whole.
    Ended(u8),
}

/// The part of `summary.json` that is read.
#[derive(Deserialize)]
struct Summary {
    exit: u8,
    #[serde(default)]
    warnings: Vec<String>,
}

/// The state of the run in this directory. The launcher writes `launch.json` before the run, and `summary.json` after it,
/// each at once.
pub fn run_state(directory: &Path) -> RunState {
    let summary = std::fs::read(directory.join("summary.json"));
    match summary.ok().and_then(|text| serde_json::from_slice::<Summary>(&text).ok()) {
        Some(summary) => RunState::Ended(summary.exit),
        None if directory.join("launch.json").exists() => RunState::Begun,
        None => RunState::Absent,
    }
}

/// Why the run in this directory ended as it did, in one line; `None` if its summary has no reason.
pub fn end_reason(directory: &Path) -> Option<String> {
    let summary = std::fs::read(directory.join("summary.json")).ok()?;
    serde_json::from_slice::<Summary>(&summary).ok()?.warnings.into_iter().next()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_run_has_ended_once_its_summary_is_whole() {
        let folder = tempfile::tempdir().unwrap();
        let write = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).unwrap();
        assert_eq!(run_state(folder.path()), RunState::Absent);
        write("scene.toml", "");
        assert_eq!(run_state(folder.path()), RunState::Absent, "killed before its launch file was written");
        write("launch.json", "{}");
        assert_eq!(run_state(folder.path()), RunState::Begun);
        write("summary.json", "{\"exit\": 1");
        assert_eq!(run_state(folder.path()), RunState::Begun);
        write("summary.json", "{\"scene\": \"s1\", \"exit\": 3}");
        assert_eq!(run_state(folder.path()), RunState::Ended(3));
        assert_eq!(end_reason(folder.path()), None);
        write("summary.json", "{\"exit\": 4, \"warnings\": [\"phase 2 did not end\"]}");
        assert_eq!(end_reason(folder.path()).as_deref(), Some("phase 2 did not end"));
    }
}
