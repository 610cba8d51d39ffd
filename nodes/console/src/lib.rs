//! What the commands of the `grainlab` binary share.
//!
//! - [`Failure`], [`worse`]: how a command ends
//! - [`Format`], [`Table`], [`print()`], [`say!`]: where its result goes, and in which form
//! - [`plot`]: plots as SVG
//! - [`scenes`]: the scenes built in, and those in files
//! - [`network`]: buses of tools, free domains

mod failure;
pub mod network;
mod output;
pub mod plot;
pub mod scenes;
mod start;

pub use failure::{Failure, worse};
pub use output::{CsvText, Format, Table, exact, fixed, json, print};
