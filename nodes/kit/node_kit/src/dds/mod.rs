//! The bus over DDS, through ros2-client.
//!
//! - `bus`: the [`crate::Bus`] itself, with its single wait
//! - `inbox`: a reader with the samples that were read but not taken; `background_reader`: reads while a node computes
//! - `gate`: which samples are accepted
//! - `graph`: endpoints of other processes
//! - `network`: domain and reach; `static_peers`: hosts that are found without multicast
//! - `writer`: one writer; `direct`: what ros2-client lacks, from RustDDS

mod announcements;
mod background_reader;
mod bus;
mod direct;
mod gate;
mod graph;
mod inbox;
mod network;
mod static_peers;
mod writer;

pub use bus::DdsBus;
pub(crate) use direct::{LOG_TARGET, wall_nanos};
pub use network::{CROWDING_ADVICE, MAX_DOMAIN, Network, NetworkError, Reach, crowding};
pub use static_peers::StaticPeers;
