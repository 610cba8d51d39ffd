//! Names of the nodes that the launcher treats specially.

/// The recorder: the run ends when it ends.
pub(super) const RECORDER: &str = "recorder";

/// The simulator: it is restarted from its last packing.
pub(super) const SIMULATOR: &str = "dem_simulator";

/// The acoustic probe.
pub(super) const PROBE: &str = "acoustic_probe";

/// The inversion.
pub(super) const INVERSION: &str = "emt_inversion";

/// Name for all third-party programs of a launch file.
pub(super) const INSTRUMENT: &str = "instrument";
