//! Tests of the whole laboratory: real processes, recordings, interoperation, the paper.
//!
//! - [`lab`]: the `grainlab` binary under test, in a separate folder and DDS domain
//! - [`process`]: one process, killed when dropped
//! - [`terminal`]: a terminal of a given width, and what it shows
//! - [`hosts`]: several hosts on one switch, as network namespaces
//! - [`bodies`]: the content of a recording, topic by topic, without repeats
//! - [`crowd`]: participants that are announced and do not exist
//! - [`lattice`]: packings that need no simulation
//! - [`wait`]: waiting for what another process does
//! - [`python`]: the independent tools, if they are installed

pub mod bodies;
pub mod crowd;
pub mod hosts;
pub mod lab;
pub mod lattice;
pub mod process;
pub mod python;
pub mod terminal;
pub mod wait;
