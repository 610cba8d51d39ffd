//! Messages of `rosgraph_msgs`.

mod clock;

pub use clock::Clock;
