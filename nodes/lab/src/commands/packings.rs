//! Packings from files through a measurement to a printed result: what `analyze` and `probe` share.
//!
//! - [`import`]: what the files do not say
//! - [`files`]: many files at once
//! - [`sink`]: results in order
//! - [`printer`]: results, one after the other, as one table, one JSON array or one CSV

pub(crate) mod bar;
pub(crate) mod files;
pub(crate) mod import;
pub(crate) mod printer;
pub(crate) mod sink;

use bar::Bar;
use grainlab_console::Failure;
use grainlab_node_kit::Exit;
use grainlab_recordings::import::Imported;

/// What is done with one packing.
pub(crate) trait Measure: Sync {
    /// What is found of it.
    type Found: Send;

    /// Measures one packing of `source`; the error names both.
    fn measure(&self, source: &str, imported: &Imported) -> Result<Self::Found, String>;
}

/// Where results go.
pub(crate) trait Outlet: Send {
    /// What is found of one packing.
    type Found: Send;

    /// Takes the next one. Lines on stderr make way for `bar`.
    fn emit(&mut self, found: Self::Found, bar: &Bar) -> Result<Exit, Failure>;

    /// Completes the output after the last one.
    fn finish(self) -> Result<Exit, Failure>;
}
