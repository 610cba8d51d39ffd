//! Topics of several recordings as those of one.

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::Arc;

use grainlab_console::Failure;

use super::options::Select;
use crate::reader::{ChannelInfo, Recording};

/// The channels of a copy.
#[derive(Default)]
pub(super) struct Channels {
    /// In the order of their first recording.
    pub(super) list: Vec<Arc<ChannelInfo>>,
    /// Places in the list of those with this topic, and the recording of each.
    by_topic: BTreeMap<String, Vec<(usize, PathBuf)>>,
    /// Differences that were settled.
    pub(super) notes: Vec<String>,
}

impl Channels {
    /// The wanted channels of all recordings.
    pub(super) fn of(recordings: &[Recording], select: &Select<'_>) -> Result<Self, Failure> {
        let mut all = Self::default();
        for recording in recordings {
            for channel in recording.all_channels().filter(|c| (select.topic)(c)) {
                all.add(recording, channel)?;
            }
        }
        Ok(all)
    }

    /// The place of a channel in the list, or of one that is read like it: its own publisher's, if there are several.
    pub(super) fn place(&self, channel: &ChannelInfo) -> Option<usize> {
        let known = self.by_topic.get(&channel.topic)?.iter().map(|(place, _)| *place);
        let mut alike = known.filter(|place| self.list[*place].is_read_as(channel));
        let same = alike.clone().find(|place| self.list[*place].metadata == channel.metadata);
        same.or_else(|| alike.next())
    }

    fn add(&mut self, recording: &Recording, channel: &Arc<ChannelInfo>) -> Result<(), Failure> {
        let path = recording.path();
        let place = self.place(channel);
        // Two publishers of a recording have a channel each.
        let is_another = |place: &usize| {
            let of_this =
                |(place, from): &(usize, PathBuf)| from == path && self.list[*place].is_read_as(channel);
            self.list[*place].metadata != channel.metadata
                && self.by_topic[&channel.topic].iter().any(of_this)
        };
        if let Some(place) = place.filter(|place| !is_another(place)) {
            let kept = &self.list[place];
            let from = &self.by_topic[&channel.topic][0].1;
            if kept.qos != channel.qos && from != path {
                let (topic, from, path) = (&channel.topic, from.display(), path.display());
                self.notes.push(format!("{topic}: its QoS in {path} differs; that of {from} is kept"));
            }
            return Ok(());
        }
        let known = self.by_topic.entry(channel.topic.clone()).or_default();
        if let Some((place, first)) = known.iter().find(|(_, from)| from != path) {
            if let Some((what, kept, other)) =
                self.list[*place].differs_as(channel).filter(|(what, ..)| *what != "type")
            {
                return Err(Failure::usage(format!(
                    "{}: its {what} is {kept} in {} and {other} in {}: leave the topic out with --exclude, or merge the \
                     recordings that agree",
                    channel.topic,
                    first.display(),
                    path.display()
                )));
            }
            return Err(Failure::usage(format!(
                "{} is {} in {} and {}, with other fields, in {}: readers such as rosbags take one definition for a type and \
                 would misread the other messages. Leave the topic out with --exclude, or merge the recordings that agree",
                channel.topic,
                self.list[*place].ros_type,
                first.display(),
                channel.ros_type,
                path.display()
            )));
        }
        known.push((self.list.len(), path.to_owned()));
        self.list.push(channel.clone());
        Ok(())
    }
}
