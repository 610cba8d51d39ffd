//! Messages too large for one sample: in parts, with credits.
//!
//! RustDDS carries some megabytes in one sample and fails far above that: the sample exceeds what a socket buffers, and
//! repair is slow. So a body over [`LIMIT`] travels in parts on a topic beside its own, best effort. Each reader says on a
//! second topic which parts it holds; the writer keeps at most [`WINDOW`] parts ahead of the slowest reader that lives, and
//! sends again what a reader says it misses. Bodies up to the limit travel on the plain topic as ever.
//!
//! Every reader that lives gets every body, in order, before the writer is done with it. A reader that says nothing for
//! [`SILENCE`] is left behind with a warning, so that the dead hold nobody up. The latest body is kept for readers that come
//! late, as on a latched topic.
//!
//! - `part`: one part, and what is wrong with it; `assembly`: the parts of one body
//! - `sender`, `receiver`: the two ends as state machines without a bus or a clock
//! - [`BulkPublisher`], [`BulkSubscription`]: the same on a [`crate::Bus`], for nodes

mod assembly;
mod part;
mod publisher;
mod receiver;
mod sender;
mod subscription;
#[cfg(test)]
mod tests;

pub use part::PartError;
pub use publisher::BulkPublisher;
pub use subscription::BulkSubscription;

use grainlab_msgs::{Topic, topics};
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
const STALLED: Duration = Duration::from_secs(30);

/// How long a writer waits for the first credit of a reader that is there.
const FIRST_WORD: Duration = Duration::from_secs(3);

/// A part that a reader does not have so long after it was sent is lost.
const LOST: Duration = Duration::from_millis(40);

/// How often a credit is repeated while parts are missing, and how rarely while none are.
const REPEAT: Duration = Duration::from_millis(50);
const REST: Duration = Duration::from_secs(1);

/// How often either end looks after the graph and the silent.
const LOOK: Duration = Duration::from_millis(20);

/// The topic of parts or credits that belongs to a plain topic, by the name that this resolved to.
///
/// The contract's `packing` has `packing_chunk` and `packing_credit` beside it, whatever it was remapped to.
fn beside(resolved: &str, transport: &Topic) -> Topic {
    let suffix = transport.name.strip_prefix(topics::PACKING.name).unwrap_or(transport.name);
    // A topic of the contract lives as long as the program; these few names do, too.
    Topic { name: Box::leak(format!("{resolved}{suffix}").into_boxed_str()), ..*transport }
}
