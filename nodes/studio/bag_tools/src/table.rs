//! Messages of a topic as a table.

mod csv;
mod parquet;
mod shape;

pub(crate) use csv::{Columns, CsvTable};
pub(crate) use parquet::parquet_table;
pub(crate) use shape::{MOST_COLUMNS, Shape};

/// The first columns: times of the recording.
const TIMES: [&str; 2] = ["log_time", "publish_time"];

/// The name of a column of times, with `recording.` in front if a field has it.
fn free_name(time: &str, is_taken: impl Fn(&str) -> bool) -> String {
    if is_taken(time) { format!("recording.{time}") } else { time.to_owned() }
}
