//! Sizes and times of the transfer of large messages.

use std::time::Duration;

/// Largest body sent as one sample, bytes: measured to arrive reliably at 10 Hz.
pub const LIMIT: usize = 2_000_000;

/// Size of a part, bytes.
pub(crate) const STRIDE: usize = 128 << 10;

/// Maximum number of parts in transit to the slowest reader: with [`STRIDE`] 1 MiB, a quarter of a socket's buffer.
pub(crate) const WINDOW: u32 = 8;

/// Largest body that a reader accepts, bytes.
pub(crate) const LONGEST: u64 = 1 << 30;

/// The writer stops waiting for a reader that sends no credit for this long: a network that fails for some seconds loses
/// no message.
pub(crate) const SILENCE: Duration = Duration::from_secs(15);

/// The writer stops waiting for a reader that sends credits, is ready, and makes no progress for this long.
pub(super) const STALLED: Duration = Duration::from_secs(30);

/// Both limits for a process that is about to end.
pub(super) const HURRIED: Duration = Duration::from_secs(5);

pub(super) const FIRST_CREDIT_LIMIT: Duration = Duration::from_secs(3);

/// A part that a reader does not have this long after it was sent counts as lost.
pub(super) const LOST_AFTER: Duration = Duration::from_millis(40);

/// Period of credits while parts are missing.
pub(super) const CREDIT_PERIOD: Duration = Duration::from_millis(50);
/// Longest period of credits while no part is missing.
pub(super) const IDLE_CREDIT_PERIOD: Duration = Duration::from_secs(1);

/// Period at which a writer checks the graph and the time limits of its readers.
pub(super) const POLL_PERIOD: Duration = Duration::from_millis(20);
