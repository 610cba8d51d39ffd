//! Content of a chunk: decompressed, and checked against its size and checksum before anything of it is used.

use std::io::Read;

use mcap::records::{ChunkHeader, Record};

use super::records::RawRecord;

/// Chunks that claim more uncompressed bytes than this are taken for damaged: a wrong length must not exhaust
/// the memory.
const LARGEST: u64 = 1 << 30;

/// The records of a chunk, as bytes to walk over; or what is wrong with the chunk.
pub(super) fn content(record: &RawRecord<'_>) -> Result<Vec<u8>, String> {
    match record.parse()? {
        Record::Chunk { header, data } => decompress(&header, &data),
        other => Err(format!("there is a record of type 0x{:02x} instead of a chunk", other.opcode())),
    }
}

fn decompress(header: &ChunkHeader, data: &[u8]) -> Result<Vec<u8>, String> {
    let size = header.uncompressed_size;
    if size > LARGEST {
        return Err(format!("it claims {size} uncompressed bytes, more than {LARGEST}"));
    }
    let mut content = Vec::with_capacity(size.min(4 << 20) as usize);
    // One byte more than claimed is asked for, so that a longer stream shows.
    let read = match header.compression.as_str() {
        "" => {
            content.extend_from_slice(data);
            Ok(data.len())
        }
        "zstd" => {
            zstd::stream::read::Decoder::new(data).and_then(|d| d.take(size + 1).read_to_end(&mut content))
        }
        "lz4" => lz4::Decoder::new(data).and_then(|d| d.take(size + 1).read_to_end(&mut content)),
        other => return Err(format!("its compression {other:?} is not known (zstd, lz4 and none are)")),
    };
    read.map_err(|e| format!("it does not decompress ({e})"))?;
    if content.len() as u64 != size {
        return Err(format!("it decompresses to {} bytes or more, not to {size}", content.len()));
    }
    // 0 stands for "not computed".
    let crc = crc32fast::hash(&content);
    if header.uncompressed_crc != 0 && crc != header.uncompressed_crc {
        return Err(format!("its checksum is {crc:08x}, not {:08x}", header.uncompressed_crc));
    }
    Ok(content)
}
