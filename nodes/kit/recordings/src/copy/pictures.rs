//! Topics with pictures of packings, beside the topics of the packings.

use std::collections::BTreeMap;
use std::sync::Arc;

use grainlab_console::Failure;
use grainlab_msgs::{Message as _, Topic, msg};
use grainlab_pictures::{Drawn, Picture, packing};

use super::channels::Channels;
use crate::reader::{ChannelInfo, Message, StoredDefinition};
use crate::writer::TopicSpec;

#[derive(Default)]
pub(super) struct Pictures {
    /// By the place of a topic with packings, that of its first picture; the others come next.
    places: BTreeMap<usize, usize>,
    /// Channels of pictures, which follow those that are copied.
    pub(super) channels: Vec<Arc<ChannelInfo>>,
    /// Packings without a picture, and why.
    pub(super) notes: Vec<String>,
}

impl Pictures {
    pub(super) fn of(copied: &Channels<'_>) -> Result<Self, Failure> {
        let mut all = Self::default();
        for (place, channel) in copied.list.iter().enumerate() {
            if channel.ros_type != msg::Packing::TYPE || channel.message_encoding != "cdr" {
                continue;
            }
            all.places.insert(place, copied.list.len() + all.channels.len());
            for picture in Picture::ALL {
                let topic = picture.beside(&channel.topic);
                if copied.list.iter().any(|c| c.topic == topic) {
                    return Err(Failure::usage(format!(
                        "there is a topic {topic} already: leave it out with --exclude {topic}"
                    )));
                }
                all.channels.push(Arc::new(described(picture.topic(), &topic)));
            }
        }
        if all.places.is_empty() {
            let none = "there is no topic of type grainlab_msgs/msg/Packing of which pictures could be made";
            return Err(Failure::usage(none));
        }
        Ok(all)
    }

    /// Place and bytes of each picture of a message; none without a packing, or for an invalid one, which is noted.
    pub(super) fn made(&mut self, place: usize, message: &Message) -> Vec<(usize, Vec<u8>)> {
        let Some(first) = self.places.get(&place) else { return Vec::new() };
        match message.own_bytes().and_then(|bytes| packing(&bytes)) {
            Ok(packing) => {
                let drawn = Drawn::new(&packing);
                Picture::ALL.iter().enumerate().map(|(n, p)| (first + n, p.encoded(&drawn))).collect()
            }
            Err(error) => {
                let sequence = message.sequence;
                self.notes
                    .push(format!("no picture of the packing with sequence number {sequence}: {error}"));
                Vec::new()
            }
        }
    }
}

fn described(picture: &Topic, topic: &str) -> ChannelInfo {
    let spec = TopicSpec::of_contract(picture, topic);
    let metadata = BTreeMap::from([
        ("offered_qos_profiles".to_owned(), spec.qos.clone()),
        ("topic_type_hash".to_owned(), spec.type_hash.clone()),
    ]);
    ChannelInfo {
        stored: StoredDefinition::Same,
        topic: spec.name,
        ros_type: spec.ros_type,
        schema: spec.definition.clone().into_bytes(),
        definition: spec.definition,
        schema_encoding: spec.schema_encoding,
        message_encoding: "cdr".to_owned(),
        qos: spec.qos,
        type_hash: spec.type_hash,
        metadata,
    }
}
