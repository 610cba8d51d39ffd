//! The topics of parts and credits.

use grainlab_msgs::{Topic, topics};

/// The topic of parts or credits that belongs to a plain topic, by the name that this resolved to.
///
/// The contract's `packing` has `packing_chunk` and `packing_credit` beside it, whatever it was remapped to.
pub(super) fn beside(resolved: &str, transport: &Topic) -> Topic {
    let suffix = transport.name.strip_prefix(topics::PACKING.name).unwrap_or(transport.name);
    // A topic of the contract lives as long as the program; these few names do, too.
    Topic { name: Box::leak(format!("{resolved}{suffix}").into_boxed_str()), ..*transport }
}
