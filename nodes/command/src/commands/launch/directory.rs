//! `grainlab launch --run DIR`: a directory that begins, continues or keeps its run.

use super::order::Order;
use grainlab_console::{Failure, refuse_input, replace_whole};
use grainlab_recordings::scenes::SceneText;
use grainlab_recordings::{Lock, Recording, RunState, input, recording_in, run_state};
use std::io::ErrorKind;
use std::path::{Path, PathBuf};
use std::time::Duration;

/// Time for a previous launcher of the run to end.
const TIME_LIMIT: Duration = Duration::from_secs(30);

/// Files that a run writes to its directory, besides its recording, its scene and its launch file.
const FILES: [&str; 2] = ["summary.json", "report.html"];

pub(super) enum Given {
    Empty(PathBuf, Lock),
    /// A run that is not finished.
    Begun(PathBuf, Lock),
    /// A finished run, with a whole recording.
    Finished,
}

/// Locks the directory of a run, so that one launcher at a time works in it.
pub(super) fn lock(directory: &Path) -> Result<Lock, Failure> {
    Lock::take(directory, TIME_LIMIT)
}

/// Refuses a directory whose path cannot be handed to the nodes: a parameter of ROS is one line of UTF-8 text.
pub(super) fn check_path(directory: &Path) -> Result<(), Failure> {
    let path = std::path::absolute(directory).map_err(Failure::at(directory))?;
    let cause = match path.to_str() {
        None => "is not UTF-8",
        Some(text) if text.contains(char::is_control) => {
            "contains a control character, such as an end of a line"
        }
        Some(_) => return Ok(()),
    };
    Err(Failure::usage(format!(
        "the path {path:?} of the run {cause}, and nodes get it as a parameter, which is one line of UTF-8 text: choose another \
         directory with --out or --run, or rename its folder"
    )))
}

/// Locks a directory; refuses another run, a run under way, and files of others that the run would replace.
pub(super) fn given(directory: &Path, scene: &SceneText, order: &Order) -> Result<Given, Failure> {
    if run_state(directory) == RunState::Absent {
        refuse_files_of_others(directory, scene)?;
    }
    std::fs::create_dir_all(directory).map_err(Failure::at(directory))?;
    let directory = directory.canonicalize().map_err(Failure::at(directory))?;
    let lock = lock(&directory)?;
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

/// Refuses a directory without a run in which a new run would replace a file.
fn refuse_files_of_others(directory: &Path, scene: &SceneText) -> Result<(), Failure> {
    let path_of_scene = directory.join("scene.toml");
    refuse_input(&path_of_scene)?;
    let file = FILES.iter().map(|name| directory.join(name)).find(|path| path.symlink_metadata().is_ok());
    // A launch that was killed before it had written its launch file leaves the scene.
    let is_own = || input::text(&path_of_scene, input::SETTINGS).is_ok_and(|text| text == scene.text);
    let of_scene = || path_of_scene.symlink_metadata().is_ok() && !is_own();
    let file = file.or_else(|| of_scene().then(|| path_of_scene.clone()));
    let Some(file) = file.map_or_else(|| recording_in(directory), |file| Ok(Some(file)))? else {
        return Ok(());
    };
    Err(Failure::usage(format!(
        "{}: this file belongs to no run, and a new run in its directory would replace or hide it: choose another directory with \
         --run, or move the file",
        file.display()
    )))
}

/// Refuses a directory with a run of another scene, seed or launch file, or with other arguments.
pub(super) fn refuse_another(directory: &Path, scene: &SceneText, order: &Order) -> Result<(), Failure> {
    let path = directory.join("scene.toml");
    let known = match input::text(&path, input::SETTINGS) {
        Err(e) if e.kind() == ErrorKind::NotFound => String::new(),
        read => read.map_err(Failure::at(&path))?,
    };
    let differs = if known != scene.text {
        another_scene(&known, &scene.text)
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

/// Describes a scene other than `expected` by the first line that differs.
pub(crate) fn another_scene(known: &str, expected: &str) -> String {
    let first = known.lines().zip(expected.lines()).take_while(|(there, here)| there == here).count();
    let line = |text: &str| text.lines().nth(first).unwrap_or_default().trim().to_owned();
    format!("another scene (line {}: `{}`, not `{}`)", first + 1, line(known), line(expected))
}

/// Writes a copy of the scene: later edits of the file affect neither the run nor a restart.
pub(super) fn fill(directory: &Path, scene: &SceneText) -> Result<(), Failure> {
    let path = directory.join("scene.toml");
    replace_whole(&path, &scene.text).map_err(Failure::at(&path))
}

#[cfg(test)]
mod tests {
    use super::*;
    use grainlab_recordings::scenes;

    #[test]
    fn a_new_run_replaces_no_file_of_others() {
        let folder = tempfile::tempdir().unwrap();
        let scene = scenes::load("demo", &[], None).unwrap();
        let refused = || refuse_files_of_others(folder.path(), &scene).map_err(|e| (e.exit, e.to_string()));
        for name in ["scene.toml", "summary.json", "report.html", "metadata.yaml", "camera.mcap"] {
            let file = folder.path().join(name);
            std::fs::write(&file, "of the user").unwrap();
            let (exit, why) = refused().unwrap_err();
            assert!(exit == grainlab_node_kit::Exit::Usage && why.contains("belongs to no run"), "{why}");
            assert!(why.starts_with(&file.display().to_string()), "{why}");
            std::fs::remove_file(file).unwrap();
        }
        std::fs::write(folder.path().join("notes.txt"), "").unwrap();
        assert_eq!(refused(), Ok(()));
        fill(folder.path(), &scene).unwrap();
        assert_eq!(refused(), Ok(()), "a launch was killed before it had written its launch file");
    }

    #[test]
    fn the_scene_of_a_run_is_not_replaced_by_the_run() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("scene.toml");
        std::fs::write(&path, "# mine\nbase = 'demo'\nname = 'mine'\n").unwrap();
        let scene = scenes::load(&path.to_string_lossy(), &[], None).unwrap();
        let refused = refuse_files_of_others(folder.path(), &scene).unwrap_err();
        assert!(refused.to_string().contains("the command reads this file"), "{refused}");
    }
}
