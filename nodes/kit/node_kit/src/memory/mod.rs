//! The bus in memory: the semantics of the DDS bus in one thread, with the clocks of this host, or with virtual time, seeded
//! faults and a fixed order.
//!
//! - `hub`: the network that all buses of one process share; `state`: its state; `bus`: the [`crate::Bus`] on it
//! - `time`: virtual and real time; `alarm`: ends a wait in real time
//! - `faults`: faults of samples in transit; `schedule`: stepping several nodes in one thread

mod alarm;
mod bus;
mod faults;
mod hub;
mod schedule;
mod state;
mod time;

pub use bus::MemoryBus;
pub use faults::{Dice, Faults};
pub use hub::Hub;
pub use schedule::{Actor, run_until};
