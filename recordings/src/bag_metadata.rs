//! `metadata.yaml`, the file that makes a directory a recording of rosbag2.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::fs::{self, File};
use std::io::{self, Write as _};
use std::path::Path;

use crate::reader::{FileCount, Recording};
use crate::writer::TopicSpec;

/// The entry of one topic.
#[derive(Clone, Debug)]
pub(crate) struct TopicCount {
    pub(crate) spec: TopicSpec,
    pub(crate) messages: u64,
}

/// The content of `metadata.yaml`.
#[derive(Clone, Debug, Default)]
pub(crate) struct BagMetadata {
    pub(crate) files: Vec<FileCount>,
    pub(crate) topics: BTreeMap<String, TopicCount>,
}

impl BagMetadata {
    /// The metadata from the files of a recording.
    pub(crate) fn of(recording: &Recording) -> Self {
        let mut metadata = Self { files: recording.parts(), topics: BTreeMap::new() };
        for channel in recording.channels() {
            let spec = TopicSpec::of_channel(&channel);
            let messages = recording.count(&channel.topic);
            metadata.topics.insert(spec.name.clone(), TopicCount { spec, messages });
        }
        metadata
    }

    /// First and last log time of all files.
    pub(crate) fn bounds(&self) -> Option<(u64, u64)> {
        self.files.iter().filter_map(|f| f.bounds).reduce(|a, b| (a.0.min(b.0), a.1.max(b.1)))
    }

    /// Writes the file atomically: a temporary file is synced to the device and then renamed.
    pub(crate) fn write(&self, directory: &Path) -> io::Result<()> {
        let partial = directory.join(".metadata.yaml.part");
        let mut file = File::create(&partial)?;
        file.write_all(self.text().as_bytes())?;
        file.sync_all()?;
        fs::rename(&partial, directory.join("metadata.yaml"))?;
        // The rename is on the device only after the directory is synced.
        File::open(directory)?.sync_all()
    }

    /// Version 8 with integers in the QoS: every rosbag2 from Humble to Rolling reads it.
    fn text(&self) -> String {
        let (start, end) = self.bounds().unwrap_or((0, 0));
        let messages: u64 = self.files.iter().map(|f| f.messages).sum();
        let mut t = format!(
            "rosbag2_bagfile_information:\n  version: 8\n  storage_identifier: mcap\n  duration:\n    nanoseconds: {}\n  \
             starting_time:\n    nanoseconds_since_epoch: {start}\n  message_count: {messages}\n  \
             topics_with_message_count:{}\n",
            end - start,
            if self.topics.is_empty() { " []" } else { "" }
        );
        // Writing to a String cannot fail.
        for TopicCount { spec, messages } in self.topics.values() {
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
        t.push_str("  compression_format: \"\"\n  compression_mode: \"\"\n  relative_file_paths:\n");
        for file in &self.files {
            let _ = writeln!(t, "    - {}", quoted(&file.name));
        }
        t.push_str("  files:\n");
        for file in &self.files {
            let (start, end) = file.bounds.unwrap_or((0, 0));
            let _ = write!(
                t,
                "    - path: {}\n      starting_time:\n        nanoseconds_since_epoch: {start}\n      duration:\n        \
                 nanoseconds: {}\n      message_count: {}\n",
                quoted(&file.name),
                end - start,
                file.messages
            );
        }
        t.push_str("  custom_data: ~\n  ros_distro: jazzy\n");
        t
    }
}

/// A YAML double-quoted scalar: every JSON string is one.
fn quoted(text: &str) -> String {
    serde_json::Value::from(text).to_string()
}
