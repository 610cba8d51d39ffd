//! Messages of `rcl_interfaces`.

mod log;

pub use log::Log;
