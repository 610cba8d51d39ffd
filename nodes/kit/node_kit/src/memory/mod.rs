//! The bus in memory: the semantics of the DDS bus with virtual time, seeded faults and a fixed order, in one thread.
//!
//! - `hub`: the network that all buses of one test share; `state`: its state; `bus`: the [`crate::Bus`] on it
//! - `faults`: faults of samples in transit; `schedule`: stepping several nodes in one thread

mod bus;
mod faults;
mod hub;
mod schedule;
mod state;

pub use bus::MemoryBus;
pub use faults::{Dice, Faults};
pub use hub::Hub;
pub use schedule::{Actor, run_until};
