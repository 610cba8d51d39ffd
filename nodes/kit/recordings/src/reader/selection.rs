//! Selection of messages.

/// Selects messages by topic and log time.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Selection {
    /// Names of topics, with or without the leading slash; `None` for all.
    pub topics: Option<Vec<String>>,
    /// First log time, ns since 1970.
    pub start: Option<u64>,
    /// Log time before which to end, ns since 1970.
    pub end: Option<u64>,
}

impl Selection {
    /// All messages on these topics.
    pub fn topics<S: Into<String>>(names: impl IntoIterator<Item = S>) -> Self {
        Self { topics: Some(names.into_iter().map(Into::into).collect()), ..Self::default() }
    }
}
