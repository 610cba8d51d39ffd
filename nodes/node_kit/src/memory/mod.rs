//! The bus in memory: the semantics of the DDS bus with virtual time, seeded faults and a fixed order, in one thread.
//!
//! - `hub`: what all buses of one test share; `bus`: the [`crate::Bus`] over it
//! - `faults`: what can go wrong with a sample; `schedule`: stepping several nodes in one thread

mod bus;
mod faults;
mod hub;
mod schedule;

pub use bus::MemoryBus;
pub use faults::{Dice, Faults};
pub use hub::Hub;
pub use schedule::{Actor, run_until};
