//! Compression of chunks.

use clap::ValueEnum;

/// Compression of the chunks.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum Compression {
    /// Chunks without compression
    None,
    /// Compression by LZ4
    Lz4,
    /// Compression by Zstandard
    #[default]
    Zstd,
}

impl Compression {
    pub(crate) fn of_chunks(self) -> Option<mcap::Compression> {
        match self {
            Self::None => None,
            Self::Lz4 => Some(mcap::Compression::Lz4),
            Self::Zstd => Some(mcap::Compression::Zstd),
        }
    }
}
