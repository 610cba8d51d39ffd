//! Why a bus operation failed.

use crate::names::NameError;

/// Why the bus could not do what was asked.
#[derive(Debug, thiserror::Error)]
pub enum BusError {
    /// A topic name that does not resolve.
    #[error("topic name: {0}")]
    Name(#[from] NameError),
    /// A reliable reader is so far behind that the window stayed full for the whole bounded wait. The sample was dropped.
    #[error("{topic}: a reliable reader is more than {window} samples behind; the sample was dropped")]
    Full {
        /// Resolved topic name.
        topic: String,
        /// Samples that may be unacknowledged.
        window: u32,
    },
    /// A body that cannot be published as it is.
    #[error(
        "{topic}: cannot publish a body that begins {found:02x?}: it must begin 00 01 (CDR, little endian)"
    )]
    Encapsulation {
        /// Resolved topic name.
        topic: String,
        /// Its first bytes, at most four.
        found: Vec<u8>,
    },
    /// A handle of another bus.
    #[error("{0}: this handle does not belong to this bus")]
    Handle(&'static str),
    /// The network refused.
    #[error("{what}: {reason}")]
    Network {
        /// What was attempted.
        what: String,
        /// What the layer below said.
        reason: String,
    },
}
