//! The whole laboratory on the bus in memory: four nodes and a recorder in one thread and in virtual time.

mod faults;
mod handover;
mod run;
