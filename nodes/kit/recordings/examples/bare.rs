//! Time that the crate `mcap` needs alone, to be compared with the commands of `grainlab bag`.
//!
//! ```sh
//! cargo run --release -p grainlab_recordings --example bare -- make OUT.mcap 1000 2000 none   # MB, bytes of a message
//! cargo run --release -p grainlab_recordings --example bare -- read IN.mcap
//! cargo run --release -p grainlab_recordings --example bare -- messages IN.mcap               # by this crate, as `bag cat`
//! cargo run --release -p grainlab_recordings --example bare -- write IN.mcap OUT.mcap none    # or lz4, zstd
//! ```

use std::collections::BTreeMap;
use std::error::Error;
use std::fs::File;
use std::io::BufWriter;
use std::time::Instant;

use grainlab_recordings::{Recording, Selection};
use mcap::records::MessageHeader;
use mcap::{Compression, MessageStream, WriteOptions, Writer};

const SCHEMA: &str = "uint32 number\nfloat64[] value\n";

fn main() -> Result<(), Box<dyn Error>> {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let begin = Instant::now();
    let messages = match words.iter().map(String::as_str).collect::<Vec<_>>()[..] {
        ["make", out, megabytes, size, kind] => make(out, megabytes.parse()?, size.parse()?, kind)?,
        ["read", path] => read(path, None)?,
        ["messages", path] => messages(path)?,
        ["write", path, out, kind] => read(path, Some(writer(out, kind)?))?,
        _ => return Err("see the head of this example".into()),
    };
    println!("{messages} messages, {:.3} s", begin.elapsed().as_secs_f64());
    Ok(())
}

fn writer(path: &str, kind: &str) -> Result<Writer<BufWriter<File>>, Box<dyn Error>> {
    let compression = match kind {
        "lz4" => Some(Compression::Lz4),
        "zstd" => Some(Compression::Zstd),
        _ => None,
    };
    let options = WriteOptions::new().profile("ros2").compression(compression);
    let options = options.compression_level(1).compression_threads(0);
    Ok(options.create(BufWriter::with_capacity(1 << 20, File::create(path)?))?)
}

/// Four topics by turns, 1 kHz; numbers as those of a measurement, a third of whose bits are noise.
fn make(path: &str, megabytes: usize, size: usize, kind: &str) -> Result<u64, Box<dyn Error>> {
    let mut mcap = writer(path, kind)?;
    let schema = mcap.add_schema("bench_msgs/msg/Values", "ros2msg", SCHEMA.as_bytes())?;
    let topic = |n: usize| format!("/values_{n}");
    let channels: Vec<u16> = (0..4)
        .map(|n| mcap.add_channel(schema, &topic(n), "cdr", &BTreeMap::new()))
        .collect::<Result<_, _>>()?;
    let count = size.saturating_sub(16) / 8;
    let mut noise = 1u64;
    let mut data = Vec::with_capacity(size);
    let total = (megabytes * 1_000_000 / size) as u64;
    for n in 0..total {
        data.clear();
        data.extend([0, 1, 0, 0]);
        data.extend((n as u32).to_le_bytes());
        data.extend((count as u32).to_le_bytes());
        data.extend([0; 4]);
        for k in 0..count {
            noise = noise.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            let value = (k as f64).mul_add(1e-3, (noise >> 44) as f64 * 1e-9);
            data.extend(value.to_le_bytes());
        }
        let log_time = 1_700_000_000_000_000_000 + n * 1_000_000;
        let header = MessageHeader {
            channel_id: channels[n as usize % 4],
            sequence: n as u32,
            log_time,
            publish_time: log_time,
        };
        mcap.write_to_known_channel(&header, &data)?;
    }
    mcap.finish()?;
    Ok(total)
}

/// The messages in order of log time, every chunk checked.
fn messages(path: &str) -> Result<u64, Box<dyn Error>> {
    let recording = Recording::open(path.as_ref())?;
    let (mut messages, mut sum) = (0, 0);
    for message in recording.messages(&Selection::default())? {
        messages += 1;
        sum += message.payload.len();
    }
    println!("{:.3} MB of payload", sum as f64 * 1e-6);
    Ok(messages)
}

/// Reads all messages, and writes them.
fn read(path: &str, mut to: Option<Writer<BufWriter<File>>>) -> Result<u64, Box<dyn Error>> {
    let file = File::open(path)?;
    // SAFETY: nothing shortens the file meanwhile.
    let map = unsafe { memmap2::Mmap::map(&file) }?;
    let (mut messages, mut sum) = (0, 0);
    for message in MessageStream::new(&map)? {
        let message = message?;
        messages += 1;
        sum += message.data.len();
        if let Some(to) = &mut to {
            to.write(&message)?;
        }
    }
    if let Some(mut to) = to {
        to.finish()?;
    }
    println!("{:.3} MB of payload", sum as f64 * 1e-6);
    Ok(messages)
}
