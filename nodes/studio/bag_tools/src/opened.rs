//! Recordings that a command reads.

use grainlab_console::{Failure, say};
use grainlab_msgs::Exit;
use grainlab_recordings::Recording;
use std::path::PathBuf;

/// Opens the recordings.
pub(crate) fn open(paths: &[PathBuf]) -> Result<Vec<Recording>, Failure> {
    paths.iter().map(|path| Recording::open(path).map_err(Failure::failed)).collect()
}

/// Prints what could not be read; exit 3 if there is anything.
pub(crate) fn losses(recordings: &[Recording]) -> Exit {
    let mut exit = Exit::Done;
    for warning in recordings.iter().flat_map(Recording::warnings) {
        say!("grainlab: {warning}");
        exit = Exit::DataLoss;
    }
    exit
}
