//! A node that offers the topics of the bus to Foxglove, Lichtblick and other clients of the Foxglove WebSocket protocol.
//!
//! - [`parameters()`], [`BridgeSettings`]: port, address, folders with message files
//! - [`FoxgloveBridge`]: the node
//! - `topics`: the topics of the bus as channels
//! - `pictures`: pictures of packings, made here
//! - `server`: the WebSocket server and what its clients ask for; `client`: one of them; `protocol`: the messages
//!
//! A topic is received only while a client subscribes to it. Samples pass as they are, in CDR with `ros2msg` schemas. Each
//! client has a queue of bounded length: one that does not read loses messages, and holds up nothing.

mod client;
mod node;
mod pictures;
mod protocol;
mod server;
mod settings;
mod topics;

pub use node::FoxgloveBridge;
pub use settings::{BridgeSettings, parameters};
