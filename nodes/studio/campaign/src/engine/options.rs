//! Options of a campaign.

/// Options of a campaign.
#[derive(Clone, Copy, Debug)]
pub struct Options {
    /// Members at a time on this machine; `None`: one more than there are cores, since each waits at its start and end.
    pub jobs: Option<usize>,
    /// Number of times that an interrupted member is tried again; the last time anew.
    pub retries: usize,
    /// Run members again that failed.
    pub redo_failed: bool,
}
