//! The last packing of a recording, from which a run is resumed.

use grainlab_console::Failure;
use grainlab_core::Packing;
use grainlab_msgs::{from_cdr, msg, topics};
use grainlab_recordings::{Recording, Selection};
use std::path::Path;

/// Number of packings in a recording, also while it is being written; 0 if it cannot be read.
pub fn count(directory: &Path) -> u64 {
    let Ok(recording) = Recording::open(directory) else { return 0 };
    packings(&recording).map_or(0, |bodies| bodies.len() as u64)
}

/// The last packing, and its run state.
pub fn read(directory: &Path) -> Result<(Packing, Vec<u8>), Failure> {
    let failed = |e: &dyn std::fmt::Display| Failure::failed(format!("{}: {e}", directory.display()));
    let recording = Recording::open(directory).map_err(|e| failed(&e))?;
    let body = packings(&recording)?.pop().ok_or_else(|| failed(&"there is no packing to resume from"))?;
    let message: msg::Packing = from_cdr(&body).map_err(|e| failed(&e))?;
    let packing = Packing::try_from(&message).map_err(|e| failed(&e))?;
    Ok((packing, message.run_state))
}

fn packings(recording: &Recording) -> Result<Vec<Vec<u8>>, Failure> {
    let channels = recording.channels();
    let of_packings = channels.iter().filter(|c| c.ros_type == topics::PACKING.info.type_name);
    let names = of_packings.map(|c| c.topic.clone());
    let messages = recording.messages(&Selection::topics(names)).map_err(Failure::failed)?;
    Ok(messages.map(|m| m.payload.to_vec()).collect())
}
