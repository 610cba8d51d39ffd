//! The copy itself.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use grainlab_console::{Failure, count};
use serde::Serialize;

use super::channels::Channels;
use super::extras::Extras;
use super::options::{CopyOptions, Select};
use super::output::Output;
use super::pictures::Pictures;
use crate::reader::{ChannelInfo, Message, Messages, Recording, Selection};

/// A finished copy.
#[derive(Clone, Debug, Serialize)]
pub struct Copied {
    /// Path of the output.
    pub path: PathBuf,
    /// Size of its MCAP file, bytes.
    pub bytes: u64,
    /// Messages in it, with pictures.
    pub messages: u64,
    /// Those that are latched and from before the start.
    pub latched: u64,
    /// Names of its topics.
    pub topics: Vec<String>,
    /// Pictures of packings added to them.
    pub pictures: u64,
    /// Packings of which no picture could be made.
    pub without_picture: u64,
    /// Differences between the recordings that were settled, and packings without a picture, as text.
    pub notes: Vec<String>,
}

/// Copies the selected messages of the recordings to the new recording `to`: a directory, or a file if its name ends with
/// `.mcap`. Parts that cannot be read become warnings of the recordings.
///
/// # Errors
/// If the output exists, two recordings have different types under one topic, writing fails, or `progress` does. Nothing is left then.
pub fn copy(
    recordings: &[Recording],
    select: &Select<'_>,
    to: &Path,
    options: &CopyOptions,
) -> Result<Copied, Failure> {
    let channels = Channels::of(recordings, select)?;
    let extras = Extras::of(recordings, &options.operation);
    let mut pictures = if options.pictures { Pictures::of(&channels)? } else { Pictures::default() };
    let mut output = Output::begin(to, recordings.first().map_or("ros2", Recording::profile), options)?;
    let carried = output.carry(recordings);
    for channel in channels.list.iter().chain(&pictures.channels) {
        output.declare(channel)?;
    }
    for file in &extras.files {
        output.store(file)?;
    }
    let mut places = Places { channels: &channels, known: BTreeMap::new() };
    let (mut messages, mut latched, mut made) = (0, 0, 0);
    let topics: Vec<String> = channels.list.iter().map(|c| c.topic.clone()).collect();
    if let Some(start) = select.start.filter(|_| select.latched) {
        for message in before(recordings, &channels, start) {
            let Some(place) = places.of(&message.channel) else { continue };
            latched += 1;
            made += write(&mut output, &mut pictures, place, start, &message)?;
        }
    }
    let mut repeated = 0;
    for message in merged(recordings, &topics, select, &mut repeated) {
        let Some(place) = places.of(&message.channel) else { continue };
        messages += 1;
        (select.progress)(message.log_time)?;
        made += write(&mut output, &mut pictures, place, message.log_time, &message)?;
    }
    for record in &extras.metadata {
        output.metadata(record)?;
    }
    let bytes = output.finish()?;
    let mut notes = channels.notes;
    if repeated > 0 {
        notes.push(format!(
            "{} {} in more than one of the recordings; each is written once",
            count(repeated, "message"),
            if repeated == 1 { "is" } else { "are" }
        ));
    }
    notes.extend(extras.notes);
    notes.extend(carried);
    notes.extend(pictures.notes);
    Ok(Copied {
        path: to.to_owned(),
        bytes,
        messages: messages + latched + made,
        latched,
        topics: channels.list.iter().chain(&pictures.channels).map(|c| c.topic.clone()).collect(),
        pictures: made,
        without_picture: pictures.missing,
        notes,
    })
}

/// Writes a message to the channel at this place, and the pictures of it, with its times; returns their number.
fn write(
    output: &mut Output,
    pictures: &mut Pictures,
    place: usize,
    log_time: u64,
    message: &Message,
) -> Result<u64, Failure> {
    let (sequence, publish_time) = (message.sequence, message.publish_time);
    output.message(place, sequence, log_time, publish_time, &message.payload)?;
    let made = pictures.made(place, message);
    for (place, payload) in &made {
        output.message(*place, sequence, log_time, publish_time, payload)?;
    }
    Ok(made.len() as u64)
}

/// Finds the place of a channel.
struct Places<'a> {
    channels: &'a Channels,
    /// Places found before. A channel is known by its address, which stays its own while it is in here.
    known: BTreeMap<usize, (Arc<ChannelInfo>, Option<usize>)>,
}

impl Places<'_> {
    fn of(&mut self, channel: &Arc<ChannelInfo>) -> Option<usize> {
        let found = || (channel.clone(), self.channels.place(channel));
        self.known.entry(Arc::as_ptr(channel).addr()).or_insert_with(found).1
    }
}

/// The latched messages that a late reader would have at `start`, in order of log time.
fn before(recordings: &[Recording], channels: &Channels, start: u64) -> Vec<Message> {
    let mut found = Vec::new();
    for channel in channels.list.iter().filter(|c| c.is_latched()) {
        let depth = channel.latched_depth();
        let mut of_topic: Vec<Message> = recordings
            .iter()
            .filter_map(|r| r.some_before(&channel.topic, Some(start), depth).ok())
            .flatten()
            .filter(|m| channels.place(&m.channel).is_some_and(|p| Arc::ptr_eq(&channels.list[p], channel)))
            .collect();
        of_topic.sort_by_key(|m| m.log_time);
        of_topic.dedup_by(|a, b| a.is_copy_of(b));
        found.extend(of_topic.split_off(of_topic.len().saturating_sub(depth)));
    }
    found.sort_by_key(|m| m.log_time);
    found
}

/// The messages of all recordings in order of log time; those of equal time in the order of the recordings. A message that was in
/// a recording before is left out, and counted.
fn merged<'r>(
    recordings: &'r [Recording],
    topics: &[String],
    select: &Select<'_>,
    repeated: &'r mut u64,
) -> impl Iterator<Item = Message> + 'r {
    let of = |recording: &'r Recording| {
        let here = |name: &&String| recording.channel(name).is_ok();
        let topics = Some(topics.iter().filter(here).cloned().collect());
        let messages = recording.messages(&Selection { topics, start: select.start, end: select.end });
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
