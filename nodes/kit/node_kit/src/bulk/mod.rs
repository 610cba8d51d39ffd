//! Messages too large for one sample: sent in parts, with flow control by credits.
//!
//! RustDDS sends some megabytes in one sample and fails far above that: the sample exceeds the buffer of a socket, and
//! repair is slow. So a body over [`BULK_LIMIT`] is sent in parts on a separate best-effort topic. Each reader
//! publishes on a second topic which parts it holds (a credit). The writer sends at most `WINDOW` parts beyond the
//! first one that the slowest active reader lacks, and repeats lost parts. Bodies up to the limit are sent on the plain
//! topic.
//!
//! Every active reader receives every body, in order, before the next one is sent. The writer stops waiting
//! for a reader that sends no credit for `SILENCE`, with a warning, so that a crashed reader does not stop
//! the others. The latest body is kept for readers that join late, as on a latched topic.
//!
//! - `part`: one part and its checks; `assembly`: the parts of one body
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
