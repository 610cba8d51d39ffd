//! `grainlab bag diff`.

use crate::decoders::schema_of;
use crate::opened::losses;
use crate::selection::Topics;
use grainlab_any_message::Shown;
use grainlab_console::{Failure, Format, Table, worse};
use grainlab_msgs::msg::Microstructure;
use grainlab_msgs::{Exit, Topic, topics};
use grainlab_recordings::{ChannelInfo, Message, MessagePath, Recording, Selection};
use serde::Serialize;
use serde_json::Value;
use std::collections::{BTreeMap, HashSet};
use std::hash::{BuildHasher, RandomState};
use std::path::PathBuf;
use std::sync::Arc;

const EXAMPLES: &str = "\
Examples:
  grainlab bag diff recordings/runs/demo-1-1 recordings/runs/demo-1-2
  grainlab bag diff camera.mcap copy.mcap --times

The messages of each topic are compared byte by byte, in their order, without padding at the end of messages in CDR, and so are the definitions of their
types; of the first that differs the first field that does is shown. Of a reproducible topic of the laboratory, repeats of a message (of a
restarted node) are left out, and estimates are compared source by source; its topics that depend on the clock are compared with --all, or if topics are named. Exit 1 if anything differs, 3 if a part could not be read.";

/// Arguments of `grainlab bag diff`.
#[derive(Debug, clap::Args)]
#[command(after_help = EXAMPLES)]
pub struct Args {
    /// First recording: run directory or MCAP file
    #[arg(value_name = "A")]
    first: PathBuf,
    /// Second recording: run directory or MCAP file
    #[arg(value_name = "B")]
    second: PathBuf,
    #[command(flatten)]
    topics: Topics,
    #[command(flatten)]
    messages: MessagePath,
    /// Compare the times of publishing, too
    #[arg(long)]
    times: bool,
    /// Compare topics of the laboratory that depend on the clock, too
    #[arg(long)]
    all: bool,
    /// Format of the result
    #[arg(long, value_enum, default_value_t)]
    format: Format,
}

/// The comparison of one topic.
#[derive(Serialize)]
struct Compared {
    topic: String,
    /// Numbers of messages, without repeats.
    messages: [usize; 2],
    /// `same`, `differ`, `only in A`, `only in B`, `no messages`, or `not compared`.
    payload: &'static str,
    /// True if the times of publishing are the same.
    same_times: bool,
    /// Place and values of the first difference.
    first_difference: Option<String>,
}

/// Runs the command.
///
/// # Errors
/// If a recording cannot be read, or has no topic that is asked for.
pub(crate) fn run(args: &Args) -> Result<Exit, Failure> {
    let both = [args.messages.open(&args.first)?.0, args.messages.open(&args.second)?.0];
    let topics = args.topics.check(&both)?;
    let channels = both.each_ref().map(|recording| {
        let wanted = recording.channels().into_iter().filter(|c| topics.take(c));
        wanted.map(|c| (c.topic.clone(), c)).collect::<BTreeMap<String, Arc<ChannelInfo>>>()
    });
    let mut rows = Vec::new();
    let names: std::collections::BTreeSet<&String> = channels.iter().flat_map(BTreeMap::keys).collect();
    for name in names {
        rows.push(compared(args, &both, name, channels.each_ref().map(|all| all.get(name)))?);
    }
    args.format.print(&rows, || table(&rows).csv(), || text(&rows))?;
    // A stored file that cannot be read is not compared, and no reason to call both complete.
    both.iter().for_each(|recording| drop(recording.stored_files()));
    let differs = |r: &Compared| {
        !["same", "not compared", "no messages"].contains(&r.payload) || args.times && !r.same_times
    };
    let exit = if rows.iter().any(differs) { Exit::Failure } else { Exit::Done };
    Ok(worse(exit, losses(&both)))
}

fn compared(
    args: &Args,
    both: &[Recording; 2],
    name: &str,
    channels: [Option<&Arc<ChannelInfo>>; 2],
) -> Result<Compared, Failure> {
    let contract = channels.iter().flatten().find_map(|c| Topic::of_channel(&c.topic, &c.ros_type));
    let is_reproducible = contract.is_some_and(|topic| topic.reproducible);
    let selection = Selection::topics([name]);
    let hashes = [RandomState::new(), RandomState::new()];
    let distinct = |k: usize| {
        let mut seen = HashSet::new();
        let hash = |m: &Message| hashes.each_ref().map(|h| h.hash_one(&m.payload[..]));
        let all = channels[k].map(|_| both[k].messages(&selection).map_err(Failure::failed)).transpose()?;
        let all = all.into_iter().flatten().filter(move |m| !is_reproducible || seen.insert(hash(m)));
        Ok::<Box<dyn Iterator<Item = Message>>, Failure>(if contract == Some(&topics::MICROSTRUCTURE) {
            Box::new(by_source(all.collect()))
        } else {
            Box::new(all)
        })
    };
    let (mut a, mut b) = (distinct(0)?, distinct(1)?);
    let mut row = Compared {
        topic: name.to_owned(),
        messages: [0; 2],
        payload: "same",
        same_times: true,
        first_difference: None,
    };
    loop {
        let pair = (a.next(), b.next());
        row.messages[0] += usize::from(pair.0.is_some());
        row.messages[1] += usize::from(pair.1.is_some());
        match pair {
            (None, None) => break,
            (Some(a), Some(b)) => {
                row.same_times &= a.publish_time == b.publish_time;
                if !is_same(&a, &b) && row.first_difference.is_none() {
                    row.first_difference =
                        Some(format!("message {}: {}", row.messages[0], difference(&a, &b)));
                }
            }
            _ => row.same_times = false,
        }
    }
    let not_compared = contract.is_some() && !is_reproducible && !args.all && !args.topics.is_given();
    row.payload = match channels {
        _ if not_compared => "not compared",
        [None, _] | [_, None] if row.messages == [0, 0] => "no messages",
        [Some(a), Some(b)] if !a.is_read_as(b) => {
            row.first_difference = Some(match a.differs_as(b) {
                Some((what, a, b)) => format!("its {what} is {a} in A and {b} in B"),
                None => format!("its definition of {:?} differs", a.ros_type),
            });
            "differ"
        }
        [Some(_), None] => "only in A",
        [None, Some(_)] => "only in B",
        _ if row.messages[0] != row.messages[1] || row.first_difference.is_some() => "differ",
        _ => "same",
    };
    row.first_difference = row.first_difference.filter(|_| !not_compared);
    Ok(row)
}

/// Estimates of one source after the other: which of two sources comes first depends on the time that each measurement takes.
fn by_source(mut all: Vec<Message>) -> impl Iterator<Item = Message> {
    all.sort_by_cached_key(|m| m.decoded::<Microstructure>().map(|m| m.source).unwrap_or_default());
    all.into_iter()
}

/// True for the same bytes; RTPS fills up the last word of what was sent over DDS, so that the shorter message must be complete.
fn is_same(a: &Message, b: &Message) -> bool {
    let (short, long) = if a.payload.len() < b.payload.len() { (a, b) } else { (b, a) };
    long.payload.strip_prefix(&short.payload[..]).is_some_and(|rest| {
        let is_padding = rest.len() < 4 && long.payload.len() % 4 == 0;
        let decodes = || schema_of(&short.channel).is_ok_and(|schema| schema.decode(&short.payload).is_ok());
        rest.is_empty() || is_padding && decodes()
    })
}

/// The first field of two messages that differs, or the first byte.
fn difference(a: &Message, b: &Message) -> String {
    let value = |m: &Message| {
        let decoded = schema_of(&m.channel).ok()?.decode(&m.payload).ok()?;
        serde_json::to_value(Shown::new(&decoded)).ok()
    };
    let found = value(a).zip(value(b)).and_then(|(a, b)| of_values(&a, &b, ""));
    found.unwrap_or_else(|| {
        let byte = a.payload.iter().zip(b.payload.iter()).position(|(a, b)| a != b);
        let byte = byte.unwrap_or(a.payload.len().min(b.payload.len()));
        format!("byte {byte} of {} and {}", a.payload.len(), b.payload.len())
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

fn table(rows: &[Compared]) -> Table {
    let mut table = Table::new(["topic", "A", "B", "payload", "publish times"]);
    for r in rows {
        let times = if r.same_times { "same" } else { "differ" };
        let [a, b] = r.messages.map(|n| n.to_string());
        table.row([r.topic.clone(), a, b, r.payload.to_owned(), times.to_owned()]);
    }
    table
}

fn text(rows: &[Compared]) -> String {
    let first = rows.iter().filter_map(|r| Some(format!("{}: {}\n", r.topic, r.first_difference.as_ref()?)));
    table(rows).text() + &first.collect::<String>()
}

#[cfg(test)]
mod tests {
    use super::*;
    use grainlab_msgs::Message as _;
    use mcap::records::MessageHeader;

    /// The first message of a recording with this one only.
    fn message(encoding: &str, (ros_type, schema): (&str, &[u8]), payload: &[u8]) -> Message {
        let file = tempfile::NamedTempFile::new().unwrap();
        let mut writer = mcap::Writer::new(file.reopen().unwrap()).unwrap();
        let schema =
            if schema.is_empty() { 0 } else { writer.add_schema(ros_type, "ros2msg", schema).unwrap() };
        let channel_id = writer.add_channel(schema, "/t", encoding, &BTreeMap::new()).unwrap();
        let header = MessageHeader { channel_id, sequence: 0, log_time: 1, publish_time: 1 };
        writer.write_to_known_channel(&header, payload).unwrap();
        writer.finish().unwrap();
        let recording = Recording::open(file.path()).unwrap();
        recording.messages(&Selection::default()).unwrap().next().unwrap()
    }

    #[test]
    fn padding_is_ignored_only_behind_a_complete_message_in_cdr_of_known_type() {
        let same = |encoding, schema: &[u8], a, b| {
            let (a, b) =
                (message(encoding, ("my/msg/X", schema), a), message(encoding, ("my/msg/X", schema), b));
            assert!(is_same(&a, &a) && is_same(&a, &b) == is_same(&b, &a));
            is_same(&a, &b)
        };
        assert!(same("cdr", b"uint8 x\n", b"\0\x01\0\0\x01", b"\0\x01\0\0\x01\0\0\0"));
        assert!(!same("cdr", b"uint8[3] x\n", b"\0\x01\0\0\x01", b"\0\x01\0\0\x01\x02\0\0"));
        assert!(!same("cdr", b"", b"\0\x01\0\0\x01", b"\0\x01\0\0\x01\x02\x03\x04"));
        assert!(!same("json", b"", b"123", b"1234"));
        assert!(!same("protobuf", b"", b"\x08\x01", b"\x08\x01\x10\x02"));
    }

    #[test]
    fn estimates_keep_their_order_within_a_source_whatever_came_between() {
        let of_type = (Microstructure::TYPE, Microstructure::DEFINITION.as_bytes());
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
        let [json, cbor] = ["json", "cbor"].map(|encoding| message(encoding, ("", b""), b"123").channel);
        assert_eq!(json.differs_as(&cbor), Some(("encoding", "json", "cbor")));
        assert_eq!(json.differs_as(&json), None);
    }
}
