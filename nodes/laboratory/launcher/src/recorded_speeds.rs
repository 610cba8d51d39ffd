//! The wave speeds in the recording of a run that is resumed.

use grainlab_console::Failure;
use grainlab_dem_simulator::RecordedSpeeds;
use grainlab_msgs::{msg, stamp, topics};
use grainlab_recordings::{Recording, Selection};
use std::path::Path;

/// Returns the packings with wave speeds. An instrument without a simulation has step 0, too, but not the stamp of the first packing.
///
/// # Errors
/// If the recording cannot be read.
pub(crate) fn read(directory: &Path) -> Result<RecordedSpeeds, Failure> {
    let recording = Recording::open(directory).map_err(Failure::failed)?;
    let kinds = [topics::WAVE_SPEEDS, topics::MICROSTRUCTURE].map(|t| t.info.type_name);
    let channels = recording.channels();
    let wanted = channels.iter().filter(|c| kinds.contains(&c.ros_type.as_str())).map(|c| c.topic.clone());
    let mut found = RecordedSpeeds::default();
    for message in recording.messages(&Selection::topics(wanted)).map_err(Failure::failed)? {
        if message.channel.ros_type == topics::WAVE_SPEEDS.info.type_name {
            let is_about_packing = |m: &msg::WaveSpeeds| m.source_step > 0 || m.header.stamp == stamp(0.0);
            if let Some(speeds) = message.decoded::<msg::WaveSpeeds>().ok().filter(is_about_packing) {
                *found.measured.entry(speeds.source_step).or_default() += 1;
            }
        } else if let Ok(answer) = message.decoded::<msg::Microstructure>()
            && answer.source == topics::WAVE_SPEEDS.name
        {
            found.inverted.insert(answer.source_step);
        }
    }
    Ok(found)
}
