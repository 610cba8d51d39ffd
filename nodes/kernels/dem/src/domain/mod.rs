//! Grains, and how they and the sums over their contacts are divided among threads.
//!
//! - `state`: grains and cell
//! - `decomposition`: chunks, parts and subdomains
//! - `distributed_state`: a copy of the state per subdomain, with ghosts
//! - `accumulator`: forces on grains, summed in an order that the threads do not change

pub(crate) mod accumulator;
pub(crate) mod decomposition;
pub(crate) mod distributed_state;
pub(crate) mod state;
