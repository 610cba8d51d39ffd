//! `grainlab topic`, `node`, `param`, `interface` and `doctor`: the ROS graph of a domain, over DDS without a ROS installation.
//!
//! - `observer`: joins the domain and collects the graph; `graph`: nodes and endpoints; `names`: names on the wire
//! - `topic`, `node`, `param`, `interface`, `doctor`: the commands
//! - `call`: one call of a service; `reports`: what nodes report of themselves; `view`: formats of the output
//!
//! The commands belong to no run: what they read holds up no node, and what they set changes no result.

mod call;
pub mod doctor;
mod graph;
pub mod interface;
mod names;
pub mod node;
mod observer;
pub mod param;
mod reports;
pub mod topic;
mod view;
