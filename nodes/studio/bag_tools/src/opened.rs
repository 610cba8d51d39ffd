//! Recordings that a command reads.

use grainlab_console::say;
use grainlab_msgs::Exit;
use grainlab_recordings::Recording;

/// Prints what could not be read; exit 3 if there is anything.
pub(crate) fn losses(recordings: &[Recording]) -> Exit {
    let mut exit = Exit::Done;
    for warning in recordings.iter().flat_map(Recording::warnings) {
        say!("grainlab: {warning}");
        exit = Exit::DataLoss;
    }
    exit
}
