//! Schemas and channels as a file declares them, by their ids.
//!
//! MCAP demands that all records with one id are identical. If two differ, the first is used: which of them a message was
//! written for is not recorded.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use mcap::records::{Channel, Record, SchemaHeader};

use super::channel::ChannelInfo;
use super::definition::StoredDefinition;

/// The first declaration of each schema and channel.
#[derive(Clone, Debug, Default)]
pub(super) struct Declarations {
    schemas: BTreeMap<u16, (SchemaHeader, Vec<u8>)>,
    channels: BTreeMap<u16, Channel>,
}

impl Declarations {
    /// Adds a schema or a channel whose id is new; an error is its difference from the record that has the same id.
    /// Ignores other records, and a schema with id 0, as MCAP demands of readers.
    pub(super) fn add(&mut self, record: Record<'_>) -> Result<(), String> {
        if let Some(difference) = self.difference(&record) {
            return Err(difference);
        }
        match record {
            Record::Schema { header, data } if header.id != 0 => {
                self.schemas.entry(header.id).or_insert_with(|| (header, data.into_owned()));
            }
            Record::Channel(channel) => {
                self.channels.entry(channel.id).or_insert(channel);
            }
            _ => {}
        }
        Ok(())
    }

    /// Returns the difference of a schema or a channel from the one with the same id.
    pub(super) fn difference(&self, record: &Record<'_>) -> Option<String> {
        match record {
            Record::Schema { header, data } => {
                let (first, bytes) = self.schemas.get(&header.id)?;
                let differs = first != header || **bytes != **data;
                differs.then(|| twice("schema", header.id, &first.name, &header.name))
            }
            Record::Channel(channel) => {
                let first = self.channels.get(&channel.id)?;
                let differs = first != channel;
                differs.then(|| twice("channel", channel.id, &first.topic, &channel.topic))
            }
            _ => None,
        }
    }

    /// Returns true if the schema is declared, and for the id 0, which stands for no schema.
    pub(super) fn has_schema(&self, id: u16) -> bool {
        id == 0 || self.schemas.contains_key(&id)
    }

    pub(super) fn schemas(&self) -> usize {
        self.schemas.len()
    }

    /// Returns name, encoding and content of each schema that no channel uses.
    pub(super) fn unused_schemas(&self) -> impl Iterator<Item = (&str, &str, &[u8])> {
        let used: BTreeSet<u16> = self.channels.values().map(|channel| channel.schema_id).collect();
        let unused = self.schemas.values().filter(move |(header, _)| !used.contains(&header.id));
        unused.map(|(header, data)| (&*header.name, &*header.encoding, &data[..]))
    }

    pub(super) fn has_channel(&self, id: u16) -> bool {
        self.channels.contains_key(&id)
    }

    /// Returns the channels with their schemas, and for each channel whose schema is missing a line that says so.
    pub(super) fn channels(&self) -> (BTreeMap<u16, Arc<ChannelInfo>>, BTreeMap<u16, String>) {
        let (mut found, mut without) = (BTreeMap::new(), BTreeMap::new());
        for (id, channel) in &self.channels {
            match self.schema(channel) {
                Some(schema) => _ = found.insert(*id, Arc::new(info(channel, schema))),
                None => {
                    let Channel { topic, schema_id, .. } = channel;
                    let line = format!("channel {topic} names schema {schema_id}, which is missing");
                    without.insert(*id, line);
                }
            }
        }
        (found, without)
    }

    /// Returns name, encoding and content of the schema of a channel; they are empty for a channel without a schema.
    fn schema(&self, channel: &Channel) -> Option<(&str, &str, &[u8])> {
        if channel.schema_id == 0 {
            return Some(("", "", &[]));
        }
        let (header, data) = self.schemas.get(&channel.schema_id)?;
        Some((&header.name, &header.encoding, data))
    }
}

fn twice(what: &str, id: u16, first: &str, other: &str) -> String {
    let names = if first == other {
        format!("both times as {first:?} but with different content")
    } else {
        format!("as {first:?} and as {other:?}")
    };
    format!("{what} {id} is declared twice, {names}, which MCAP forbids; the first declaration is used")
}

fn info(channel: &Channel, (ros_type, schema_encoding, schema): (&str, &str, &[u8])) -> ChannelInfo {
    let value = |key: &str| channel.metadata.get(key).cloned().unwrap_or_default();
    let (definition, type_hash) = (String::from_utf8_lossy(schema).into_owned(), value("topic_type_hash"));
    ChannelInfo {
        topic: channel.topic.clone(),
        stored: StoredDefinition::of(ros_type, schema_encoding, &definition, &type_hash),
        ros_type: ros_type.to_owned(),
        definition,
        schema: schema.to_owned(),
        schema_encoding: schema_encoding.to_owned(),
        message_encoding: channel.message_encoding.clone(),
        qos: value("offered_qos_profiles"),
        type_hash,
        metadata: channel.metadata.clone(),
    }
}
