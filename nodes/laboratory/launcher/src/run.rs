//! The run of a launcher.

use grainlab_node_kit::RunId;

/// The run that a launcher starts.
#[derive(Clone, Copy, Debug)]
pub struct Run {
    /// Id of the run.
    pub id: RunId,
    /// DDS domain of the run.
    pub domain: u16,
}
