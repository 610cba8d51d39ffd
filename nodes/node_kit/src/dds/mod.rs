//! The bus over DDS, through RustDDS.
//!
//! - `bus`: the [`crate::Bus`] itself and its one place to wait
//! - `inbox`: a reader and what was read but not taken; `caretaker`: empties readers while a node computes
//! - `gate`: whose samples are taken; `processes`: which process runs a participant
//! - `graph`: who else is there; `presence`: this node in the ROS graph
//! - `network`: domain and reach; `claim`: domains for tests; `qos`: the contract as policies; `raw`: bytes in and out
//! - `writer`: one writer

mod bus;
mod caretaker;
mod claim;
mod gate;
mod graph;
mod inbox;
mod network;
mod presence;
mod processes;
mod qos;
mod raw;
mod writer;

pub use bus::DdsBus;
pub use claim::ClaimedDomain;
pub use network::{MAX_DOMAIN, Network, NetworkError, Range};

use crate::bus::BusError;

/// RustDDS could not create something.
fn create_error(what: &str, error: &dyn std::error::Error) -> BusError {
    BusError::Network { what: format!("create {what}"), reason: error.to_string() }
}
