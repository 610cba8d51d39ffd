//! Messages of a recording, decoded by the schemas in it.

use grainlab_any_message::{Message, Schema};
use grainlab_console::{count, say};
use grainlab_msgs::Exit;
use grainlab_recordings::{ChannelInfo, Recording};
use serde::de::IgnoredAny;
use std::collections::BTreeMap;
use std::sync::Arc;

/// Prints what could not be read; exit 3 if there is anything.
pub(crate) fn losses(recordings: &[Recording]) -> Exit {
    let mut exit = Exit::Done;
    for warning in recordings.iter().flat_map(Recording::warnings) {
        say!("grainlab: {warning}");
        exit = Exit::DataLoss;
    }
    exit
}

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
            "its messages are {message:?} by a schema in {schema:?}, not CDR by a schema in ros2msg: print them with a program \
             that reads this encoding (`mcap cat --json`); `grainlab bag convert --format mcap` copies them as they are"
        ));
    }
    Schema::parse(&channel.ros_type, &channel.definition).map_err(|e| e.to_string())
}

impl Decoders {
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

    /// The text of a message recorded as JSON, in one line; `None` if it is not valid.
    pub(crate) fn json(&mut self, message: &grainlab_recordings::Message) -> Option<String> {
        let text = str::from_utf8(&message.payload).map_err(|e| e.to_string());
        let valid = text.and_then(|text| match serde_json::from_str::<IgnoredAny>(text) {
            // Ends of lines in valid JSON are between values only.
            Ok(_) => Ok(text.trim().replace(['\n', '\r'], " ")),
            Err(e) => Err(e.to_string()),
        });
        valid.inspect_err(|e| self.fail(&message.channel.topic, &format!("it is not JSON: {e}"))).ok()
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::recording;
    use grainlab_recordings::Selection;

    #[test]
    fn json_is_kept_as_it_is_and_what_is_not_decoded_is_left_out_with_its_encoding_and_a_way() {
        let all = [
            ("/j", "json", "{\"b\": 1.50,\n \"a\": [1e2]}"),
            ("/j", "json", "{\"b\": \"line\nline\"}"),
            ("/p", "protobuf", "\u{8}\u{1}"),
        ];
        let of = |(topic, encoding, payload): (&str, _, &str)| {
            (topic.into(), encoding, ["X", "x"], payload.into())
        };
        let recording = recording(all.map(of));
        let messages: Vec<_> = recording.messages(&Selection::default()).unwrap().collect();
        let mut decoders = Decoders::default();
        assert_eq!(decoders.json(&messages[0]).unwrap(), "{\"b\": 1.50,  \"a\": [1e2]}");
        assert!(decoders.json(&messages[1]).is_none() && decoders.decode(&messages[2]).is_none());
        assert!(decoders.failures["/j"].0.starts_with("it is not JSON"));
        let protobuf = &decoders.failures["/p"].0;
        assert!(protobuf.contains("\"protobuf\"") && protobuf.contains("mcap cat"), "{protobuf}");
        assert_eq!(decoders.losses(), Exit::DataLoss);
    }
}
