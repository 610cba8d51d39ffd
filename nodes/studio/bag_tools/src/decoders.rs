//! Messages of a recording, decoded by the schemas in it.

use grainlab_any_message::{Message, Schema};
use grainlab_console::{count, say};
use grainlab_msgs::Exit;
use grainlab_recordings::ChannelInfo;
use std::collections::BTreeMap;
use std::sync::Arc;

/// The schemas of the channels, and what could not be decoded.
#[derive(Default)]
pub(crate) struct Decoders {
    /// By the address of the channel, which stays its own while it is in here.
    known: BTreeMap<usize, Known>,
    /// By topic: the first error, and how many messages are left out.
    failures: BTreeMap<String, (String, u64)>,
    /// By topic: texts that are not UTF-8.
    invalid: BTreeMap<String, u64>,
}

/// First bytes of Zstandard.
const ZSTD: [u8; 4] = [0x28, 0xb5, 0x2f, 0xfd];

struct Known {
    _channel: Arc<ChannelInfo>,
    schema: Result<Schema, String>,
}

/// The schema of a channel, or why its messages cannot be decoded.
pub(crate) fn schema_of(channel: &ChannelInfo) -> Result<Schema, String> {
    if channel.is_without_definition() {
        return Err(channel.advice());
    }
    let (schema, message) = (channel.schema_encoding.as_str(), channel.message_encoding.as_str());
    if (schema, message) != ("ros2msg", "cdr") {
        return Err(format!(
            "its messages are {message:?} by a schema in {schema:?}, not CDR by a schema in ros2msg"
        ));
    }
    Schema::parse(&channel.ros_type, &channel.definition).map_err(|e| e.to_string())
}

impl Decoders {
    /// The decoded message; `None` if it cannot be decoded.
    pub(crate) fn decode(&mut self, message: &grainlab_recordings::Message) -> Option<Message> {
        let channel = &message.channel;
        let known = self
            .known
            .entry(Arc::as_ptr(channel).addr())
            .or_insert_with(|| Known { _channel: channel.clone(), schema: schema_of(channel) });
        let decoded = match &known.schema {
            Ok(_) if message.payload.starts_with(&ZSTD) => {
                Err("its messages are compressed one by one: give the directory with the metadata.yaml that says so, or \
                     write it without compression (`ros2 bag convert`)"
                    .to_owned())
            }
            Ok(schema) => schema.decode_counted(&message.payload).map_err(|e| e.to_string()),
            Err(problem) => Err(problem.clone()),
        };
        let (decoded, invalid) = decoded.inspect_err(|problem| self.fail(&channel.topic, problem)).ok()?;
        if invalid > 0 {
            *self.invalid.entry(channel.topic.clone()).or_default() += invalid;
        }
        Some(decoded)
    }

    fn fail(&mut self, topic: &str, problem: &str) {
        let new = || (problem.to_owned(), 0);
        self.failures.entry(topic.to_owned()).or_insert_with(new).1 += 1;
    }

    /// Prints what was left out; exit 3 if there is anything.
    pub(crate) fn losses(&self) -> Exit {
        for (topic, (problem, number)) in &self.failures {
            let left_out = match number {
                1 => "1 message is left out".to_owned(),
                _ => format!("{number} messages are left out; the first"),
            };
            say!("grainlab: {topic}: {left_out}: {problem}");
        }
        for (topic, texts) in &self.invalid {
            let texts = count(*texts, "text");
            say!(
                "grainlab: {topic}: {texts} not in UTF-8: U+FFFD stands for the bytes that are no characters"
            );
        }
        if self.failures.is_empty() && self.invalid.is_empty() { Exit::Done } else { Exit::DataLoss }
    }
}
