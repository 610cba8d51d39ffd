//! Form of the result of a launch.

use grainlab_console::Format;

/// Form of the result.
#[derive(Clone, Copy, Debug)]
pub(super) struct Output {
    pub(super) format: Format,
    /// Print everything before the summary.
    pub(super) verbose: bool,
    /// The run is continued: its times are those of the last part.
    pub(super) resumed: bool,
    /// Write the page of the run.
    #[cfg_attr(not(feature = "studio"), expect(dead_code, reason = "the studio writes pages"))]
    pub(super) report: bool,
}
