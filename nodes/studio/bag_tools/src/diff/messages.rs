//! How two messages differ, and the order in which estimates are compared.

use crate::decoders::schema_of;
use grainlab_any_message::Shown;
use grainlab_msgs::msg::Microstructure;
use grainlab_recordings::{ChannelInfo, Message};
use serde_json::Value;

/// Estimates of one source after the other: which of two sources comes first depends on the time that each measurement takes.
pub(super) fn by_source(mut all: Vec<Message>) -> impl Iterator<Item = Message> {
    all.sort_by_cached_key(|m| m.decoded::<Microstructure>().map(|m| m.source).unwrap_or_default());
    all.into_iter()
}

/// True for the same bytes; RTPS fills up the last word of what was sent over DDS, so that the shorter message must be complete.
pub(super) fn is_same(a: (&ChannelInfo, &[u8]), b: (&ChannelInfo, &[u8])) -> bool {
    let ((channel, short), (_, long)) = if a.1.len() < b.1.len() { (a, b) } else { (b, a) };
    long.strip_prefix(short).is_some_and(|rest| {
        let is_padding = rest.len() < 4 && long.len() % 4 == 0;
        let decodes = || schema_of(channel).is_ok_and(|schema| schema.decode(short).is_ok());
        rest.is_empty() || is_padding && decodes()
    })
}

/// The first field of two messages that differs, or the first byte.
pub(super) fn difference(a: (&ChannelInfo, &[u8]), b: (&ChannelInfo, &[u8])) -> String {
    let value = |(channel, payload): (&ChannelInfo, &[u8])| {
        let decoded = schema_of(channel).ok()?.decode(payload).ok()?;
        serde_json::to_value(Shown::new(&decoded)).ok()
    };
    let found = value(a).zip(value(b)).and_then(|(a, b)| of_values(&a, &b, ""));
    found.unwrap_or_else(|| {
        let (a, b) = (a.1, b.1);
        let byte = a.iter().zip(b).position(|(a, b)| a != b);
        format!("byte {} of {} and {}", byte.unwrap_or(a.len().min(b.len())), a.len(), b.len())
    })
}

fn of_values(a: &Value, b: &Value, path: &str) -> Option<String> {
    match (a, b) {
        (Value::Object(a), Value::Object(b)) => a.iter().find_map(|(name, a)| {
            let dot = if path.is_empty() { "" } else { "." };
            of_values(a, b.get(name)?, &format!("{path}{dot}{name}"))
        }),
        (Value::Array(a), Value::Array(b)) if a.len() != b.len() => {
            Some(format!("{path} has {} and {} values", a.len(), b.len()))
        }
        (Value::Array(a), Value::Array(b)) => {
            a.iter().zip(b).enumerate().find_map(|(k, (a, b))| of_values(a, b, &format!("{path}[{k}]")))
        }
        _ => (a != b).then(|| format!("{path} is {a} and {b}")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use grainlab_msgs::Message as _;
    use grainlab_recordings::Selection;

    /// The first message of a recording with this one only.
    fn message(encoding: &str, of_type: [&str; 2], payload: &[u8]) -> Message {
        let recording = crate::testing::recording([("/t".to_owned(), encoding, of_type, payload.to_vec())]);
        recording.messages(&Selection::default()).unwrap().next().unwrap()
    }

    #[test]
    fn padding_is_ignored_only_behind_a_complete_message_in_cdr_of_known_type() {
        let same = |encoding, schema, a, b| {
            let both = [a, b].map(|payload| message(encoding, ["my/msg/X", schema], payload));
            let [a, b] = both.each_ref().map(|m| (&*m.channel, &m.payload[..]));
            assert!(is_same(a, a) && is_same(a, b) == is_same(b, a));
            is_same(a, b)
        };
        assert!(same("cdr", "uint8 x\n", b"\0\x01\0\0\x01", b"\0\x01\0\0\x01\0\0\0"));
        assert!(!same("cdr", "uint8[3] x\n", b"\0\x01\0\0\x01", b"\0\x01\0\0\x01\x02\0\0"));
        assert!(!same("cdr", "", b"\0\x01\0\0\x01", b"\0\x01\0\0\x01\x02\x03\x04"));
        assert!(!same("json", "", b"123", b"1234"));
        assert!(!same("protobuf", "", b"\x08\x01", b"\x08\x01\x10\x02"));
    }

    #[test]
    fn estimates_keep_their_order_within_a_source_whatever_came_between() {
        let of_type = [Microstructure::TYPE, Microstructure::DEFINITION];
        let estimate = |source: &str, source_step| {
            let estimate =
                Microstructure { source: source.to_owned(), source_step, ..Microstructure::default() };
            message("cdr", of_type, &estimate.encoded())
        };
        let steps = |all: [(&str, u64); 3]| {
            let sorted = by_source(all.map(|(source, step)| estimate(source, step)).into());
            sorted.map(|m| m.decoded::<Microstructure>().unwrap().source_step).collect::<Vec<_>>()
        };
        assert_eq!(steps([("report", 1), ("speeds", 1), ("report", 2)]), [1, 2, 1]);
        assert_eq!(steps([("report", 2), ("report", 1), ("speeds", 1)]), [2, 1, 1]);
    }

    #[test]
    fn channels_of_other_encodings_are_named_by_them() {
        let [json, cbor] = ["json", "cbor"].map(|encoding| message(encoding, [""; 2], b"123").channel);
        assert_eq!(json.differs_as(&cbor), Some(("encoding", "json", "cbor")));
        assert_eq!(json.differs_as(&json), None);
    }
}
