//! A recording of the messages that a node would publish, made without the node.

use grainlab_console::Failure;
use grainlab_msgs::std_msgs::Header;
use grainlab_msgs::{Guid, Message, Topic, to_cdr};
use grainlab_recordings::{Incoming, RunWriter, SESSION_KEY, TopicSpec, WriterOptions};
use std::path::Path;

pub(crate) struct Recorded {
    topic: Topic,
    /// Stamp of the message, ns.
    time: u64,
    payload: Vec<u8>,
}

impl Recorded {
    pub(crate) fn new<T: Message>(topic: Topic, header: &Header, message: &T) -> Self {
        let seconds = u64::try_from(header.stamp.sec).unwrap_or(0);
        let mut payload = to_cdr(message);
        // The bytes of the bus, which sends whole words.
        payload.resize(payload.len().next_multiple_of(4), 0);
        Self { topic, time: seconds * 1_000_000_000 + u64::from(header.stamp.nanosec), payload }
    }
}

/// Log times are the stamps, increased where necessary to stay in order: two recordings of the same packings are equal.
pub(crate) struct OfflineRecording {
    writer: RunWriter,
    /// A placeholder for the writer, since there is no network.
    guid: Guid,
    command: &'static str,
    counts: Vec<(Topic, i64)>,
}

impl OfflineRecording {
    /// Begins a recording of these topics in this directory, made by `grainlab command`.
    pub(crate) fn create(directory: &Path, topics: &[Topic], command: &'static str) -> Result<Self, Failure> {
        let name = directory.file_name().map(|n| n.to_string_lossy().into_owned());
        let Some(name) = name.filter(|_| directory.extension().is_none_or(|e| e != "mcap")) else {
            let shown = directory.display();
            return Err(Failure::usage(format!(
                "--record {shown} must name a directory, as bag record -o does"
            )));
        };
        let specs: Vec<TopicSpec> =
            topics.iter().map(|t| TopicSpec::of_contract(t, &t.absolute_name())).collect();
        let mut writer = RunWriter::create(directory, &name, &specs, WriterOptions::default())?;
        writer.set_metadata("grainlab", env!("CARGO_PKG_VERSION"));
        // Equal messages give equal files at any time of day.
        writer.set_metadata(SESSION_KEY, command);
        let mut guid = Guid([b' '; 16]);
        let title = format!("grainlab {command}");
        guid.0.iter_mut().zip(title.bytes()).for_each(|(to, from)| *to = from);
        Ok(Self { writer, guid, command, counts: topics.iter().map(|t| (*t, 0)).collect() })
    }

    pub(crate) fn put(&mut self, message: &Recorded) -> Result<(), Failure> {
        let Recorded { topic, time, payload } = message;
        let known = self.counts.iter_mut().find(|(known, _)| known.name == topic.name);
        let Some((_, sequence)) = known else {
            return Err(Failure::failed(format!("{} is not among the topics recorded", topic.name)));
        };
        *sequence += 1;
        let (source_time, receive_time) = (Some(*time), *time);
        let sample = Incoming { guid: self.guid, sequence: *sequence, source_time, receive_time, payload };
        self.writer.write(&topic.absolute_name(), &sample).map(drop).map_err(Failure::failed)
    }

    pub(crate) fn finish(mut self) -> Result<(), Failure> {
        for (topic, count) in &self.counts {
            self.writer.ledger_mut().report(&topic.absolute_name(), self.guid, *count as u64);
        }
        self.writer.ledger_mut().name(self.guid, self.command);
        self.writer.finish().map(drop).map_err(Failure::failed)
    }
}
