//! The wave speeds in the recording of a run that is resumed.

use grainlab_console::Failure;
use grainlab_msgs::{msg, stamp, topics};
use grainlab_recordings::{Recording, Selection};
use std::collections::BTreeSet;
use std::path::Path;

/// Steps of packings with wave speeds. An instrument without a simulation has step 0, too, but not the stamp of the first packing.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct RecordedSpeeds {
    /// Those whose speeds were sent.
    pub measured: BTreeSet<u64>,
    /// Those of which an inversion answered.
    pub inverted: BTreeSet<u64>,
}

impl RecordedSpeeds {
    /// Reads the recording of a run.
    ///
    /// # Errors
    /// If it cannot be read.
    pub fn read(directory: &Path) -> Result<Self, Failure> {
        let recording = Recording::open(directory).map_err(Failure::failed)?;
        let kinds = [topics::WAVE_SPEEDS, topics::MICROSTRUCTURE].map(|t| t.info.type_name);
        let channels = recording.channels();
        let wanted =
            channels.iter().filter(|c| kinds.contains(&c.ros_type.as_str())).map(|c| c.topic.clone());
        let mut found = Self::default();
        for message in recording.messages(&Selection::topics(wanted)).map_err(Failure::failed)? {
            if message.channel.ros_type == topics::WAVE_SPEEDS.info.type_name {
                let about = |m: &msg::WaveSpeeds| m.source_step > 0 || m.header.stamp == stamp(0.0);
                let speeds = message.decoded::<msg::WaveSpeeds>().ok().filter(about);
                found.measured.extend(speeds.map(|m| m.source_step));
            } else if let Ok(answer) = message.decoded::<msg::Microstructure>()
                && answer.source == topics::WAVE_SPEEDS.name
            {
                found.inverted.insert(answer.source_step);
            }
        }
        Ok(found)
    }
}
