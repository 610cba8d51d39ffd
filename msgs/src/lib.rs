//! The messages of the laboratory: generated ROS 2 types, schema texts, type hashes, the topic contract and
//! the conversion to and from the types of the kernels.
//!
//! - [`msg`] and the packages of standard messages: the types, which the build script generates from the message
//!   files of this project (`msg/`) and of ROS 2 (`std/`; same fields, same type hashes). After you change a message
//!   file, run `tests/golden/make_golden.py`
//! - [`INTERFACES`]: texts of other types of ROS 2, in `interfaces/`
//! - `message`: name, hash and schema of a type; [`TypeInfo`]: the same as a value
//! - `description`: the type description of a type, as `~/get_type_description` returns it
//! - `cdr`: serialization
//! - [`topics`]: the table of topics, types and QoS
//! - `clock`: times as ROS stamps; `guid`: identities of readers and writers
//! - `report`: the report of a process on `/diagnostics`, with its `health` and its `exit` code
//! - [`boundary`]: conversion to and from the types of the kernels; everything received is checked here, once

pub mod boundary;
mod cdr;
mod clock;
mod decode_error;
mod description;
mod exit;
mod fixed_array;
mod guid;
mod health;
mod message;
mod report;
mod topic;
pub mod topics;
mod types;

pub use cdr::{from_cdr, to_cdr};
pub use clock::{EPOCH_SECONDS, simulated_seconds, stamp, wall_stamp};
pub use decode_error::DecodeError;
pub use description::{FieldDescription, FieldTypeDescription, MessageDescription, TypeDescription};
pub use exit::Exit;
pub use guid::Guid;
pub use health::{Health, Level, PhaseReport};
pub use message::{FieldInfo, Message, TypeInfo};
pub use report::{Published, Received, Report};
pub use topic::{Qos, Topic};
pub use types::grainlab_msgs as msg;
pub use types::{
    INTERFACES, builtin_interfaces, diagnostic_msgs, geometry_msgs, rcl_interfaces, rosgraph_msgs,
    sensor_msgs, std_msgs, tf2_msgs, visualization_msgs,
};
