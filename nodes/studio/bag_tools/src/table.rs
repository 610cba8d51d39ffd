//! Messages of a topic as a table of text.
//!
//! - `shape`: fields and the greatest length of each array, from a schema and the messages
//! - `csv`: the columns of a shape, and the file

mod csv;
mod shape;

pub(crate) use csv::{Columns, CsvTable};
pub(crate) use shape::{MOST_COLUMNS, Shape};
