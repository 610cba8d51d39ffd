//! The exchange of the lockstep alone, over the bus of this crate and over bare ros2-client, so that both can
//! be compared in one run.
//!
//! Each function is one role of one process: the pinging side publishes a `Stress`, the answering side a `StrainRate`
//! with the same sequence. Writers are reliable, the partners read best effort and the pinging side repeats, as in the
//! real exchange. A third role reads both topics, as the recorder does.

mod bare;
mod bus;
mod exchange;

pub use bare::{bare_ping, bare_pong};
pub use bus::{bus_listen, bus_ping, bus_pong};
