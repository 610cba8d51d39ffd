//! The standard services of a ROS 2 node, through ros2-client: parameters and type descriptions.
//!
//! - `declared`: the parameters of a node as ros2-client declares them
//! - `descriptor`: types, ranges and units, as `describe_parameters` returns them
//! - `servers`: the services; `type_description`: the fields of types; `sim_time`: `use_sim_time`
//! - `thread`: answers while the node computes
//!
//! Anyone may ask, also processes outside the run: what may be set changes no result.

mod declared;
mod descriptor;
mod servers;
mod sim_time;
mod thread;
mod type_description;

pub(crate) use declared::USE_SIM_TIME;
pub(crate) use sim_time::SimTime;
pub(crate) use thread::ServiceThread;
