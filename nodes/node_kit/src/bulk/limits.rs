//! Sizes and times of the transfer of large messages.

use std::time::Duration;

/// Longest body that travels as one sample, bytes: measured to arrive reliably at 10 Hz.
pub const LIMIT: usize = 2_000_000;

/// Bytes of a part.
pub const STRIDE: usize = 128 << 10;

/// Parts on their way to the slowest reader: with [`STRIDE`] 1 MiB, a quarter of a socket's buffer.
pub const WINDOW: u32 = 8;

/// Longest body that a reader accepts, bytes.
pub const LONGEST: u64 = 1 << 30;

/// A reader that gives no credit for this long is left behind.
pub const SILENCE: Duration = Duration::from_secs(5);

/// A reader that gives credits, takes more, and gets nothing for this long is left behind, too.
pub(super) const STALLED: Duration = Duration::from_secs(30);

/// How long a writer waits for the first credit of a reader that is there.
pub(super) const FIRST_WORD: Duration = Duration::from_secs(3);

/// A part that a reader does not have so long after it was sent is lost.
pub(super) const LOST: Duration = Duration::from_millis(40);

/// How often a credit is repeated while parts are missing, and how rarely while none are.
pub(super) const REPEAT: Duration = Duration::from_millis(50);
pub(super) const REST: Duration = Duration::from_secs(1);

/// How often either end looks after the graph and the silent.
pub(super) const LOOK: Duration = Duration::from_millis(20);
