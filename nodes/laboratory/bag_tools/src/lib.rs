//! The tools of `grainlab bag` for any ROS 2 recording in MCAP: ours, those of `ros2 bag`, and those of other programs.
//!
//! - [`cat`]: messages as JSON or text
//! - [`convert`]: one table per topic, as CSV or Parquet
//! - [`play`]: publishes the messages again
//! - [`cut`], [`merge`], [`filter`], [`compress`]: new recordings from others
//!
//! Each has the arguments of its command and `run`.

pub mod cat;
pub mod compress;
mod compression;
pub mod convert;
pub mod cut;
mod decoders;
pub mod filter;
pub mod merge;
mod opened;
mod output;
pub mod play;
mod selection;
mod table;
mod tables;
mod times;

pub use compression::Compression;
