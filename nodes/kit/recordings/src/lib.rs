//! Recordings of runs: MCAP files in the conventions of rosbag2, written so that a crash loses at most half a
//! second.
//!
//! - `writer`: writes a run directory (`<name>_0.mcap` … and `metadata.yaml`), safe against crashes
//! - `ledger`: counts of recorded, lost and repeated messages, per topic and per writer
//! - `reader`: reads recordings by topic and time; truncation and damage are reported
//! - [`recover()`]: completes the files of a recorder that was killed
//! - [`copy`]: recordings made from others: cut, merged, filtered, compressed
//! - `definitions`: schemas of message types; `qos`: profiles of rosbag2
//! - [`OneRun`]: whether packings and requests are of one run
//! - [`TopicNames`]: topics on the command line
//! - `player`: the schedule of a playback, without a clock or a socket
//! - [`import`]: packings from CSV, LAMMPS dump and data files, YADE exports, and recordings
//! - [`input`]: external files, regular and of bounded size; [`runs`]: run directories; [`Lock`], [`run_state()`]: one process at a time in each, and how far it came; [`scenes`]: scenes by name or path
//! - [`strangers`]: processes that are not part of a run, and the writers of its results
//!
//! This crate does not use DDS: the recorder and player nodes pass samples to the writer and take them from
//! the player.

mod bag_metadata;
mod compression;
pub mod copy;
mod definitions;
mod failures;
pub mod import;
mod ledger;
mod lock;
mod message_path;
mod metadata_keys;
mod new_path;
mod one_run;
mod player;
mod qos;
mod reader;
mod recover;
mod run_state;
pub mod runs;
pub mod scenes;
pub mod strangers;
mod topic_names;
mod writer;

pub use compression::Compression;
pub use definitions::Definitions;
pub use grainlab_console::input;
pub use ledger::{Ledger, TopicTally, WriterTally, merge};
pub use lock::{AtWork, Lock, host_name};
pub use message_path::MessagePath;
pub use metadata_keys::{COPY_RECORD, LEDGER_KEY, METADATA_RECORD, SESSION_KEY};
pub use new_path::NewPath;
pub use one_run::{OneRun, RunSign, SeveralRuns};
pub use player::{Play, PlayOptions, Player};
pub use qos::{QosOverrides, adapted, offered_profiles, profiles};
pub use reader::{
    ChannelInfo, Check, Info, Message, Messages, Payload, Recording, Selection, StoredDefinition, StoredFile,
    TopicInfo, Warning, WarningKind,
};
pub use recover::{RecoveredFile, Recovery, recover};
pub use run_state::{RunEnd, RunState, run_end, run_state};
pub use topic_names::TopicNames;
pub use writer::{Finished, Incoming, Outcome, RunWriter, TopicSpec, WriterOptions, recording_in};
