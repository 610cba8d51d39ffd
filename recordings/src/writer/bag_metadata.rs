//! `metadata.yaml`, by which rosbag2 takes a directory for a recording.

use std::fmt::Write as _;
use std::fs::{self, File};
use std::io::{self, Write as _};
use std::path::Path;

use super::TopicSpec;

pub(super) struct TopicCount<'a> {
    pub(super) spec: &'a TopicSpec,
    pub(super) messages: u64,
}

pub(super) struct BagMetadata<'a> {
    pub(super) file: &'a Path,
    /// ns since 1970.
    pub(super) start: u64,
    /// ns.
    pub(super) duration: u64,
    pub(super) messages: u64,
    pub(super) topics: Vec<TopicCount<'a>>,
}

impl BagMetadata<'_> {
    /// Writes the file whole or not at all: a temporary file, renamed when it is on the device.
    pub(super) fn write(&self, directory: &Path) -> io::Result<()> {
        let partial = directory.join(".metadata.yaml.part");
        let mut file = File::create(&partial)?;
        file.write_all(self.text().as_bytes())?;
        file.sync_all()?;
        fs::rename(&partial, directory.join("metadata.yaml"))?;
        // The rename itself is on the device only when the directory is.
        File::open(directory)?.sync_all()
    }

    /// Version 8 with integers in the QoS: from Humble to Rolling, every rosbag2 reads it.
    fn text(&self) -> String {
        let name = self.file.file_name().map(|n| n.to_string_lossy().into_owned()).unwrap_or_default();
        let (file, start, duration, messages) = (quoted(&name), self.start, self.duration, self.messages);
        let mut t = format!(
            "rosbag2_bagfile_information:\n  version: 8\n  storage_identifier: mcap\n  duration:\n    nanoseconds: {duration}\n  \
             starting_time:\n    nanoseconds_since_epoch: {start}\n  message_count: {messages}\n  \
             topics_with_message_count:{}\n",
            if self.topics.is_empty() { " []" } else { "" }
        );
        for TopicCount { spec, messages } in &self.topics {
            // Writing to a String cannot fail.
            let _ = write!(
                t,
                "    - topic_metadata:\n        name: {}\n        type: {}\n        serialization_format: cdr\n        \
                 offered_qos_profiles: {}\n        type_description_hash: {}\n      message_count: {messages}\n",
                quoted(&spec.name),
                quoted(&spec.ros_type),
                quoted(&spec.qos),
                quoted(&spec.type_hash)
            );
        }
        let _ = write!(
            t,
            "  compression_format: \"\"\n  compression_mode: \"\"\n  relative_file_paths:\n    - {file}\n  files:\n    - path: {file}\n      \
             starting_time:\n        nanoseconds_since_epoch: {start}\n      duration:\n        nanoseconds: {duration}\n      \
             message_count: {messages}\n  custom_data: ~\n  ros_distro: jazzy\n"
        );
        t
    }
}

/// A YAML double-quoted scalar: every JSON string is one.
fn quoted(text: &str) -> String {
    serde_json::Value::from(text).to_string()
}
