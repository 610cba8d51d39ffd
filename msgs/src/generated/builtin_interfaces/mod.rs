//! Messages of `builtin_interfaces`.

mod duration;
mod time;

pub use duration::Duration;
pub use time::Time;
