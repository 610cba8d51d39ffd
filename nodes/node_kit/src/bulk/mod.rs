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
mod limits;
mod part;
mod part_topics;
mod publisher;
mod receiver;
mod sender;
mod subscription;
#[cfg(test)]
mod tests;

pub use limits::LIMIT as BULK_LIMIT;
pub use publisher::BulkPublisher;
pub use subscription::BulkSubscription;
