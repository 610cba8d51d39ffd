//! Tables as Parquet files: arrays are lists, messages are structs.

use grainlab_any_message::MessageType;
use grainlab_parquet::{Column, Kind, ParquetError, ParquetTable};
use std::fs::File;
use std::path::Path;

/// A Parquet file for the messages of a type.
pub(crate) fn parquet_table(path: &Path, kind: &MessageType) -> Result<ParquetTable<File>, ParquetError> {
    let is_field = |name: &str| kind.fields.iter().any(|f| f.name == name);
    let time = |name| Column { name: super::free_name(name, is_field), kind: Kind::Time };
    let field =
        |f: &grainlab_any_message::Field| Column { name: f.name.clone(), kind: Kind::Field(f.kind.clone()) };
    let columns: Vec<Column> =
        super::TIMES.into_iter().map(time).chain(kind.fields.iter().map(field)).collect();
    ParquetTable::new(File::create_new(path)?, "messages", &columns)
}
