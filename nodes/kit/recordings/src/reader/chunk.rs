//! Content of a chunk: decompressed, and checked against its size and checksum before it is used.

use std::borrow::Cow;
use std::io::{self, Read};

use mcap::records::{ChunkHeader, Record};

use super::records::RawRecord;

/// Size up to which a chunk is accepted with any compression ratio, bytes.
const ANY_RATIO: u64 = 1 << 30;

/// Maximum compression ratio of a larger chunk.
const RATIO: u64 = 64;

/// Size for which memory is reserved because a frame states it, bytes.
const ONCE: u64 = 4 << 20;

/// Logarithm of the largest window of zstd for which memory is allocated: [`ANY_RATIO`].
const WINDOW: u32 = ANY_RATIO.ilog2();

/// Largest size that `compressed` bytes may decompress to: a few could give any size, and a chunk is in memory as a whole.
fn limit(compressed: usize) -> u64 {
    (compressed as u64).saturating_mul(RATIO).max(ANY_RATIO)
}

/// The records of a chunk, as bytes to iterate over, those of the file if they are not compressed; or the error of the chunk.
pub(super) fn content<'a>(record: &RawRecord<'a>) -> Result<Cow<'a, [u8]>, String> {
    content_in(record, Vec::new())
}

/// Content as [`content`] gives it; the memory of `spare` is used if it is compressed.
pub(super) fn content_in<'a>(record: &RawRecord<'a>, spare: Vec<u8>) -> Result<Cow<'a, [u8]>, String> {
    match record.parse()? {
        Record::Chunk { header, data } => decompress(&header, data, spare),
        other => Err(format!("there is a record of type 0x{:02x} instead of a chunk", other.opcode())),
    }
}

fn decompress<'a>(
    header: &ChunkHeader,
    data: Cow<'a, [u8]>,
    spare: Vec<u8>,
) -> Result<Cow<'a, [u8]>, String> {
    let size = header.uncompressed_size;
    if header.compression.is_empty() {
        return checked(header, data);
    }
    let most = limit(data.len());
    if size > most {
        return Err(format!(
            "it states that its {} bytes decompress to {size}, and at most {most} are accepted: 1 GiB, or 64 times the \
             compressed size if that is more",
            data.len()
        ));
    }
    let data = &*data;
    let mut content = spare;
    content.clear();
    content.reserve_exact(size.min(ONCE) as usize);
    let read = match header.compression.as_str() {
        // In one call, without a window: twice as fast.
        "zstd" if size <= ONCE => {
            zstd::bulk::Decompressor::new().and_then(|mut d| d.decompress_to_buffer(data, &mut content))
        }
        "zstd" => unpack(data, size, &mut content),
        "lz4" => unpack_lz4(data, size, &mut content),
        other => return Err(format!("its compression {other:?} is not known (zstd, lz4 and none are)")),
    };
    read.map_err(|e| format!("it does not decompress ({e})"))?;
    checked(header, Cow::Owned(content))
}

/// Decompresses all frames of LZ4, as the decoder of Zstandard does. One byte more than `size` is read, to detect a longer stream.
fn unpack_lz4(mut data: &[u8], size: u64, content: &mut Vec<u8>) -> io::Result<usize> {
    while !data.is_empty() && content.len() as u64 <= size {
        let room = size + 1 - content.len() as u64;
        lz4::Decoder::new(&mut data)?.take(room).read_to_end(content)?;
    }
    Ok(content.len())
}

/// One byte more than `size` is read, to detect a longer stream.
fn unpack(data: &[u8], size: u64, content: &mut Vec<u8>) -> io::Result<usize> {
    let mut decoder = zstd::stream::read::Decoder::new(data)?;
    decoder.window_log_max(WINDOW)?;
    decoder.take(size + 1).read_to_end(content)
}

/// A message that is compressed by itself, by Zstandard.
pub(super) fn message(data: &[u8]) -> Result<Vec<u8>, String> {
    let (most, mut content) = (limit(data.len()), Vec::new());
    match unpack(data, most, &mut content) {
        Ok(size) if size as u64 > most => Err(format!("a message decompresses to more than {most} bytes")),
        Ok(_) => Ok(content),
        Err(e) => Err(format!("a message does not decompress ({e})")),
    }
}

/// The content, if it has the size and the checksum of the header.
fn checked<'a>(header: &ChunkHeader, content: Cow<'a, [u8]>) -> Result<Cow<'a, [u8]>, String> {
    let size = header.uncompressed_size;
    if content.len() as u64 != size {
        let found = content.len();
        let more = if found as u64 > size { " or more" } else { "" };
        return Err(format!("it decompresses to {found} bytes{more}, not to {size}"));
    }
    // 0 means "not computed".
    let crc = crc32fast::hash(&content);
    if header.uncompressed_crc != 0 && crc != header.uncompressed_crc {
        return Err(format!("its checksum is {crc:08x}, not {:08x}", header.uncompressed_crc));
    }
    Ok(content)
}
