//! The last packing of a recording, from which a run is resumed.

use grainlab_console::Failure;
use grainlab_core::Packing;
use grainlab_msgs::{Topic, msg, topics};
use grainlab_recordings::{Messages, Recording, Selection};
use std::path::Path;

/// Number of packings in a recording, also while it is being written; 0 if it cannot be read.
pub fn count(directory: &Path) -> u64 {
    let Ok(recording) = Recording::open(directory) else { return 0 };
    packings(&recording).map_or(0, |messages| messages.count() as u64)
}

/// True if a recorder finished every file of a recording.
pub(crate) fn is_complete(directory: &Path) -> bool {
    Recording::open(directory).is_ok_and(|r| r.warnings().is_empty() && r.unaccounted().is_empty())
}

/// The last packing, and its run state.
pub fn read(directory: &Path) -> Result<(Packing, Vec<u8>), Failure> {
    let failed = |e: &dyn std::fmt::Display| Failure::failed(format!("{}: {e}", directory.display()));
    let recording = Recording::open(directory).map_err(|e| failed(&e))?;
    let last = packings(&recording)?.last().ok_or_else(|| failed(&"there is no packing to resume from"))?;
    recording.differing().iter().for_each(|line| grainlab_console::say!("grainlab: {line}"));
    let message: msg::Packing = last.decoded().map_err(|e| failed(&e))?;
    let packing = Packing::try_from(&message).map_err(|e| failed(&e))?;
    Ok((packing, message.run_state))
}

/// Number after those of all recorded requests of the lockstep.
pub(crate) fn next_request(directory: &Path) -> Result<u64, Failure> {
    let failed = |e: &dyn std::fmt::Display| Failure::failed(format!("{}: {e}", directory.display()));
    let recording = Recording::open(directory).map_err(|e| failed(&e))?;
    let requests = of_type(&recording, &topics::STRESS)?;
    let numbers =
        requests.map(|message| message.decoded::<msg::Stress>().map_or(0, |request| request.sequence + 1));
    Ok(numbers.max().unwrap_or(0))
}

fn packings(recording: &Recording) -> Result<Messages<'_>, Failure> {
    of_type(recording, &topics::PACKING)
}

/// The messages of the type of a topic.
fn of_type<'a>(recording: &'a Recording, topic: &Topic) -> Result<Messages<'a>, Failure> {
    let channels = recording.channels();
    let names = channels.iter().filter(|c| c.ros_type == topic.info.type_name).map(|c| c.topic.clone());
    recording.messages(&Selection::topics(names)).map_err(Failure::failed)
}
