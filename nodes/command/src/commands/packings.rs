//! Packings from files through a measurement to a printed result: the common part of `analyze` and `probe`.
//!
//! - [`import`]: flags for data that files lack
//! - [`files`]: flags, and many files at once; [`writer`]: their results, in order

pub(crate) mod files;
pub(crate) mod import;
mod writer;

use crate::offline_recording::Recorded;

pub(crate) struct Found<R> {
    pub(crate) shown: R,
    /// The packing lacks what was sought.
    pub(crate) is_without: bool,
    /// It lacks it by a fault of the packing or of the measurement: exit 4, whatever the other packings are.
    pub(crate) is_fault: bool,
    /// Messages that a node would publish, or the reason why it would not.
    pub(crate) messages: Result<Vec<Recorded>, String>,
}
