//! Errors of RustDDS as errors of the bus.

use crate::bus_error::BusError;

/// RustDDS could not create something.
pub(crate) fn create_error(what: &str, error: &dyn std::error::Error) -> BusError {
    BusError::Network { what: format!("create {what}"), reason: error.to_string() }
}
