//! Packings from files through a measurement to a printed result: the common part of `analyze` and `probe`.
//!
//! - [`import`]: flags for data that files lack
//! - [`files`]: many files at once
//! - [`sink`]: results in order

pub(crate) mod bar;
pub(crate) mod files;
pub(crate) mod import;
pub(crate) mod sink;

use bar::Bar;
use grainlab_console::Failure;
use grainlab_node_kit::Exit;
use grainlab_recordings::import::Imported;

/// The measurement of one packing.
pub(crate) trait Measure: Sync {
    /// Its result.
    type Found: Send;

    /// Measures one packing of `source`; the error names both.
    fn measure(&self, source: &str, imported: &Imported) -> Result<Self::Found, String>;
}

/// The destination of results.
pub(crate) trait Outlet: Send {
    /// The result of one packing.
    type Found: Send;

    /// Takes the next result. `bar` is hidden while lines are printed.
    fn emit(&mut self, found: Self::Found, bar: &Bar) -> Result<Exit, Failure>;

    /// Completes the output after the last result.
    fn finish(self) -> Result<Exit, Failure>;
}
