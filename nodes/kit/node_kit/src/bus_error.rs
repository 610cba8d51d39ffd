//! Errors of publishing and subscribing.

use crate::names::NameError;

/// Errors of a bus operation.
#[derive(Debug, thiserror::Error)]
pub enum BusError {
    /// The topic name is invalid.
    #[error("topic name: {0}")]
    Name(#[from] NameError),
    /// A reliable reader has not acknowledged a whole window of samples, or the parts of the previous message. Nothing was
    /// sent.
    #[error("{topic}: not sent: a reliable reader is {window} samples behind")]
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
    /// An operation of DDS or of the operating system failed.
    #[error("{what}: {reason}")]
    Network {
        /// Operation that failed.
        what: String,
        /// Text of its error.
        reason: String,
    },
}

/// Takes a sample that was not sent for success: a crashed reader must not end the node. The bus counts such samples.
pub fn tolerate_full(published: Result<i64, BusError>) -> Result<(), BusError> {
    match published {
        Ok(_) | Err(BusError::Full { .. }) => Ok(()),
        Err(error) => Err(error),
    }
}

pub(crate) fn create_error(what: &str, error: &dyn std::error::Error) -> BusError {
    BusError::Network { what: format!("create {what}"), reason: error.to_string() }
}
