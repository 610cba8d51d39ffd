//! How a launch prints its result.

use grainlab_console::Format;

/// How to print the result.
#[derive(Clone, Copy, Debug)]
pub(super) struct Output {
    pub(super) format: Format,
    /// Print everything, beside the summary.
    pub(super) verbose: bool,
    /// The run is continued: its times are those of the last part.
    pub(super) resumed: bool,
}
