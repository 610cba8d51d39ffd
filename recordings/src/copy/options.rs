//! Selection of messages to copy, and options of the output.

use clap::ValueEnum;
use grainlab_console::Failure;

use crate::compression::Compression;
use crate::reader::ChannelInfo;

/// Options of the output.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct CopyOptions {
    /// Compression of the chunks.
    pub compression: Compression,
    /// Level of the compression; 0 is the default of its library.
    pub level: u32,
    /// Uncompressed bytes after which a chunk is closed; `None` writes messages outside chunks, without an index.
    pub chunk_size: Option<u64>,
    /// Checksums of chunks and of the data.
    pub checksums: bool,
    /// Operation that makes the copy, for its metadata: `cut`, `merge`.
    pub operation: String,
    /// Add to each topic with packings topics with pictures of them.
    pub pictures: bool,
}

/// The presets of rosbag2.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
#[value(rename_all = "snake_case")]
pub enum Preset {
    /// No chunks, no index and no checksums
    #[value(name = "fastwrite")]
    FastWrite,
    /// Zstandard at level 1, without checksums
    ZstdFast,
    /// Zstandard at level 19, chunks of 4 MiB
    ZstdSmall,
}

impl Default for CopyOptions {
    fn default() -> Self {
        let operation = "copy".to_owned();
        Self {
            compression: Compression::Zstd,
            level: 1,
            chunk_size: Some(1 << 20),
            checksums: true,
            operation,
            pictures: false,
        }
    }
}

impl CopyOptions {
    /// The options of a preset.
    pub fn of_preset(preset: Preset) -> Self {
        match preset {
            Preset::FastWrite => Self {
                compression: Compression::None,
                level: 0,
                chunk_size: None,
                checksums: false,
                ..Self::default()
            },
            Preset::ZstdFast => Self { checksums: false, ..Self::default() },
            Preset::ZstdSmall => Self { level: 19, chunk_size: Some(4 << 20), ..Self::default() },
        }
    }

    pub(super) fn writer(&self, profile: &str) -> mcap::WriteOptions {
        mcap::WriteOptions::new()
            .profile(profile)
            .library(format!("grainlab {}, copy", env!("CARGO_PKG_VERSION")))
            .compression(self.compression.of_chunks())
            .compression_level(self.level)
            .compression_threads(0)
            .use_chunks(self.chunk_size.is_some())
            .chunk_size(self.chunk_size)
            .calculate_chunk_crcs(self.checksums)
            .calculate_data_section_crc(self.checksums)
    }
}

/// The messages to copy.
pub struct Select<'a> {
    /// Test of a topic: true if it is wanted.
    pub topic: &'a dyn Fn(&ChannelInfo) -> bool,
    /// First log time, ns since 1970.
    pub start: Option<u64>,
    /// Log time before which to end, ns since 1970.
    pub end: Option<u64>,
    /// Copy latched messages from before the start.
    pub latched: bool,
    /// Called with the log time of each message of the interval; an error ends the copy.
    pub progress: &'a dyn Fn(u64) -> Result<(), Failure>,
}

impl Default for Select<'_> {
    fn default() -> Self {
        Self { topic: &|_| true, start: None, end: None, latched: true, progress: &|_| Ok(()) }
    }
}
