//! MCAP files record by record, also those that no library writes.

use mcap::records::op;

pub(crate) const HI: &[u8] = b"\0\x01\0\0\x03\0\0\0hi\0";

fn text(text: &str) -> Vec<u8> {
    [&(text.len() as u32).to_le_bytes()[..], text.as_bytes()].concat()
}

pub(crate) fn record(opcode: u8, body: &[u8]) -> Vec<u8> {
    [&[opcode][..], &(body.len() as u64).to_le_bytes(), body].concat()
}

pub(crate) fn schema(id: u16, name: &str) -> Vec<u8> {
    let body = [&id.to_le_bytes()[..], &text(name), &text("ros2msg"), &text("string data\n")].concat();
    record(op::SCHEMA, &body)
}

/// A map of texts.
fn map(pairs: &[[&str; 2]]) -> Vec<u8> {
    let pairs: Vec<u8> = pairs.iter().flatten().flat_map(|t| text(t)).collect();
    [&(pairs.len() as u32).to_le_bytes()[..], &pairs].concat()
}

pub(crate) fn channel(id: u16, schema: u16, topic: &str) -> Vec<u8> {
    channel_with(id, schema, topic, &[])
}

/// A channel with this metadata.
pub(crate) fn channel_with(id: u16, schema: u16, topic: &str, metadata: &[[&str; 2]]) -> Vec<u8> {
    let ids = [id.to_le_bytes(), schema.to_le_bytes()].concat();
    record(op::CHANNEL, &[&ids[..], &text(topic), &text("cdr"), &map(metadata)].concat())
}

pub(crate) fn message(channel: u16, time: u64) -> Vec<u8> {
    let header = [&channel.to_le_bytes()[..], &[0; 4], &time.to_le_bytes(), &time.to_le_bytes()].concat();
    record(op::MESSAGE, &[&header, HI].concat())
}

pub(crate) fn metadata(name: &str, pairs: &[[&str; 2]]) -> Vec<u8> {
    record(op::METADATA, &[text(name), map(pairs)].concat())
}

/// A chunk of records, not compressed, with these log times of its first and last message.
pub(crate) fn chunk(times: [u64; 2], records: &[Vec<u8>]) -> Vec<u8> {
    let content = records.concat();
    compressed_chunk(times, "", content.len(), &content)
}

/// A chunk with this compressed content, which has `size` bytes.
pub(crate) fn compressed_chunk(times: [u64; 2], compression: &str, size: usize, content: &[u8]) -> Vec<u8> {
    let [size, length] = [size, content.len()].map(|bytes| (bytes as u64).to_le_bytes());
    let times = times.map(u64::to_le_bytes).concat();
    record(op::CHUNK, &[&times[..], &size, &[0; 4], &text(compression), &length, content].concat())
}

/// A complete file with these records and no summary.
pub(crate) fn file(records: &[Vec<u8>]) -> Vec<u8> {
    let header = record(op::HEADER, &[text("ros2"), text("by hand")].concat());
    let end = [record(op::DATA_END, &[0; 4]), record(op::FOOTER, &[0; 20])].concat();
    [mcap::MAGIC, &header, &records.concat(), &end, mcap::MAGIC].concat()
}
