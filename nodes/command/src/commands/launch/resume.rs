//! `grainlab launch --resume RUN`: continues a run from the last packing in its recording.
//!
//! A run that ended with another exit code than 0 continues also after its last packing: what was not measured and inverted then
//! is so now. Recorded files are unchanged. The recorder continues in the next file of the recording; messages that the processes
//! repeat with the same bytes are not recorded again.

use super::conduct::{conduct, medium};
use super::engine::EngineOptions;
use super::order::Order;
use super::output::Output;
use grainlab_console::Failure;
use grainlab_launcher::NodeKind;
use grainlab_launcher::last_packing;
use grainlab_node_kit::Exit;
use grainlab_recordings::{Recording, RunState, run_state, scenes};
use grainlab_results::brief::goes_on;
use std::path::Path;

/// Continues a run, with another engine if one is given.
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
    // Without a recording the run starts anew, in its own directory.
    if Recording::open(&directory).is_ok() {
        // The file of a killed recorder is completed first, so that other tools read the whole run.
        grainlab_recordings::recover(&directory).map_err(|e| failed(&e))?;
        let recording = Recording::open(&directory).map_err(|e| failed(&e))?;
        let recorded = recording.stored_files().into_iter().find(|file| file.name == "scene.toml");
        let differs = |text: &str| recorded.as_ref().is_some_and(|file| file.bytes != text.as_bytes());
        if differs(&scene.text)
            && scenes::load(&path_of_scene, &[], None).is_ok_and(|own| !differs(&own.text))
        {
            return Err(Failure::failed(format!(
                "{}: launch.json: the seed {} is not the one that the recording began with, which scene.toml has: put it back, or \
                 launch a new run",
                directory.display(),
                order.seed
            )));
        }
        if differs(&scene.text) {
            return Err(Failure::failed(format!(
                "{}: scene.toml is not the scene that the recording began with: the run cannot continue with another one. Put the \
                 recorded one back, or launch a new run",
                directory.display()
            )));
        }
        let path = serde_json::Value::from(directory.to_string_lossy());
        let saved = match last_packing::count(&directory) {
            0 => None,
            _ => Some(last_packing::read(&directory)?.0.step),
        };
        grainlab_console::say!("grainlab: {}: {}", directory.display(), goes_on(saved));
        for plan in &mut plans {
            let given = match plan.node {
                Some(NodeKind::Recorder) => "append:=true".to_owned(),
                Some(NodeKind::DemSimulator) if saved.is_some() => format!("resume:={path}"),
                _ => continue,
            };
            plan.arguments.extend(["--ros-args".to_owned(), "-p".to_owned(), given]);
        }
    }
    let ended = conduct(plans, medium(order.one_process)?, &directory, &scene, output);
    // A run that refuses another engine keeps its own.
    if order != known && matches!(ended, Ok(Exit::Usage)) {
        known.keep(&directory)?;
    }
    ended
}
