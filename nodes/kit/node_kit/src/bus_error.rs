//! Errors of the bus.

use crate::names::NameError;

/// Errors of a bus operation.
#[derive(Debug, thiserror::Error)]
pub enum BusError {
    /// The topic name is invalid.
    #[error("topic name: {0}")]
    Name(#[from] NameError),
    /// A reliable reader is so far behind that the window stayed full until the time limit. The sample was dropped.
    #[error("{topic}: a reliable reader is more than {window} samples behind; the sample was dropped")]
    Full {
        /// Resolved topic name.
        topic: String,
        /// Samples that may be unacknowledged.
        window: u32,
    },
    /// The body does not begin with the encapsulation header.
    #[error(
        "{topic}: cannot publish a body that begins {found:02x?}: it must begin 00 01 or 00 00 (CDR of either byte order)"
    )]
    Encapsulation {
        /// Resolved topic name.
        topic: String,
        /// First bytes of the body, at most four.
        found: Vec<u8>,
    },
    /// The handle belongs to another bus.
    #[error("{0}: this handle does not belong to this bus")]
    Handle(&'static str),
    /// The network returned an error.
    #[error("{what}: {reason}")]
    Network {
        /// Operation that failed.
        what: String,
        /// The error of DDS.
        reason: String,
    },
}

/// Accepts that a sample was dropped: a crashed reader must not end the node, and the bus counts what it could not send.
pub fn tolerate_full(published: Result<i64, BusError>) -> Result<(), BusError> {
    match published {
        Ok(_) | Err(BusError::Full { .. }) => Ok(()),
        Err(error) => Err(error),
    }
}

/// RustDDS could not create something.
pub(crate) fn create_error(what: &str, error: &dyn std::error::Error) -> BusError {
    BusError::Network { what: format!("create {what}"), reason: error.to_string() }
}
