//! Packings of recordings.

use std::ops::ControlFlow;

use grainlab_console::Failure;
use grainlab_core::Packing;
use grainlab_core::notes::texts;
use grainlab_msgs::{Message as _, msg, topics};

use super::ImportOptions;
use super::error::ImportError;
use super::imported::Imported;
use crate::one_run::{OneRun, RunSign};
use crate::reader::{Message, Recording, Selection, no_such_topic};

/// Passes the packings of a recording to `take` one by one, in order of log time, until it stops. A message
/// that is not a packing is an error; the readable part of a damaged or truncated recording is used, with
/// warnings. If the packings show that the recording holds several runs, each has a note that says so.
///
/// # Errors
/// If the options give data that a recording has itself, the topic does not exist or carries another type, or a message on it
/// is not a packing.
pub fn each(
    recording: &Recording,
    options: &ImportOptions,
    take: &mut dyn FnMut(Imported) -> ControlFlow<()>,
) -> Result<(), ImportError> {
    let given = options.flags_given();
    if !given.is_empty() {
        return Err(ImportError::Given(format!(
            "a recording has its own cell, grains, material, friction and forces: leave out {}, or export the packing with \
             `grainlab bag export` and analyze the file",
            given.join(", ")
        )));
    }
    let channels = recording.channels();
    let mut of_packings = channels.iter().filter(|c| c.ros_type == msg::Packing::TYPE);
    // A namespace or a remap gives the topic of the packings of a run another name.
    let only = of_packings.next().filter(|_| of_packings.next().is_none()).map(|c| c.topic.as_str());
    let topic = options.topic.as_deref().or(only).unwrap_or(topics::PACKING.name);
    let channel = recording.channel(topic)?;
    if channel.ros_type != msg::Packing::TYPE {
        let known = channels.iter().filter(|c| c.ros_type == msg::Packing::TYPE).map(|c| c.topic.as_str());
        let known = known.collect::<Vec<_>>().join(", ");
        let topic = format!("{topic} of type {}", msg::Packing::TYPE);
        return Err(no_such_topic(recording.path(), &topic, &known).into());
    }
    let mut any = false;
    // The sign may be in the last packing only, and the note is for the first, too.
    let several = several_runs(recording, topic)?;
    for message in recording.messages(&Selection::topics([topic]))? {
        any = true;
        let mut imported = packing(&message)?;
        imported.notes.extend(several.as_ref().map(|sign| {
            format!(
                "the recording holds several runs: {sign}; of which of them this packing is, it does not say"
            )
        }));
        if take(imported).is_break() {
            break;
        }
    }
    if any { Ok(()) } else { Err(ImportError::empty()) }
}

fn several_runs(recording: &Recording, topic: &str) -> Result<Option<RunSign>, Failure> {
    let mut run = OneRun::default();
    let sign = |message: Message| run.packing(topic, &packing(&message).ok()?.packing).err();
    Ok(recording.messages(&Selection::topics([topic]))?.find_map(sign))
}

/// The packing of one recorded message.
///
/// # Errors
/// If the message does not decode, or its packing is invalid.
pub fn packing(message: &Message) -> Result<Imported, ImportError> {
    let fail = |problem: String| {
        let (topic, sequence) = (&message.channel.topic, message.sequence);
        ImportError::Invalid(format!("message {sequence} on {topic}: {problem}"))
    };
    let decoded: msg::Packing = message.decoded().map_err(fail)?;
    let packing = Packing::try_from(&decoded).map_err(|e| fail(e.to_string()))?;
    let scene = if decoded.scene.is_empty() { "a scene without name" } else { &decoded.scene };
    let source = format!("recording, {scene}, step {}", packing.step);
    let (header, run_state) = (decoded.header, decoded.run_state);
    let stored = message.channel.stored.note().map(|note| format!("{}: {note}", message.channel.topic));
    let notes = stored.into_iter().chain(texts(&packing.overlap_fault())).collect();
    Ok(Imported { step: packing.step, packing, header, run_state, source, rounding: None, notes })
}
