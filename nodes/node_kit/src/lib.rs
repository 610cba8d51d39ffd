//! What every process of the laboratory shares. This is the only crate that knows DDS.
//!
//! - [`bus`]: the [`Bus`] a node sees: serialized samples, one place to wait; [`typed`]: typed handles over it
//! - [`bulk`]: messages too large for one sample; [`worker`]: work that takes longer than a node may be away
//! - [`dds`]: the bus over DDS; [`memory`]: the bus in memory, with virtual time and faults, for tests
//! - [`identity`]: which run a process belongs to; [`admission`]: whose samples it takes
//! - [`node`]: a node as a state machine; [`run`]: running it as a process
//! - [`PackingNode`]: the template of a node that turns packings into results
//! - [`diagnostics`]: what a process reports of itself; [`peers`]: who lives; [`watchdog`]: whether DDS lives
//! - [`args`], [`names`], [`parameters`]: the ROS 2 command line, names and remaps, parameters
//! - [`pingpong`]: the bare exchange, to measure
//! - [`exit`]: exit codes; [`signals`]: SIGINT and SIGTERM; [`logging`]: stderr and `/rosout`

pub mod admission;
pub mod args;
pub mod bulk;
pub mod bus;
pub mod dds;
pub mod diagnostics;
pub mod exit;
pub mod identity;
pub mod logging;
pub mod memory;
pub mod names;
pub mod node;
mod packing_node;
pub mod parameters;
pub mod peers;
pub mod pingpong;
pub mod run;
pub mod signals;
pub mod typed;
pub mod watchdog;
pub mod worker;

pub use admission::Stranger;
pub use args::RosArgs;
pub use bulk::{BulkPublisher, BulkSubscription};
pub use bus::{
    Bus, BusError, Demand, PublisherId, Sample, SampleId, SampleInfo, SubscriptionId, Wake, WriterId,
};
pub use dds::{DdsBus, Network};
pub use diagnostics::Report;
pub use exit::Exit;
pub use identity::{Identity, RunId, Scope};
pub use memory::{Faults, Hub, MemoryBus};
pub use names::Names;
pub use node::{Health, Level, Next, Node, NodeError};
pub use packing_node::{Declined, Measure, PackingNode, Tally, Words, step_or_none};
pub use parameters::{ParameterSpec, ParameterValue, Parameters, Range};
pub use peers::{Life, PeerWatch, Peers};
pub use run::{NodeSpec, drive, run_node};
pub use typed::{Publisher, Subscription, TakeError};
pub use worker::Worker;
