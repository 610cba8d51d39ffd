//! What the commands of the `grainlab` binary share.
//!
//! - [`Failure`], [`worse`]: the end of a command
//! - [`Format`], [`Table`], [`print()`], [`say!`]: its output
//! - [`write_whole`]: files that are written whole or not at all
//! - [`count()`]: counts with their noun; [`duration()`]: times; [`Pace`]: rates and the time left
//! - [`Dataset`]: typed columns, as CSV and Parquet
//! - [`plot`]: plots as SVG; [`html`]: elements of HTML pages
//! - [`scenes`]: built-in scenes, and those in files
//! - [`network`]: buses of tools, free domains

mod count;
mod dataset;
mod duration;
mod failure;
pub mod html;
pub mod network;
mod output;
mod pace;
pub mod plot;
pub mod scenes;
mod whole_file;

pub use count::count;
pub use dataset::{Cell, Dataset};
pub use duration::duration;
pub use failure::{Failure, worse};
pub use output::{CsvText, Format, Table, exact, fixed, json, print, print_more, say_line};
pub use pace::Pace;
pub use whole_file::write_whole;
