//! Maps of texts: the metadata of a channel, and a metadata record.
//!
//! MCAP leaves open which value counts if a map has a key twice. The last one counts here, as in the readers for Python and Go.

use std::collections::BTreeMap;

use mcap::records::Record;

use super::lengths::{short, texts};

/// A record whose map has a key twice.
pub(super) struct Repeated {
    opcode: u8,
    /// The record with the last value of each key.
    pub(super) body: Vec<u8>,
    key: String,
}

/// Returns the record with the last value of each key if its map of texts has a key twice; else `None`.
pub(super) fn repeated(opcode: u8, body: &[u8]) -> Option<Repeated> {
    let [before, mut pairs, after] = texts(opcode, body)?;
    let (mut values, mut repeated) = (BTreeMap::new(), None);
    while !pairs.is_empty() {
        let (key, value) = (short(&mut pairs)?, short(&mut pairs)?);
        if values.insert(key, value).is_some() {
            repeated.get_or_insert(key);
        }
    }
    let key = String::from_utf8_lossy(repeated?).into_owned();
    let texts = values.into_iter().flat_map(|(key, value)| [key, value]);
    let pairs: Vec<u8> = texts.flat_map(|text| [&length(text)[..], text].concat()).collect();
    Some(Repeated { opcode, body: [before, &length(&pairs), &pairs, after].concat(), key })
}

/// Parses a record that has a map of texts.
pub(super) fn parse(opcode: u8, body: &[u8]) -> Option<Record<'static>> {
    match mcap::parse_record(opcode, body).ok()? {
        Record::Channel(channel) => Some(Record::Channel(channel)),
        Record::Metadata(metadata) => Some(Record::Metadata(metadata)),
        _ => None,
    }
}

impl Repeated {
    pub(super) fn fault(&self) -> String {
        let name = match parse(self.opcode, &self.body) {
            Some(Record::Channel(channel)) => format!("the metadata of channel {:?}", channel.topic),
            Some(Record::Metadata(metadata)) => format!("the metadata record {:?}", metadata.name),
            _ => format!("a record of type 0x{:02x}", self.opcode),
        };
        format!(
            "{name} has the key {:?} twice, and MCAP does not define which value counts; the last one is used",
            self.key
        )
    }
}

/// Returns the length of a text as MCAP writes it. The texts are parts of a record, which are shorter than its lengths allow.
fn length(text: &[u8]) -> [u8; 4] {
    (text.len() as u32).to_le_bytes()
}

#[cfg(test)]
mod tests {
    use super::*;
    use mcap::records::op;

    fn text(text: &str) -> Vec<u8> {
        [&length(text.as_bytes())[..], text.as_bytes()].concat()
    }

    /// A metadata record with these pairs, and bytes of a later version behind them.
    fn record(pairs: &[(&str, &str)]) -> Vec<u8> {
        let pairs: Vec<u8> =
            pairs.iter().flat_map(|(key, value)| [text(key), text(value)].concat()).collect();
        [text("vehicle"), length(&pairs).to_vec(), pairs, vec![1, 2, 3]].concat()
    }

    #[test]
    fn the_last_value_of_a_key_counts_and_a_map_without_repetition_is_left_alone() {
        let found = repeated(op::METADATA, &record(&[("a", "1"), ("b", "2"), ("a", "3")])).unwrap();
        let Some(Record::Metadata(read)) = parse(op::METADATA, &found.body) else { panic!("no metadata") };
        assert_eq!(read.metadata, [("a", "3"), ("b", "2")].map(|(k, v)| (k.to_owned(), v.to_owned())).into());
        assert!(found.body.ends_with(&[1, 2, 3]));
        assert!(found.fault().starts_with("the metadata record \"vehicle\" has the key \"a\" twice"));
        assert!(repeated(op::METADATA, &record(&[("a", "1"), ("b", "1")])).is_none());
        assert!(repeated(op::MESSAGE, &record(&[("a", "1"), ("a", "1")])).is_none());
    }
}
