//! Recordings: one MCAP file or a run directory, read by topic and time.
//!
//! A complete file is read through its index, which is compared with the frames of the records. A file that is truncated, or whose
//! index is wrong or absent, is read from its start as far as possible. A chunk whose checksum fails is left out. Unreadable parts are
//! listed by [`Recording::warnings`]; no content causes a panic.
//!
//! Memory is bounded: a chunk may decompress to 1 GiB, or to 64 times its size in the file if that is more; all data in memory
//! at once is at most 64 times the recording's size, or 1 GiB if that is more, plus one chunk.
//!
//! The file is mapped into memory: no other process may shorten it meanwhile (it may grow).

mod block;
mod channel;
mod chunk;
mod data;
mod declarations;
mod definition;
mod end;
mod entry;
mod error;
mod file;
mod files;
mod held;
mod index;
mod info;
mod lengths;
mod message;
mod messages;
mod recording;
mod records;
mod stated;
mod verify;
mod walk;

pub use channel::ChannelInfo;
pub use definition::StoredDefinition;
pub(crate) use error::no_such_topic;
pub use error::{Warning, WarningKind};
pub(crate) use file::FileCount;
pub use file::StoredFile;
pub(crate) use files::BagInformation;
pub use info::{Info, TopicInfo};
pub use message::{Message, Payload};
pub use messages::{Messages, Selection};
pub use recording::Recording;
pub(crate) use records::{is_misplaced, is_unknown};
pub use verify::Check;
pub(crate) use walk::{Walked, place, walk};
