//! Compression on the command line.

use clap::ValueEnum;
use grainlab_recordings as recordings;

/// Compression of the chunks.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Compression {
    /// Not compressed
    None,
    /// LZ4
    Lz4,
    /// Zstandard
    Zstd,
}

impl From<Compression> for recordings::Compression {
    fn from(kind: Compression) -> Self {
        match kind {
            Compression::None => Self::None,
            Compression::Lz4 => Self::Lz4,
            Compression::Zstd => Self::Zstd,
        }
    }
}
