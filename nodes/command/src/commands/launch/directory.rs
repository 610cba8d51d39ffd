//! `grainlab launch --run DIR`: a directory that begins, continues or keeps its run.

use super::order::Order;
use grainlab_console::Failure;
use grainlab_recordings::scenes::SceneText;
use grainlab_recordings::{Lock, Recording, RunState, run_state};
use std::path::{Path, PathBuf};
use std::time::Duration;

/// Time for a previous launcher of the run to end.
const TIME_LIMIT: Duration = Duration::from_secs(30);

/// Content of a given directory.
pub(super) enum Given {
    /// There is no run.
    Empty(PathBuf, Lock),
    /// A run that is not finished.
    Begun(PathBuf, Lock),
    /// A finished run, with a whole recording.
    Finished,
}

/// Looks into a directory, and locks it.
///
/// # Errors
/// A run of another scene or launch file, and a run that is under way.
pub(super) fn given(directory: &Path, scene: &SceneText, order: &Order) -> Result<Given, Failure> {
    std::fs::create_dir_all(directory).map_err(Failure::at(directory))?;
    let directory = directory.canonicalize().map_err(Failure::at(directory))?;
    let lock = Lock::take(&directory, TIME_LIMIT)?;
    if run_state(&directory) == RunState::Absent {
        return Ok(Given::Empty(directory, lock));
    }
    refuse_another(&directory, scene, order)?;
    if run_state(&directory) == RunState::Ended(0) {
        let recording = Recording::open(&directory).map_err(|e| {
            Failure::failed(format!(
                "{}: the run is finished, and its recording is damaged: {e}",
                directory.display()
            ))
        })?;
        for warning in recording.warnings() {
            grainlab_console::say!("grainlab: {warning}");
        }
        grainlab_console::say!("grainlab: {}: the run is finished", directory.display());
        return Ok(Given::Finished);
    }
    Ok(Given::Begun(directory, lock))
}

/// Refuses a directory with a run of another scene, seed or launch file, or with other arguments.
pub(super) fn refuse_another(directory: &Path, scene: &SceneText, order: &Order) -> Result<(), Failure> {
    let known = std::fs::read_to_string(directory.join("scene.toml")).unwrap_or_default();
    let differs = if known != scene.text {
        let first = known.lines().zip(scene.text.lines()).take_while(|(there, here)| there == here).count();
        let line = |text: &str| text.lines().nth(first).unwrap_or_default().trim().to_owned();
        format!("another scene (line {}: `{}`, not `{}`)", first + 1, line(&known), line(&scene.text))
    } else if !Order::read(directory)?.contains(order) {
        "another seed, launch file, engine or arguments, or fewer recorded messages".to_owned()
    } else {
        return Ok(());
    };
    let directory = directory.display();
    Err(Failure::usage(format!(
        "{directory}: the run there has {differs}: use another directory, or remove it"
    )))
}

/// Writes a copy of the scene: later edits of the file affect neither the run nor a restart.
pub(super) fn fill(directory: &Path, scene: &SceneText) -> Result<(), Failure> {
    let path = directory.join("scene.toml");
    std::fs::write(&path, &scene.text).map_err(Failure::at(&path))
}
