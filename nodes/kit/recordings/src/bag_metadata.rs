//! `metadata.yaml`, the file that makes a directory a recording of rosbag2.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::fs::File;
use std::io;
use std::path::Path;

use grainlab_console::replace_whole;

use crate::reader::{FileCount, Recording};
use crate::writer::TopicSpec;

#[derive(Clone, Debug)]
pub(crate) struct TopicCount {
    pub(crate) spec: TopicSpec,
    pub(crate) messages: u64,
}

#[derive(Clone, Debug, Default)]
pub(crate) struct BagMetadata {
    pub(crate) files: Vec<FileCount>,
    pub(crate) topics: BTreeMap<String, TopicCount>,
    /// Texts of the user by their names, as JSON; null without.
    pub(crate) custom_data: serde_json::Value,
    ros_distro: Option<String>,
    /// Hashes of the types of topics, for channels without.
    type_hashes: BTreeMap<String, String>,
    /// True if each message is compressed by itself.
    compressed: bool,
}

impl BagMetadata {
    pub(crate) fn of(recording: &Recording) -> Self {
        let compressed = recording.compressed;
        let mut metadata = Self { files: recording.parts(), compressed, ..Self::default() };
        metadata.carry(recording);
        let counts = recording.counts();
        for channel in recording.channels() {
            let spec = TopicSpec::of_channel(&channel);
            let messages = counts.get(channel.topic.as_str()).copied().unwrap_or(0);
            metadata.topics.insert(spec.name.clone(), TopicCount { spec, messages });
        }
        metadata
    }

    /// Takes what a user stored in the metadata of a source; returns the names that it has otherwise already.
    pub(crate) fn carry(&mut self, source: &Recording) -> Vec<String> {
        let Some(bag) = &source.bag else { return Vec::new() };
        for (topic, hash) in bag.type_hashes() {
            self.type_hashes.entry(topic).or_insert(hash);
        }
        self.ros_distro = self.ros_distro.take().or_else(|| bag.ros_distro.clone());
        let (Some(known), Some(new)) = (self.custom_data.as_object_mut(), bag.custom_data.as_object()) else {
            if self.custom_data.is_null() {
                self.custom_data = bag.custom_data.clone();
            }
            return Vec::new();
        };
        let differs = |(name, value): &(&String, _)| known.get(*name).is_some_and(|kept| kept != *value);
        let others = new.iter().filter(differs).map(|(name, _)| name.clone()).collect();
        for (name, value) in new {
            known.entry(name).or_insert_with(|| value.clone());
        }
        others
    }

    /// First and last log time of all files.
    pub(crate) fn bounds(&self) -> Option<(u64, u64)> {
        self.files.iter().filter_map(|f| f.bounds).reduce(|a, b| (a.0.min(b.0), a.1.max(b.1)))
    }

    /// Writes the file atomically: a temporary file is synced to the device and then renamed.
    pub(crate) fn write(&self, directory: &Path) -> io::Result<()> {
        replace_whole(&directory.join("metadata.yaml"), self.text())?;
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
            let own = Some(&spec.type_hash).filter(|hash| !hash.is_empty());
            let hash = own.or_else(|| self.type_hashes.get(&spec.name)).map_or("", String::as_str);
            let _ = write!(
                t,
                "    - topic_metadata:\n        name: {}\n        type: {}\n        serialization_format: cdr\n        \
                 offered_qos_profiles: {}\n        type_description_hash: {}\n      message_count: {messages}\n",
                quoted(&spec.name),
                quoted(&spec.ros_type),
                quoted(&spec.qos),
                quoted(hash)
            );
        }
        let [format, mode] = if self.compressed { ["zstd", "message"] } else { [""; 2] };
        let _ = write!(
            t,
            "  compression_format: {format:?}\n  compression_mode: {mode:?}\n  relative_file_paths:\n"
        );
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
        // JSON is YAML.
        let (custom, distro) = (&self.custom_data, self.ros_distro.as_deref().unwrap_or("jazzy"));
        let _ = writeln!(t, "  custom_data: {custom}\n  ros_distro: {}", quoted(distro));
        t
    }
}

/// A YAML double-quoted scalar: every JSON string is one.
fn quoted(text: &str) -> String {
    serde_json::Value::from(text).to_string()
}
