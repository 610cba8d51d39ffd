//! What every process of the laboratory shares. This is the only crate that knows DDS.
//!
//! - [`bus`]: the [`Bus`] a node sees: serialized samples, one place to wait; [`typed`]: typed handles over it
//! - [`dds`]: the bus over DDS; [`memory`]: the bus in memory, with virtual time and faults, for tests
//! - [`args`], [`names`], [`parameters`]: the ROS 2 command line, names and remaps, parameters
//! - [`exit`]: exit codes; [`signals`]: SIGINT and SIGTERM

pub mod args;
pub mod bus;
pub mod dds;
pub mod exit;
pub mod names;
pub mod parameters;
pub mod signals;
pub mod typed;

pub use args::RosArgs;
pub use bus::{Bus, BusError, Demand, PublisherId, Sample, SampleInfo, SubscriptionId, Wake, WriterId};
pub use dds::{DdsBus, Network};
pub use exit::Exit;
pub use names::Names;
pub use parameters::{ParameterSpec, ParameterValue, Parameters, Range};
pub use typed::{Publisher, Subscription, TakeError};
