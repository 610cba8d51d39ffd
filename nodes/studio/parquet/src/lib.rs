//! Tables of ROS 2 values as Parquet: arrays are lists, messages are structs.

mod nested;
mod schema;

use grainlab_any_message::Value;
use nested::Nested;
pub use parquet::errors::ParquetError;
use parquet::file::properties::{EnabledStatistics, WriterProperties};
use parquet::file::writer::SerializedFileWriter;
use parquet::schema::types::{ColumnPath, Type};
pub use schema::{Column, Kind};
use std::io::Write;
use std::sync::Arc;

/// Bytes of a row group in memory.
const GROUP: usize = 32 << 20;
/// Rows of a row group.
const ROWS: usize = 1 << 17;

/// A Parquet file, written in row groups, not compressed.
///
/// A column of numbers, texts or times is optional; lists, structs and what is in them are not. A message without fields, and a list
/// of such, has no column.
pub struct ParquetTable<W: Write + Send> {
    writer: SerializedFileWriter<W>,
    is_time: Vec<bool>,
    /// The rows of the next row group.
    columns: Vec<Option<Nested>>,
    rows: usize,
    size: usize,
}

impl<W: Write + Send> ParquetTable<W> {
    /// An empty table of this name, written to `file`.
    ///
    /// # Errors
    /// If the columns and the messages in them have more than 20,000 fields, or `file` cannot be written.
    pub fn new(file: W, name: &str, columns: &[Column]) -> Result<Self, ParquetError> {
        let mut fields = 0;
        let types = columns.iter().map(|c| schema::column(c, &mut fields)).collect::<Result<Vec<_>, _>>()?;
        let fields = types.iter().flatten().cloned().collect();
        let schema = Arc::new(Type::group_type_builder(name).with_fields(fields).build()?);
        let mut properties = WriterProperties::builder()
            .set_created_by("grainlab".into())
            .set_dictionary_enabled(false)
            .set_statistics_enabled(EnabledStatistics::Chunk);
        for texts in types.iter().flatten().filter(|t| schema::is_text(t)) {
            properties = properties.set_column_dictionary_enabled(ColumnPath::from(texts.name()), true);
        }
        let writer = SerializedFileWriter::new(file, schema, Arc::new(properties.build()))?;
        let nested = types.iter().map(|t| t.as_deref().map(|t| Nested::of(t, 0, 0))).collect();
        let is_time = columns.iter().map(|c| c.kind == Kind::Time).collect();
        Ok(Self { writer, is_time, columns: nested, rows: 0, size: 0 })
    }

    /// Adds a row, a value or null for each column, and writes the row group if it is large. A time is [`Value::U64`].
    ///
    /// # Errors
    /// If a time is too late for Parquet, or the file cannot be written.
    pub fn row<'v>(&mut self, row: impl IntoIterator<Item = Option<&'v Value>>) -> Result<(), ParquetError> {
        for ((column, is_time), value) in self.columns.iter_mut().zip(&self.is_time).zip(row) {
            if *is_time && matches!(value, Some(Value::U64(ns)) if i64::try_from(*ns).is_err()) {
                let why = "a time is after the year 2262, which a Parquet timestamp cannot hold: convert to csv or json";
                return Err(ParquetError::General(why.to_owned()));
            }
            if let Some(column) = column {
                column.push(value, 0, 0, &mut self.size);
            }
        }
        self.rows += 1;
        if self.rows >= ROWS || self.size >= GROUP {
            self.write_group()?;
        }
        Ok(())
    }

    /// Writes what is left; returns the file.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub fn finish(mut self) -> Result<W, ParquetError> {
        if self.rows > 0 {
            self.write_group()?;
        }
        self.writer.into_inner()
    }

    fn write_group(&mut self) -> Result<(), ParquetError> {
        let mut group = self.writer.next_row_group()?;
        let mut leaves = Vec::new();
        self.columns.iter_mut().flatten().for_each(|column| column.leaves(&mut leaves));
        for leaf in leaves {
            if let Some(column) = group.next_column()? {
                leaf.write(column)?;
            }
        }
        group.close()?;
        (self.rows, self.size) = (0, 0);
        Ok(())
    }
}

#[cfg(test)]
mod tests;
