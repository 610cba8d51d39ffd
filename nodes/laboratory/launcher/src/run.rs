//! The run of a launcher.

use grainlab_node_kit::RunId;

/// The run that a launcher starts.
#[derive(Clone, Copy, Debug)]
pub struct Run {
    /// Its id.
    pub id: RunId,
    /// DDS domain.
    pub domain: u16,
}
