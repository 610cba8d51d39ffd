//! Topics of several recordings as those of one.

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Arc;

use grainlab_console::Failure;

use crate::reader::{ChannelInfo, Recording};

#[derive(Default)]
pub(super) struct Channels<'a> {
    /// In the order of their first recording.
    pub(super) list: Vec<Arc<ChannelInfo>>,
    /// Places in the list, by the address of each channel of the recordings.
    places: BTreeMap<usize, usize>,
    /// Places in the list, by all that a file states of a channel.
    known: BTreeMap<Stated<'a>, usize>,
    /// Places in the list of the channels of a topic, and the number of the recording of each.
    by_topic: BTreeMap<&'a str, Vec<(usize, usize)>>,
    /// Differences that were settled.
    pub(super) notes: Vec<String>,
}

/// Topic, encoding and metadata of a channel; name, encoding and content of its schema.
type Stated<'a> = (&'a str, &'a str, &'a BTreeMap<String, String>, &'a str, &'a str, &'a [u8]);

fn stated(c: &ChannelInfo) -> Stated<'_> {
    (&c.topic, &c.message_encoding, &c.metadata, &c.ros_type, &c.schema_encoding, &c.schema)
}

impl<'a> Channels<'a> {
    pub(super) fn of(
        recordings: &'a [Recording],
        is_wanted: &dyn Fn(&ChannelInfo) -> bool,
    ) -> Result<Self, Failure> {
        let mut all = Self::default();
        for number in 0..recordings.len() {
            for channel in recordings[number].all_channels().filter(|c| is_wanted(c)) {
                let place = all.add(recordings, number, channel)?;
                all.places.insert(Arc::as_ptr(channel).addr(), place);
                all.known.insert(stated(channel), place);
            }
        }
        Ok(all)
    }

    /// Returns the place of a channel of the recordings in the list; `None` if the channel is not wanted.
    pub(super) fn place(&self, channel: &Arc<ChannelInfo>) -> Option<usize> {
        self.places.get(&Arc::as_ptr(channel).addr()).copied()
    }

    /// Returns the place of a channel of recording `number`; adds the channel to the list if it is new.
    fn add(
        &mut self,
        recordings: &'a [Recording],
        number: usize,
        channel: &'a Arc<ChannelInfo>,
    ) -> Result<usize, Failure> {
        if let Some(place) = self.known.get(&stated(channel)) {
            return Ok(*place);
        }
        let of_topic = self.by_topic.entry(&channel.topic).or_default();
        // Two publishers of one recording have a channel each.
        let of_others = || of_topic.iter().filter(|(_, from)| *from != number);
        let [path, from] =
            [number, of_others().next().map_or(number, |(_, from)| *from)].map(|n| recordings[n].path());
        if let Some((place, _)) = of_others().find(|(place, _)| self.list[*place].is_read_as(channel)) {
            if self.list[*place].qos != channel.qos {
                let (topic, from, path) = (&channel.topic, from.display(), path.display());
                self.notes.push(format!("{topic}: its QoS in {path} differs; that of {from} is kept"));
            }
            return Ok(*place);
        }
        if let Some((place, _)) = of_others().next() {
            return Err(differs(&self.list[*place], from, channel, path));
        }
        of_topic.push((self.list.len(), number));
        self.list.push(channel.clone());
        Ok(self.list.len() - 1)
    }
}

fn differs(kept: &ChannelInfo, from: &Path, other: &ChannelInfo, path: &Path) -> Failure {
    let (topic, from, path) = (&other.topic, from.display(), path.display());
    if kept.ros_type == other.ros_type && kept.is_without_definition() != other.is_without_definition() {
        let (channel, path) = if kept.is_without_definition() { (kept, from) } else { (other, path) };
        return Failure::usage(format!(
            "{topic} in {path}: {}; or leave the topic out with --exclude",
            channel.advice()
        ));
    }
    if let Some((what, kept, other)) = kept.differs_as(other).filter(|(what, ..)| *what != "type") {
        return Failure::usage(format!(
            "{topic}: its {what} is {kept} in {from} and {other} in {path}: leave the topic out with --exclude, or merge the \
             recordings that agree"
        ));
    }
    let (kept, other) = (&kept.ros_type, &other.ros_type);
    Failure::usage(format!(
        "{topic} is {kept} in {from} and {other}, with other fields, in {path}: readers such as rosbags take one definition for a \
         type and would misread the other messages. Leave the topic out with --exclude, or merge the recordings that agree"
    ))
}
