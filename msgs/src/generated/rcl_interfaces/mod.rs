//! Messages of `rcl_interfaces`.

mod log;
mod parameter;
mod parameter_event;
mod parameter_value;

pub use log::Log;
pub use parameter::Parameter;
pub use parameter_event::ParameterEvent;
pub use parameter_value::ParameterValue;
