//! The bus over DDS, through RustDDS.
//!
//! - `bus`: the [`crate::Bus`] itself, with its single wait
//! - `inbox`: a reader with the samples that were read but not taken; `background_reader`: reads while a node computes
//! - `gate`: which samples are accepted; `processes`: the process of a participant
//! - `graph`: endpoints of other processes; `ros_graph`: announces this node in the ROS graph
//! - `network`: domain and reach; `test_domain`: domains for tests; `qos`: the contract as policies; `raw`: bytes in
//!   and out
//! - `writer`: one writer

mod background_reader;
mod bus;
mod error;
mod gate;
mod graph;
mod inbox;
mod network;
mod processes;
mod qos;
mod raw;
mod ros_graph;
mod test_domain;
mod writer;

pub use bus::DdsBus;
pub use network::{MAX_DOMAIN, Network, NetworkError, Reach};
pub use test_domain::ClaimedDomain;
