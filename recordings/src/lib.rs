//! Recordings of runs: MCAP files in the conventions of rosbag2, written so that a crash costs half a second
//! at most.
//!
//! - [`writer`]: a run directory (`<name>_0.mcap` … and `metadata.yaml`) written crash-safe
//! - [`ledger`]: what was recorded, lost and repeated, per topic and per writer
//! - [`reader`]: recordings by topic and time, tolerant of truncation and damage, which it names
//! - [`recover()`]: the proper end for the file of a recorder that was killed
//! - [`player`]: when to send which message, without a clock or a socket
//! - [`import`]: packings from CSV, LAMMPS dump and data files, YADE exports, and our own recordings
//! - [`export`]: packings to CSV and LAMMPS dump files
//! - [`input`]: files from outside, regular and of bounded size
//!
//! Nothing here knows DDS: a thin shell hands samples to the writer and takes them from the player.

mod bag_metadata;
pub mod export;
pub mod import;
pub mod input;
pub mod ledger;
pub mod player;
pub mod reader;
mod recover;
pub mod runs;
pub mod writer;

pub use ledger::{Guid, Ledger, TopicTally};
pub use player::{Play, PlayError, PlayOptions, Player};
pub use reader::{Message, ReadError, Recording, Selection, Warning};
pub use recover::{RecoverError, RecoveredFile, Recovery, recover};
pub use writer::{Incoming, Outcome, RunWriter, TopicSpec, WriteError, WriterOptions};

/// Name of the metadata record that holds what the laboratory knows about a run: the caller's keys, and
/// [`LEDGER_KEY`].
pub const METADATA_RECORD: &str = "grainlab";

/// Key, in the metadata record [`METADATA_RECORD`], of the ledger as JSON.
pub const LEDGER_KEY: &str = "ledger";

/// Key, in the metadata record [`METADATA_RECORD`], of what tells the writers of one run apart: the account of the last
/// file of a writer covers its files before, too.
pub const SESSION_KEY: &str = "session";
