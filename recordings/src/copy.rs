//! Recordings made from others: cut, merged, filtered, written with another compression.
//!
//! [`copy`] reads one recording or several and writes the selected messages, in order of log time, as a directory of rosbag2
//! (`NAME/NAME_0.mcap` and `metadata.yaml`) or as one file. Payloads, times, sequences, schemas and channels are unchanged;
//! stored files and metadata records are kept. Four things differ:
//!
//! - latched messages from before the start, as a late reader would get them: their log time is the start, their publish time
//!   is unchanged
//! - the ledger of the recorder, and rosbag2's record of counts, which would contradict the copy, are left out; the record
//!   `grainlab_copy` states how the copy was made
//! - with [`CopyOptions::pictures`], each topic with packings has topics with pictures of them beside it
//! - names of stored files and metadata records that are in several recordings with different content get a number
//!
//! The output is written under a temporary name and renamed at the end. An existing one is never overwritten.

mod channels;
mod extras;
mod options;
mod output;
mod pictures;
mod work;

pub use options::{CopyOptions, Preset, Select};
pub use work::{Copied, copy};
