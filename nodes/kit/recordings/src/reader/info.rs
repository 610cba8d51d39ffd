//! Overview of a recording.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt;

use chrono::{DateTime, SecondsFormat};
use grainlab_console::{Table, escape_name, wrapped};
use serde::Serialize;

use super::definition::StoredDefinition;
use super::error::Warning;
use super::recording::Recording;
use crate::ledger::TopicTally;

/// Overview of a recording; its `Display` is a text table, its `Serialize` the stable form for programs.
#[derive(Clone, Debug, Serialize)]
pub struct Info {
    /// Path of the recording.
    pub path: String,
    /// Paths of the files.
    pub files: Vec<String>,
    /// Size of all files, bytes.
    pub bytes: u64,
    /// True if every file is complete.
    pub complete: bool,
    /// True if the index of a file is absent or lacks a part, which the format allows.
    pub without_index: bool,
    /// Profile in the header; `ros2`.
    pub profile: String,
    /// Library that wrote it.
    pub library: String,
    /// Compressions of the messages and of the chunks; `none` for uncompressed.
    pub compression: Vec<String>,
    /// Chunks with messages.
    pub chunks: u64,
    /// First log time, ns since 1970; `None` without messages.
    pub start_ns: Option<u64>,
    /// Last log time, ns since 1970; `None` without messages.
    pub end_ns: Option<u64>,
    /// Last minus first log time, s.
    pub duration_s: f64,
    /// Number of messages.
    pub messages: u64,
    /// The topics, by name; one with several types has a row for each.
    pub topics: Vec<TopicInfo>,
    /// Topics whose definition is missing or not that of this program, with what differs.
    pub definitions: Vec<String>,
    /// Names of the stored files.
    pub attachments: Vec<String>,
    /// Names of the metadata records.
    pub metadata: Vec<String>,
    /// Parts that could not be read so far.
    pub warnings: Vec<Warning>,
}

/// One topic of an [`Info`].
#[derive(Clone, Debug, Serialize)]
pub struct TopicInfo {
    /// Absolute name, `/stress`.
    pub name: String,
    /// ROS type, `grainlab_msgs/msg/Stress`.
    #[serde(rename = "type")]
    pub ros_type: String,
    /// Definition compared with that of this program: `same`, `mapped` (read by the names of fields), `refused`, `unknown` (this
    /// program has no type of the name), or `missing` (it is not in the recording).
    pub definition: &'static str,
    /// Messages in the recording.
    pub messages: u64,
    /// True if late readers get the last message.
    pub latched: bool,
    /// Messages published, if there is a ledger.
    pub published: Option<u64>,
    /// Messages lost, if there is a ledger.
    pub lost: Option<u64>,
    /// Repeated deliveries, if there is a ledger.
    pub repeated: Option<u64>,
}

impl Recording {
    /// Overview of the recording.
    pub fn info(&self) -> Info {
        let files = &self.files;
        let range = self.time_range();
        let tallies = self.ledger().unwrap_or_default();
        let tallies: BTreeMap<&str, &TopicTally> = tallies.iter().map(|t| (t.name.as_str(), t)).collect();
        let topics: Vec<_> = self
            .topics_by_type()
            .into_iter()
            .map(|(channel, messages)| {
                let tally = tallies.get(channel.topic.as_str());
                TopicInfo {
                    name: channel.topic.clone(),
                    ros_type: channel.ros_type.clone(),
                    definition: match &channel.stored {
                        StoredDefinition::Unknown if channel.is_without_definition() => "missing",
                        stored => stored.word(),
                    },
                    messages,
                    latched: channel.is_latched(),
                    published: tally.map(|t| t.published),
                    lost: tally.map(|t| t.lost),
                    repeated: tally.map(|t| t.repeated),
                }
            })
            .collect();
        let compressions: BTreeSet<&str> = files
            .iter()
            .flat_map(|f| &f.index.compressions)
            .map(|c| if c.is_empty() { "none" } else { c })
            .collect();
        let by_message = self.bag.as_ref().filter(|bag| bag.is_by("message"));
        let each = by_message.map(|bag| format!("{} of each message", bag.compression_format));
        Info {
            path: self.path.display().to_string(),
            files: files.iter().map(|f| f.path.display().to_string()).collect(),
            bytes: self.size(),
            complete: files.iter().all(|f| f.index.complete),
            without_index: self.is_without_index(),
            profile: files.first().map(|f| f.index.profile.clone()).unwrap_or_default(),
            library: files.first().map(|f| f.index.library.clone()).unwrap_or_default(),
            compression: each.into_iter().chain(compressions.into_iter().map(str::to_owned)).collect(),
            chunks: files.iter().map(|f| f.index.blocks.iter().filter(|b| b.is_chunk).count() as u64).sum(),
            start_ns: range.map(|r| r.0),
            end_ns: range.map(|r| r.1),
            duration_s: range.map_or(0.0, |(a, b)| (b - a) as f64 * 1e-9),
            messages: topics.iter().map(|t| t.messages).sum(),
            topics,
            definitions: self.definitions(),
            attachments: files
                .iter()
                .flat_map(|f| f.index.stored.attachments.iter().map(|a| a.name.clone()))
                .collect(),
            metadata: self.metadata_names().into_iter().collect(),
            warnings: self.warnings(),
        }
    }
}

impl fmt::Display for Info {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let time = |ns: Option<u64>| match ns.and_then(|ns| i64::try_from(ns).ok()) {
            Some(ns) => DateTime::from_timestamp_nanos(ns).to_rfc3339_opts(SecondsFormat::Millis, true),
            None => "-".to_owned(),
        };
        let list = |names: &[String]| {
            if names.is_empty() { "-".to_owned() } else { escape_name(&names.join(", ")).into_owned() }
        };
        writeln!(f, "recording    {}{}", self.path, if self.complete { "" } else { " (incomplete)" })?;
        writeln!(f, "size         {:.3} MB in {} file(s)", self.bytes as f64 * 1e-6, self.files.len())?;
        writeln!(f, "start        {}", time(self.start_ns))?;
        writeln!(f, "end          {}", time(self.end_ns))?;
        writeln!(f, "duration     {:.3} s", self.duration_s)?;
        writeln!(f, "messages     {} in {} chunks", self.messages, self.chunks)?;
        if self.without_index {
            writeln!(f, "index        absent or incomplete, which MCAP allows: the whole file was read")?;
        }
        writeln!(f, "compression  {}", list(&self.compression))?;
        writeln!(f, "profile      {} ({})", self.profile, self.library)?;
        writeln!(f, "attachments  {}", list(&self.attachments))?;
        writeln!(f, "metadata     {}", list(&self.metadata))?;
        let same = self.definitions.is_empty();
        let definitions =
            if same { "none of a type of this program differs" } else { "differ, as listed below" };
        writeln!(f, "definitions  {definitions}")?;
        let count = |n: Option<u64>| n.map_or_else(|| "-".to_owned(), |n| n.to_string());
        // The counts of a recorder are there where they differ from the messages.
        let (lost, repeated) = (
            self.topics.iter().any(|t| t.lost != Some(0)),
            self.topics.iter().any(|t| t.repeated.is_some_and(|n| n > 0)),
        );
        let columns = |t: [String; 5]| {
            let [name, ros_type, messages, l, r] = t;
            let more =
                [(lost, l), (repeated, r)].into_iter().filter(|(shown, _)| *shown).map(|(_, cell)| cell);
            [name, ros_type, messages].into_iter().chain(more).collect::<Vec<_>>()
        };
        // Types are aligned left, as names are.
        let width = self.topics.iter().map(|t| t.ros_type.len()).filter(|n| *n <= 1000).max().unwrap_or(0);
        let mut table = Table::new(columns([
            "topic".to_owned(),
            format!("{:width$}", "type"),
            "messages".to_owned(),
            "lost".to_owned(),
            "repeated".to_owned(),
        ]));
        for t in &self.topics {
            table.row(columns([
                escape_name(&t.name).into_owned(),
                format!("{:width$}", escape_name(&t.ros_type)),
                t.messages.to_string(),
                count(t.lost),
                count(t.repeated),
            ]));
        }
        let latched: Vec<String> =
            self.topics.iter().filter(|t| t.latched).map(|t| escape_name(&t.name).into_owned()).collect();
        if !latched.is_empty() {
            write!(f, "{}", wrapped("latched      ", &latched.join(" ")))?;
        }
        write!(f, "\n{}", table.text().trim_end())?;
        for line in &self.definitions {
            write!(f, "\n{}", escape_name(line))?;
        }
        Ok(())
    }
}
