//! Tests of the whole laboratory: real processes, recordings, interoperation, the paper.
//!
//! - [`lab`]: the `grainlab` binary under test, in a folder and a DDS domain of its own
//! - [`process`]: one process, never left behind
//! - [`bodies`]: what a recording holds, topic by topic, repeats removed
//! - [`forger`]: a process that is not of the run and says what the run says, otherwise
//! - [`lattice`]: packings that need no simulation
//! - [`python`]: the independent tools, where they are installed

pub mod bodies;
pub mod forger;
pub mod lab;
pub mod lattice;
pub mod process;
pub mod python;
