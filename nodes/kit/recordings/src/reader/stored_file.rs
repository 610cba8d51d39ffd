//! The MCAP files of a recording, and their attachments.

/// Name, time range and number of messages of one MCAP file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct FileCount {
    pub(crate) name: String,
    /// First and last log time, ns since 1970; `None` without messages.
    pub(crate) bounds: Option<(u64, u64)>,
    pub(crate) messages: u64,
}

/// An attachment: a file stored in a recording.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct StoredFile {
    /// Name within the recording.
    pub name: String,
    /// Media type, as in `application/toml`.
    pub media_type: String,
    /// Time at which it was stored, ns since 1970.
    pub time: u64,
    /// Time at which it was made, ns since 1970.
    pub created: u64,
    /// Content of the file.
    pub bytes: Vec<u8>,
}
