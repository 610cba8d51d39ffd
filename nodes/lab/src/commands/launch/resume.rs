//! `grainlab launch --resume RUN`: continues a run from the last packing in its recording.
//!
//! Recorded files are unchanged. The recorder continues in the next file of the recording; messages that the processes
//! repeat with the same bytes are not recorded again.

use super::conduct::{conduct, domain};
use super::finish::finish;
use super::order::Order;
use super::output::Output;
use grainlab_campaign::{RunState, run_state};
use grainlab_console::Failure;
use grainlab_console::scenes;
use grainlab_console::scenes::SceneText;
use grainlab_launcher::NodeKind;
use grainlab_launcher::last_packing;
use grainlab_launcher::{Received, Run, Supervised};
use grainlab_msgs::{Topic, msg, topics};
use grainlab_node_kit::{Exit, RunId};
use grainlab_recordings::{ChannelInfo, Recording, Selection};
use grainlab_results::brief::goes_on;
use std::path::Path;
use std::time::Duration;

pub(super) fn run(directory: &Path, output: Output) -> Result<Exit, Failure> {
    let output = Output { resumed: true, ..output };
    let failed = |e: &dyn std::fmt::Display| Failure::failed(format!("{}: {e}", directory.display()));
    let directory = directory.canonicalize().map_err(|e| failed(&e))?;
    let order = Order::read(&directory)?;
    let scene = scenes::load(&directory.join("scene.toml").to_string_lossy(), &[], Some(order.seed))?;
    let mut plans = order.plans(&directory)?;
    // Without a recording the run starts anew, in its own directory.
    if Recording::open(&directory).is_ok() {
        // The file of a killed recorder is completed first, so that other tools read the whole run.
        grainlab_recordings::recover(&directory).map_err(|e| failed(&e))?;
        let recording = Recording::open(&directory).map_err(|e| failed(&e))?;
        if is_finished(&recording) {
            // The launcher may have ended before it reported the run.
            return match run_state(&directory) {
                RunState::Ended(0) => {
                    Err(Failure::usage(format!("{}: the run is finished", directory.display())))
                }
                _ => report(&directory, &scene, output),
            };
        }
        let recorded = recording.stored_files().into_iter().find(|file| file.name == "scene.toml");
        if recorded.is_some_and(|file| file.bytes != scene.text.as_bytes()) {
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
    let (domain, lock) = domain()?;
    conduct(plans, domain, lock, &directory, &scene, output)
}

/// Reports a finished run from its recording.
fn report(directory: &Path, scene: &SceneText, output: Output) -> Result<Exit, Failure> {
    let packings = u32::try_from(last_packing::count(directory)).ok();
    let received = Received { packings, ..Received::default() };
    let (reasons, children) = (Vec::new(), Vec::new());
    let ended = Supervised { exit: Exit::Done, reasons, children, wall: Duration::ZERO, received };
    finish(output, directory, scene, Run { id: RunId::fresh(), domain: 0 }, ended)
}

/// Whether the loading path was complete and its last packing was measured and inverted.
fn is_finished(recording: &Recording) -> bool {
    let last = |name: &str| {
        let channels = recording.channels();
        let of = |c: &ChannelInfo| Topic::of_channel(&c.topic, &c.ros_type);
        let topic = channels.iter().find(|c| of(c).is_some_and(|t| t.name == name))?;
        let messages = recording.messages(&Selection::topics([topic.topic.clone()])).ok()?;
        messages.last()
    };
    let state = last(topics::RUN_STATE.name).and_then(|m| m.decoded::<msg::RunState>().ok());
    let found = last(topics::MICROSTRUCTURE.name).and_then(|m| m.decoded::<msg::Microstructure>().ok());
    let done = state.filter(|s| s.state == msg::RunState::FINISHED).map(|s| s.last_packing_step);
    done.is_some() && done == found.map(|m| m.source_step)
}
