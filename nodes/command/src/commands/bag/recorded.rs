//! Arguments of the commands that describe a recording.

use grainlab_console::Format;
use grainlab_recordings::MessagePath;
use std::path::PathBuf;

/// A recording, and the format of what is said of it.
#[derive(Debug, clap::Args)]
pub(crate) struct Recorded {
    /// Run directory or MCAP file
    #[arg(value_name = "PATH")]
    pub(super) path: PathBuf,
    #[command(flatten)]
    pub(super) messages: MessagePath,
    /// Format of the result
    #[arg(long, value_enum, default_value_t)]
    pub(super) format: Format,
}
