//! The common part of all processes: the bus, which is DDS by ros2-client, and the run of a node. `dds/direct` has what
//! ros2-client lacks.
//!
//! - `bus`: the [`Bus`] of a node: serialized samples in and out, and a single wait; `sample`, `demand`, `bus_error`:
//!   its types; [`Graph`]: the endpoints and processes that it knows; [`Statistics`]: its counts; `handles`:
//!   publishers and subscriptions by number
//! - `delivery`: whether the readers of a publisher make progress
//! - `offer`: the topics, types and QoS that other processes publish
//! - `typed`: typed publishers and subscriptions; `bulk`: messages too large for one sample; `source`: samples of any topic; `worker`: long
//!   computations
//! - `dds`: the bus over DDS; `memory`: the bus in memory, for several nodes in one process, and with virtual time and faults
//!   for tests
//! - `identity`: the run of a process; `admission`: the samples that a process accepts
//! - `node`: a node as a state machine; `run`: running it as a process; `executor`: running several in one process;
//!   `housekeeping`: reports and log lines between their steps
//! - [`PackingNode`]: the template of nodes that measure packings
//! - [`processes`]: processes of this host and their ports
//! - `peers`: liveliness of processes; [`watchdog`]: detects failed DDS threads
//! - `args`, `names`, `parameters`: the ROS 2 command line, names and remaps, parameters; `services`: the standard
//!   services of a node
//! - `tool_bus`: the bus of a tool; `free_domain`: domains without participants; `off_the_bus`: runs in one process; `lock`: locks that survive a panic
//! - `logging`: log lines on stderr; `rosout`: the same on `/rosout`, between steps

mod admission;
mod announced;
mod args;
mod bulk;
mod bus;
mod bus_error;
mod dds;
mod delivery;
mod demand;
mod executor;
mod free_domain;
mod graph;
mod handles;
mod housekeeping;
mod identity;
mod lock;
mod logging;
mod memory;
mod names;
mod node;
mod off_the_bus;
mod offer;
mod packing_node;
mod parameters;
mod peers;
pub mod processes;
mod rosout;
mod run;
mod sample;
mod services;
mod source;
mod statistics;
mod tool_bus;
mod typed;
pub mod watchdog;
mod worker;

pub use admission::{Participant, Process, Stranger};
pub use announced::{Announced, TooLarge};
pub use args::{ArgsError, Assignment, RosArgs};
pub use bulk::{BULK_LIMIT, BulkPublisher, BulkSubscription};
pub use bus::{Bus, Caller, Wake};
pub use bus_error::{BusError, tolerate_full};
pub use dds::{CROWDING_ADVICE, DdsBus, MAX_DOMAIN, Network, NetworkError, Reach, StaticPeers, crowding};
pub use delivery::Delivery;
pub use demand::Demand;
pub use executor::{Component, step_all};
pub use free_domain::{FreeDomain, is_in_use, is_launched};
pub use grainlab_msgs::{Exit, Health, Level, Published, Received, Report};
pub use graph::Graph;
pub use handles::{PublisherId, SubscriptionId};
pub use housekeeping::{DriveError, HEARTBEAT};
pub use identity::{
    Identity, MEMBER_VARIABLE, ROOT_VARIABLE, RUN_VARIABLE, RunId, Scope, may_be_ours, member_of, run_of,
};
pub use logging::Logger;
pub use memory::{Actor, Dice, Faults, Hub, MemoryBus, run_until};
pub use names::{NameError, Names};
pub use node::{Next, Node, NodeError};
pub use off_the_bus::OffTheBus;
pub use offer::{Offer, type_hash};
pub use packing_node::{Declined, Measure, PackingNode, Tally, Words, step_or_none};
pub use parameters::{
    FromParameter, IntoParameter, ParameterError, ParameterSpec, ParameterValue, Parameters, Range,
    parameter_text, parse_value,
};
pub use peers::{Liveliness, Peer, PeerWatch, SILENCE};
pub use run::{NodeSpec, drive, run_node, use_sim_time};
pub use sample::{Sample, SampleId, SampleInfo};
pub use source::Source;
pub use statistics::Statistics;
pub use tool_bus::{bus_in, bus_named, tool_bus};
pub use typed::{Publisher, Subscription};
pub use worker::Worker;
