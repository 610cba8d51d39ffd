//! Comparison of `metadata.yaml` with the files.

use std::collections::{BTreeMap, BTreeSet};

use grainlab_console::count;

use super::channel::ChannelInfo;
use super::files::BagInformation;
use super::recording::Recording;
use super::verify::Contents;

/// Programs may round times to milliseconds.
const ROUNDING_NS: u64 = 1_000_000;

impl BagInformation {
    /// The statements that are not true of the files, a line each.
    pub(super) fn differences(&self, recording: &Recording, found: &Contents) -> Vec<String> {
        let mut lines: Vec<String> = self.differs(found.messages).into_iter().collect();
        if let Some(other) = self.storage_identifier.as_ref().filter(|id| *id != "mcap") {
            lines.push(format!("storage_identifier: it states {other:?}, the files are mcap"));
        }
        let (mode, format) = (&self.compression_mode, &self.compression_format);
        match mode.to_lowercase().as_str() {
            "message" => {}
            "" | "none" if format.is_empty() => {}
            "" | "none" => lines.push(format!(
                "compression_format: it states {format:?}, but no compression_mode: rosbag2 does not play it"
            )),
            _ => lines.push(format!(
                "compression_mode: it states {mode:?}, the files are not compressed as a whole"
            )),
        }
        self.topics(recording, found, &mut lines);
        self.times(found, &mut lines);
        self.parts(recording, &mut lines);
        lines
    }

    fn topics(&self, recording: &Recording, found: &Contents, lines: &mut Vec<String>) {
        let Some(entries) = &self.topics_with_message_count else { return };
        let mut channels = BTreeMap::<&str, Vec<&ChannelInfo>>::new();
        for channel in recording.all_channels() {
            channels.entry(&channel.topic).or_default().push(channel);
        }
        for entry in entries {
            let (name, stated) = (&entry.topic_metadata.name, &entry.topic_metadata.ros_type);
            let there = found.by_topic.get(name).copied().unwrap_or(0);
            if entry.message_count != there {
                let stated = count(entry.message_count, "message");
                lines.push(format!("{name}: it states {stated}, the files hold {there}"));
            }
            let channels = channels.get(name.as_str()).map(Vec::as_slice).unwrap_or_default();
            let format = &entry.topic_metadata.serialization_format;
            if !format.is_empty()
                && !channels.is_empty()
                && channels.iter().all(|c| c.message_encoding != *format)
            {
                lines.push(format!(
                    "{name}: it states the serialization_format {format}, the files have another"
                ));
            }
            let types: BTreeSet<&str> = channels.iter().map(|c| c.ros_type.as_str()).collect();
            if !types.is_empty() && !types.contains(stated.as_str()) {
                let types = types.into_iter().collect::<Vec<_>>().join(" and ");
                lines.push(format!("{name}: it states the type {stated}, the files have {types}"));
            }
        }
        let listed: BTreeSet<&str> = entries.iter().map(|entry| entry.topic_metadata.name.as_str()).collect();
        for (name, there) in &found.by_topic {
            if !listed.contains(name.as_str()) {
                lines.push(format!(
                    "{name}: it does not list it, the files hold {}",
                    count(*there, "message")
                ));
            }
        }
    }

    fn times(&self, found: &Contents, lines: &mut Vec<String>) {
        // Without messages rosbag2 writes the largest time as start.
        let Some(first) = found.first else { return };
        let far = |stated: u64, there: u64| stated.abs_diff(there) > ROUNDING_NS;
        if let Some(stated) = self.starting_time.nanoseconds.filter(|stated| far(*stated, first)) {
            lines.push(format!("starting_time: it states {stated} ns, the first message is of {first} ns"));
        }
        // Rosbag2 counts from the first time known when each message came, which need not be the earliest.
        let whole = found.last - first;
        let wrong = |stated: &u64| far(*stated, whole) && far(*stated, found.longest);
        if let Some(stated) = self.duration.nanoseconds.filter(wrong) {
            lines.push(format!("duration: it states {stated} ns, the messages last {whole} ns"));
        }
    }

    fn parts(&self, recording: &Recording, lines: &mut Vec<String>) {
        for entry in &self.files {
            let path = &entry.path;
            match recording.files.iter().find(|file| file.path.ends_with(path)).map(|file| file.count()) {
                Some(file) => lines.extend(entry.message_count.filter(|n| *n != file.messages).map(|n| {
                    format!("files: it states {} in {path}, there are {}", count(n, "message"), file.messages)
                })),
                // A missing file is reported when the recording is opened.
                None if self.relative_file_paths.contains(path) => {}
                None => lines.push(format!("files: relative_file_paths does not name {path}")),
            }
        }
    }
}
