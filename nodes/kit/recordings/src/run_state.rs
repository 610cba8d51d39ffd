//! Progress of a run, by the files of its directory.

use grainlab_console::input;
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

/// End of a run, by its `summary.json`.
#[derive(Clone, Debug, Deserialize)]
pub struct RunEnd {
    exit: u8,
    #[serde(default)]
    warnings: Vec<String>,
    /// Wall time of the last launcher, s.
    pub wall_seconds: Option<f64>,
}

impl RunEnd {
    /// Exit code, and the reason in one line, if the summary has one.
    pub fn reason(&self) -> String {
        let why = self.warnings.first().map_or_else(String::new, |w| format!(": {w}"));
        format!("exit code {}{why}", self.exit)
    }
}

/// The state of the run in this directory. The launcher writes `launch.json` before the run, and `summary.json` after it,
/// each at once.
pub fn run_state(directory: &Path) -> RunState {
    match run_end(directory) {
        Some(end) => RunState::Ended(end.exit),
        None if directory.join("launch.json").exists() => RunState::Begun,
        None => RunState::Absent,
    }
}

/// The end of the run in this directory; `None` if it was not reported.
pub fn run_end(directory: &Path) -> Option<RunEnd> {
    serde_json::from_slice(&input::bytes(&directory.join("summary.json"), input::TEXT).ok()?).ok()
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
        assert_eq!(run_end(folder.path()).unwrap().reason(), "exit code 3");
        let summary = folder.path().join("summary.json");
        std::fs::remove_file(&summary).unwrap();
        assert!(std::process::Command::new("mkfifo").arg(&summary).status().unwrap().success());
        assert_eq!(run_state(folder.path()), RunState::Begun, "nobody waits for the end of a pipe");
        std::fs::remove_file(&summary).unwrap();
        write("summary.json", "{\"exit\": 4, \"warnings\": [\"phase 2 did not end\"]}");
        assert_eq!(run_end(folder.path()).unwrap().reason(), "exit code 4: phase 2 did not end");
    }
}
