//! The topics of parts and credits.

use grainlab_msgs::{Topic, topics};

/// The topic of parts or credits of a plain topic, given the resolved name of the latter.
///
/// The contract's `packing` has `packing_chunk` and `packing_credit` next to it, whatever it was remapped to.
pub(super) fn beside(resolved: &str, transport: &Topic) -> Topic {
    let suffix = transport.name.strip_prefix(topics::PACKING.name).unwrap_or(transport.name);
    // The names of topics are static; these are few.
    Topic { name: Box::leak(format!("{resolved}{suffix}").into_boxed_str()), ..*transport }
}
