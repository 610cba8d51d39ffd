//! A recording made from others: some topics, an interval of time, another compression, several recordings as one.
//!
//! [`copy`] reads one recording or several and writes the selected messages, in order of log time, as a directory of rosbag2
//! (`NAME/NAME_0.mcap` and `metadata.yaml`) or as one file. Payloads, times, sequences, schemas and channels are unchanged;
//! stored files and metadata records are kept. What differs:
//!
//! - latched messages from before the start, as a late reader would get them: their log time is the start, their publish time
//!   is unchanged
//! - a message that several recordings have is written once
//! - the ledger of the recorder, and rosbag2's record of counts, which would contradict the copy, are left out; the record
//!   `grainlab_copy` names the sources
//! - with [`CopyOptions::pictures`], each topic with packings has topics with pictures of them beside it
//! - names of stored files and metadata records that are in several recordings with different content get a number
//! - records that MCAP does not define are left out, with a note
//!
//! The output is written under a temporary name and renamed at the end. An existing one is never overwritten.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use grainlab_console::{Failure, count};

use crate::compression::Compression;
use crate::reader::{ChannelInfo, Message, Messages, Recording, Selection};

mod channels;
mod extras;
mod output;
mod pictures;

use channels::Channels;
use extras::Extras;
use output::Output;
use pictures::Pictures;

/// The messages to copy, and the form of the output.
pub struct CopyOptions<'a> {
    /// Test of a channel: true if its messages are wanted.
    pub channel: &'a dyn Fn(&ChannelInfo) -> bool,
    /// First log time, ns since 1970.
    pub start: Option<u64>,
    /// Log time before which to end, ns since 1970.
    pub end: Option<u64>,
    /// Called with the log time of each message of the interval; an error ends the copy.
    pub progress: &'a dyn Fn(u64) -> Result<(), Failure>,
    /// Compression of the chunks.
    pub compression: Compression,
    /// Add to each topic with packings topics with pictures of them.
    pub pictures: bool,
}

impl Default for CopyOptions<'_> {
    fn default() -> Self {
        Self {
            channel: &|_| true,
            start: None,
            end: None,
            progress: &|_| Ok(()),
            compression: Compression::Zstd,
            pictures: false,
        }
    }
}

/// A finished copy.
#[derive(Clone, Debug, Default)]
pub struct Copied {
    /// Size of its MCAP file, bytes.
    pub bytes: u64,
    /// Messages in it, with pictures.
    pub messages: u64,
    /// Latched messages from before the start.
    pub latched: u64,
    /// Pictures of packings.
    pub pictures: u64,
    /// Number of its topics.
    pub topics: usize,
    /// Differences between the recordings that were settled, and what is left out, as text.
    pub notes: Vec<String>,
    /// True if a picture, or a record that MCAP does not define, is left out.
    pub is_incomplete: bool,
}

/// Copies the selected messages of the recordings to the new recording `to`: a directory, or a file if its name ends with
/// `.mcap`. Parts that cannot be read become warnings of the recordings.
///
/// # Errors
/// If the output exists, two recordings have different types under one topic, writing fails, or `progress` does. Nothing is left then.
pub fn copy(recordings: &[Recording], to: &Path, options: &CopyOptions<'_>) -> Result<Copied, Failure> {
    let channels = Channels::of(recordings, options.channel)?;
    let extras = Extras::of(recordings);
    let mut pictures = if options.pictures { Pictures::of(&channels)? } else { Pictures::default() };
    let profile = recordings.first().map_or("ros2", Recording::profile);
    let mut output = Output::begin(to, profile, options.compression)?;
    let carried = output.carry(recordings);
    for channel in channels.list.iter().chain(&pictures.channels) {
        output.declare(channel)?;
    }
    for (name, encoding, content) in recordings.iter().flat_map(Recording::unused_schemas) {
        output.schema(name, encoding, content)?;
    }
    for file in &extras.files {
        output.store(file)?;
    }
    let mut copied = Copied::default();
    let mut write = |copied: &mut Copied, log_time: u64, message: &Message| {
        let Some(place) = channels.place(&message.channel) else { return Ok(()) };
        output.message(place, log_time, message, &message.payload)?;
        let made = pictures.made(place, message);
        copied.messages += 1 + made.len() as u64;
        copied.pictures += made.len() as u64;
        made.iter().try_for_each(|(place, payload)| output.message(*place, log_time, message, payload))
    };
    for message in options.start.iter().flat_map(|start| before(recordings, &channels, *start)) {
        write(&mut copied, options.start.unwrap_or(message.log_time), &message)?;
    }
    copied.latched = copied.messages - copied.pictures;
    let mut repeated = 0;
    for message in merged(recordings, &channels, options, &mut repeated) {
        (options.progress)(message.log_time)?;
        write(&mut copied, message.log_time, &message)?;
    }
    for record in &extras.metadata {
        output.metadata(record)?;
    }
    copied.bytes = output.finish()?;
    copied.topics =
        channels.list.iter().chain(&pictures.channels).map(|c| &c.topic).collect::<BTreeSet<_>>().len();
    copied.notes = channels.notes;
    if repeated > 0 {
        copied.notes.push(format!(
            "{} {} in more than one of the recordings; each is written once",
            count(repeated, "message"),
            if repeated == 1 { "is" } else { "are" }
        ));
    }
    copied.notes.extend(extras.notes);
    let unknown: BTreeSet<u8> = recordings.iter().flat_map(Recording::unknown_records).collect();
    if !unknown.is_empty() {
        let types = unknown.iter().map(|opcode| format!("0x{opcode:02x}")).collect::<Vec<_>>().join(", ");
        copied.notes.push(format!("records of type {types}, which MCAP does not define (yet), are left out"));
    }
    copied.is_incomplete = !unknown.is_empty() || !pictures.notes.is_empty();
    copied.notes.extend(carried.into_iter().chain(pictures.notes));
    Ok(copied)
}

/// The latched messages that a late reader would have at `start`, in order of log time.
fn before(recordings: &[Recording], channels: &Channels<'_>, start: u64) -> Vec<Message> {
    let mut depths = BTreeMap::<String, usize>::new();
    for channel in channels.list.iter().filter(|c| c.is_latched()) {
        let depth = depths.entry(channel.topic.clone()).or_default();
        *depth = channel.latched_depth().max(*depth);
    }
    // The messages of each channel of the copy.
    let mut all = BTreeMap::<usize, Vec<Message>>::new();
    for message in recordings.iter().flat_map(|r| r.each_before(&depths, Some(start)).into_values().flatten())
    {
        if let Some(place) = channels.place(&message.channel) {
            all.entry(place).or_default().push(message);
        }
    }
    let mut found = Vec::new();
    for (place, mut of_channel) in all {
        let channel = &channels.list[place];
        of_channel.sort_by_key(|m| m.log_time);
        of_channel.dedup_by(|a, b| a.is_copy_of(b));
        let kept = if channel.is_latched() { channel.latched_depth() } else { 0 };
        found.extend(of_channel.split_off(of_channel.len().saturating_sub(kept)));
    }
    found.sort_by_key(|m| m.log_time);
    found
}

/// The messages of all recordings in order of log time; those of equal time in the order of the recordings. A message that was in
/// a recording before is left out, and counted.
fn merged<'r>(
    recordings: &'r [Recording],
    channels: &Channels<'_>,
    options: &CopyOptions<'_>,
    repeated: &'r mut u64,
) -> impl Iterator<Item = Message> + use<'r> {
    let of = |recording: &'r Recording| {
        let topics = channels.list.iter().map(|c| &c.topic).filter(|topic| recording.has_topic(topic));
        let topics = Some(topics.cloned().collect());
        let messages = recording.messages(&Selection { topics, start: options.start, end: options.end });
        messages.ok().map(Messages::peekable)
    };
    let mut sources: Vec<_> = recordings.iter().filter_map(of).collect();
    // Messages of the present time, each with its source and whether another source has it, too.
    let mut present: Vec<(usize, Message, bool)> = Vec::new();
    std::iter::from_fn(move || {
        if let [only] = &mut sources[..] {
            return only.next();
        }
        loop {
            let times = sources.iter_mut().enumerate().filter_map(|(n, s)| Some((s.peek()?.log_time, n)));
            let (time, earliest) = times.min()?;
            let message = sources[earliest].next()?;
            present.retain(|(_, before, _)| before.log_time == time);
            // A source that has a message twice has two messages.
            let copy = present
                .iter_mut()
                .find(|(source, before, taken)| *source != earliest && !*taken && message.is_copy_of(before));
            match copy {
                Some((_, _, taken)) => {
                    (*taken, *repeated) = (sources.len() == 2, *repeated + 1);
                }
                None => {
                    present.push((earliest, message.clone(), false));
                    return Some(message);
                }
            }
        }
    })
}
