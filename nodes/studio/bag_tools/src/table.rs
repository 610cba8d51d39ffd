//! Tables of messages: one row per message, one column per number.
//!
//! - `shape`: fields and the greatest length of each array, from a schema and the messages
//! - `columns`: the columns of a shape, and the cells of a message
//! - `csv`: the file

mod columns;
mod csv;
mod shape;

pub(crate) use columns::Columns;
pub(crate) use csv::CsvTable;
pub(crate) use shape::{MOST_COLUMNS, Shape};
