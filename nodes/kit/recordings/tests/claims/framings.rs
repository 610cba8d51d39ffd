//! Every legal framing of the same content is read, checked and copied without loss, and none is called faulty: a slice of the
//! matrix of MCAP's conformance suite.

use crate::by_hand::{HI, channel, compressed_chunk, file, message, schema};
use crate::support::{Said, Writer, attach, checked, file_with, of_bytes, open, post, remark, said, strings};
use grainlab_recordings::copy::{CopyOptions, copy};
use grainlab_recordings::{Recording, StoredFile};
use mcap::WriteOptions;
use std::io::Write;

/// All that a file holds: messages, stored files, names of metadata records; name, type and number of messages of each topic.
type Content = (Vec<Said>, Vec<StoredFile>, Vec<String>, Vec<String>);

fn content(recording: &Recording) -> Content {
    let topics = recording.info().topics.into_iter();
    let topics = topics.map(|t| format!("{} {} {}", t.name, t.ros_type, t.messages));
    let metadata = recording.metadata_names().into_iter().filter(|name| name != "grainlab_copy");
    (said(recording), recording.stored_files(), metadata.collect(), topics.collect())
}

/// Two topics with messages in two chunks, one of them without a schema; a topic without messages; stored files and metadata
/// records, two of each with one name.
fn write(options: WriteOptions) -> Vec<u8> {
    file_with(options, |writer| {
        let raw = |writer: &mut Writer| writer.add_channel(0, "/raw", "cdr", &Default::default()).unwrap();
        let [a, raw, _] = [strings(writer, "/a"), raw(writer), strings(writer, "/silent")];
        for log_time in 0..6 {
            post(writer, if log_time % 3 == 2 { raw } else { a }, log_time, HI);
            if log_time == 0 || log_time == 3 {
                writer.flush().unwrap();
            }
        }
        for (time, data) in [b"1", b"2"].into_iter().enumerate() {
            attach(writer, "f", [time as u64, 0], data);
            remark(writer, "m", "n", &time.to_string());
        }
    })
}

#[test]
fn whatever_parts_of_the_index_a_file_has_all_content_is_read_and_copied_and_no_fault_is_found() {
    let root = tempfile::tempdir().unwrap();
    let expected = content(&of_bytes(&write(WriteOptions::new())));
    assert_eq!((expected.0.len(), expected.1.len(), expected.3.len()), (6, 2, 3));
    for choice in 0..1u32 << 9 {
        let has = |bit: u32| choice >> bit & 1 == 1;
        let options = WriteOptions::new()
            .use_chunks(has(0))
            .emit_statistics(has(1))
            .emit_message_indexes(has(2))
            .emit_chunk_indexes(has(3))
            .emit_attachment_indexes(has(4))
            .emit_metadata_indexes(has(5))
            .repeat_channels(has(6))
            .repeat_schemas(has(7))
            .emit_summary_offsets(has(8));
        let text = format!("{options:?}");
        let recording = of_bytes(&write(options));
        assert_eq!(content(&recording), expected, "{text}");
        assert_eq!(recording.check().warnings, [], "{text}");
        if choice % 7 == 0 {
            let to = root.path().join(format!("{choice}.mcap"));
            let copied = copy(&[recording], &to, &CopyOptions::default()).unwrap();
            let made = open(&to);
            assert_eq!(
                (content(&made), made.check().warnings, copied.notes),
                (expected.clone(), vec![], vec![])
            );
        }
    }
}

/// LZ4 and Zstandard allow several frames, one after the other, and MCAP's reader for Rust reads them.
#[test]
fn a_chunk_of_several_compressed_frames_is_read_to_its_end() {
    let lz4 = |bytes: &[u8]| {
        let mut encoder = lz4::EncoderBuilder::new().build(Vec::new()).unwrap();
        encoder.write_all(bytes).unwrap();
        encoder.finish().0
    };
    let zstd = |bytes: &[u8]| zstd::bulk::compress(bytes, 1).unwrap();
    let start = [schema(1, "std_msgs/msg/String"), channel(1, 1, "/a"), message(1, 5)].concat();
    // The second one is large enough to be decompressed in parts.
    let rest = [message(1, 6), (0..200_000).flat_map(|_| message(1, 7)).collect()];
    for rest in rest {
        let size = start.len() + rest.len();
        for (name, frames) in [("lz4", [lz4(&start), lz4(&rest)]), ("zstd", [zstd(&start), zstd(&rest)])] {
            let times = [5, if rest.len() < 100 { 6 } else { 7 }];
            let read = |content: &[u8]| {
                let recording = of_bytes(&file(&[compressed_chunk(times, name, size, content)]));
                (said(&recording).len(), checked(&recording))
            };
            let expected = 1 + rest.len() / message(1, 6).len();
            assert_eq!(read(&frames.concat()), (expected, String::new()), "{name}");
            let (messages, text) = read(&frames[0]);
            let found = format!("it decompresses to {} bytes, not to {size}", start.len());
            assert!(messages == 0 && text.contains(&found), "{name}: {text}");
        }
    }
}
