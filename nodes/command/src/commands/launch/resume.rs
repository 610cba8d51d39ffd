//! `grainlab launch --resume RUN`: continues a run from the last packing in its recording.
//!
//! A run that ended with another exit code than 0 continues also after its last packing: what was not measured and inverted then
//! is so now. Recorded files are unchanged. The recorder continues in the next file of the recording; messages that the processes
//! repeat with the same bytes are not recorded again.

use super::conduct::{conduct, medium};
use super::finish::Output;
use super::order::{EngineOptions, Order};
use grainlab_console::Failure;
use grainlab_launcher::NodeKind;
use grainlab_launcher::last_packing;
use grainlab_node_kit::Exit;
use grainlab_recordings::{Recording, RunState, SeveralRuns, run_state, scenes};
use grainlab_results::brief::goes_on;
use std::path::{Path, PathBuf};

pub(super) fn run(directory: &Path, engine: &EngineOptions, output: Output) -> Result<Exit, Failure> {
    let output = Output { resumed: true, ..output };
    let failed = |e: &dyn std::fmt::Display| Failure::failed(format!("{}: {e}", directory.display()));
    let directory = directory.canonicalize().map_err(|e| failed(&e))?;
    let known = Order::read(&directory)?;
    let mut order = known.clone();
    engine.set(&mut order.arguments);
    let path_of_scene = directory.join("scene.toml").to_string_lossy().into_owned();
    let scene = scenes::load(&path_of_scene, &[], Some(order.seed))?;
    let mut plans = order.plans(&directory)?;
    if matches!(run_state(&directory), RunState::Ended(0)) {
        return Err(Failure::usage(format!("{}: the run is finished", directory.display())));
    }
    if order != known {
        order.keep(&directory)?;
    }
    let saved = match Recording::open(&directory) {
        Err(error) => {
            start_again(&directory, &error)?;
            None
        }
        Ok(recording) => {
            of_one_run(&recording)?;
            drop(recording);
            let saved = last_step(&directory, &scene, order.seed)?;
            grainlab_console::say!("grainlab: {}: {}", directory.display(), goes_on(saved));
            saved
        }
    };
    let path = serde_json::Value::from(directory.to_string_lossy());
    for plan in &mut plans {
        let given = match plan.node {
            Some(NodeKind::Recorder) => "append:=true".to_owned(),
            Some(NodeKind::DemSimulator) if saved.is_some() => format!("resume:={path}"),
            _ => continue,
        };
        plan.arguments.extend(["--ros-args".to_owned(), "-p".to_owned(), given]);
    }
    let ended = conduct(plans, medium(order.one_process)?, &directory, &scene, output);
    // A run that refuses another engine keeps its own.
    if order != known && matches!(ended, Ok(Exit::Usage)) {
        known.keep(&directory)?;
    }
    ended
}

/// Returns the step of the last recorded packing, `None` without one. Fails if the recording is of another scene or seed.
fn last_step(directory: &Path, scene: &scenes::SceneText, seed: u64) -> Result<Option<u64>, Failure> {
    let failed = |e: &dyn std::fmt::Display| Failure::failed(format!("{}: {e}", directory.display()));
    // The file of a killed recorder is completed first, so that other tools read the whole run.
    grainlab_recordings::recover(directory).map_err(|e| failed(&e))?;
    let recording = Recording::open(directory).map_err(|e| failed(&e))?;
    let recorded = recording.stored_files().into_iter().find(|file| file.name == "scene.toml");
    let differs = |text: &str| recorded.as_ref().is_some_and(|file| file.bytes != text.as_bytes());
    let path_of_scene = directory.join("scene.toml").to_string_lossy().into_owned();
    if differs(&scene.text) && scenes::load(&path_of_scene, &[], None).is_ok_and(|own| !differs(&own.text)) {
        return Err(failed(&format!(
            "launch.json: the seed {seed} is not the one that the recording began with, which scene.toml has: put it back, or launch a \
             new run"
        )));
    }
    if differs(&scene.text) {
        return Err(failed(
            &"scene.toml is not the scene that the recording began with: the run cannot continue with another one. Put the recorded one \
              back, or launch a new run",
        ));
    }
    match last_packing::count(directory) {
        0 => Ok(None),
        _ => Ok(Some(last_packing::read(directory)?.0.step)),
    }
}

/// Restarts a run without a recording in its own directory, and says what is lost.
/// Fails if a file of the recording has content, which a new recording would neither use nor replace.
fn start_again(directory: &Path, error: &Failure) -> Result<(), Failure> {
    let entries = std::fs::read_dir(directory).map_err(Failure::at(directory))?.flatten();
    let paths: Vec<_> = entries.map(|entry| entry.path()).collect();
    let is_mcap = |path: &&PathBuf| path.extension().is_some_and(|e| e == "mcap");
    let is_empty = |path: &PathBuf| path.symlink_metadata().is_ok_and(|m| m.is_file() && m.len() == 0);
    if paths.iter().filter(is_mcap).any(|path| !is_empty(path)) {
        return Err(Failure::failed(format!(
            "{error}: the run cannot continue with this file in its directory. Put the recorded file back, or move this one out of {} \
             and resume again",
            directory.display()
        )));
    }
    if paths.iter().any(|path| is_mcap(&path) || path.ends_with("metadata.yaml")) {
        grainlab_console::say!(
            "grainlab: {}: what this run has recorded is lost ({error}): it starts again from its first step",
            directory.display()
        );
    }
    Ok(())
}

/// Refuses a recording that has files of another run or program: the run would continue from a packing that is not its own.
fn of_one_run(recording: &Recording) -> Result<(), Failure> {
    let advice = "move it out of the directory of the run, and resume again";
    if let Some(path) = recording.foreign().next() {
        let path = path.display();
        return Err(Failure::failed(format!(
            "{path} is not a recording of grainlab, and not of this run: {advice}"
        )));
    }
    let Some(SeveralRuns { path, sign }) = SeveralRuns::of(recording) else { return Ok(()) };
    let files: Vec<_> = recording.paths().iter().map(|path| path.display().to_string()).collect();
    Err(Failure::failed(format!(
        "{}: it holds several runs: {sign}. Find the file of the other run among {}: {advice}",
        path.display(),
        files.join(", ")
    )))
}

#[cfg(test)]
mod tests {
    use super::*;
    use grainlab_recordings::RunWriter;

    fn record(directory: &Path, name: &str, scene: &str) {
        let elsewhere = tempfile::tempdir_in(directory.parent().unwrap()).unwrap();
        let mut run = RunWriter::create(elsewhere.path(), name, &[], Default::default()).unwrap();
        run.attach("scene.toml", "application/toml", scene.as_bytes()).unwrap();
        // A killed recorder leaves no metadata.yaml.
        let file = run.finish().unwrap().file;
        std::fs::rename(&file, directory.join(file.file_name().unwrap())).unwrap();
    }

    #[test]
    fn a_run_starts_again_without_a_recording_and_not_beside_a_file_that_cannot_be_read() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("run_0.mcap");
        let started = || start_again(folder.path(), &Recording::open(folder.path()).unwrap_err());
        assert!(started().is_ok());
        std::fs::write(&path, "").unwrap();
        assert!(started().is_ok(), "nothing is lost with an empty file");
        record(folder.path(), "run", "seed = 1");
        std::fs::write(&path, [0; 4096]).unwrap();
        let error = started().unwrap_err().to_string();
        assert!(
            error.contains("run_0.mcap is not an MCAP file") && error.contains("move this one out"),
            "{error}"
        );
        std::fs::remove_file(&path).unwrap();
        assert!(std::process::Command::new("mkfifo").arg(&path).status().unwrap().success());
        let error = started().unwrap_err().to_string();
        assert!(error.contains("run_0.mcap") && error.contains("it is a pipe"), "{error}");
    }

    #[test]
    fn a_run_does_not_continue_with_a_file_of_another_run_or_program() {
        let folder = tempfile::tempdir().unwrap();
        let checked = || of_one_run(&Recording::open(folder.path()).unwrap()).map_err(|e| e.to_string());
        record(folder.path(), "run", "seed = 1");
        record(folder.path(), "same", "seed = 1");
        assert_eq!(checked(), Ok(()));
        record(folder.path(), "other", "seed = 2");
        let error = checked().unwrap_err();
        assert!(error.contains("2 different scenes") && error.contains("other_0.mcap"), "{error}");
        std::fs::remove_file(folder.path().join("other_0.mcap")).unwrap();
        let foreign = folder.path().join("camera.mcap");
        let text = |text: &str| [&(text.len() as u32).to_le_bytes()[..], text.as_bytes()].concat();
        let record =
            |opcode: u8, body: &[u8]| [&[opcode], &(body.len() as u64).to_le_bytes()[..], body].concat();
        let header = record(1, &[text("ros2"), text("rosbag2")].concat());
        let magic = b"\x89MCAP0\r\n";
        let bytes = [&magic[..], &header, &record(0x0f, &[0; 4]), &record(2, &[0; 20]), magic].concat();
        std::fs::write(&foreign, bytes).unwrap();
        let error = checked().unwrap_err();
        assert!(error.contains("camera.mcap is not a recording of grainlab"), "{error}");
    }
}
