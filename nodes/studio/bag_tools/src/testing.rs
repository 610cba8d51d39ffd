//! Recordings for tests.

use grainlab_recordings::Recording;
use mcap::records::MessageHeader;

/// A recording of messages, one each nanosecond: topic, encoding, name and definition of the type, which may be empty, and payload.
pub(crate) fn recording<'a>(
    messages: impl IntoIterator<Item = (String, &'a str, [&'a str; 2], Vec<u8>)>,
) -> Recording {
    let file = tempfile::NamedTempFile::new().unwrap();
    let mut writer = mcap::Writer::new(std::io::BufWriter::new(file.reopen().unwrap())).unwrap();
    for (log_time, (topic, encoding, [name, definition], payload)) in (0..).zip(messages) {
        let schema = match definition {
            "" => 0,
            _ => writer.add_schema(name, "ros2msg", definition.as_bytes()).unwrap(),
        };
        let channel_id = writer.add_channel(schema, &topic, encoding, &Default::default()).unwrap();
        let header = MessageHeader { channel_id, sequence: 0, log_time, publish_time: 1 };
        writer.write_to_known_channel(&header, &payload).unwrap();
    }
    writer.finish().unwrap();
    Recording::open(file.path()).unwrap()
}
