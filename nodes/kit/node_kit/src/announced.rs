//! What the writers of a subscription announced, whether it arrived or not.

use grainlab_msgs::Guid;

/// What one writer of another process announced to a reader.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Announced {
    /// The writer.
    pub writer: Guid,
    /// Lowest number that the writer offered to a latched reader that joined; `None` if it owes nothing from before the match.
    pub first: Option<i64>,
    /// Highest number that the writer announced to a reliable reader; 0 before.
    pub last: i64,
    /// Messages that are too large to be received.
    pub too_large: Option<TooLarge>,
}

/// Messages of one writer that are too large to be received.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TooLarge {
    /// Lowest number of these messages.
    pub first: i64,
    /// Highest number of these messages.
    pub last: i64,
    /// Number of these messages.
    pub count: u64,
    /// Size of the largest one, bytes.
    pub largest: usize,
    /// Size of the largest message that is received, bytes.
    pub limit: usize,
}
