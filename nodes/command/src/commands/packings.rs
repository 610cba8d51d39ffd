//! Packings from files through a measurement to a printed result: the common part of `analyze` and `probe`.
//!
//! - [`import`]: flags for data that files lack
//! - [`files`]: many files at once
//! - [`sink`]: results in order; [`outlet`]: to stdout and into a recording

pub(crate) mod bar;
pub(crate) mod files;
pub(crate) mod import;
pub(crate) mod outlet;
pub(crate) mod sink;

use crate::tape::Tape;
use bar::Bar;
use grainlab_console::Failure;
use grainlab_node_kit::Exit;
use grainlab_recordings::import::Imported;
use grainlab_results::Printed;

/// The measurement of one packing.
pub(crate) trait Measure: Sync {
    /// Its result.
    type Found: Found;

    /// Measures one packing of `source`; the error names both.
    fn measure(&self, source: &str, imported: &Imported) -> Result<Self::Found, String>;
}

/// The result of one packing.
pub(crate) trait Found: Send {
    /// The printed part.
    type Shown: Printed;

    /// The printed part.
    fn shown(&self) -> &Self::Shown;

    /// Whether the packing lacks what was sought.
    fn is_without(&self) -> bool;

    /// Writes the messages into a recording.
    fn record(&self, tape: &mut Tape, bar: &Bar) -> Result<Exit, Failure>;
}
