//! Apache Parquet.

use grainlab_console::{Cell, Failure};
use parquet::basic::{LogicalType, Repetition, Type as PhysicalType};
use parquet::data_type::{BoolType, ByteArray, ByteArrayType, DataType, DoubleType, Int64Type};
use parquet::errors::ParquetError;
use parquet::file::properties::WriterProperties;
use parquet::file::writer::{SerializedColumnWriter, SerializedFileWriter};
use parquet::schema::types::Type;
use std::sync::Arc;

/// Type of a column.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    Number,
    Count,
    Flag,
    Text,
}

impl Kind {
    fn of(cell: &Cell) -> Option<Self> {
        match cell {
            Cell::Unknown => None,
            Cell::Number(_) => Some(Self::Number),
            Cell::Count(_) => Some(Self::Count),
            Cell::Flag(_) => Some(Self::Flag),
            Cell::Text(_) => Some(Self::Text),
        }
    }

    fn physical(self) -> PhysicalType {
        match self {
            Self::Number => PhysicalType::DOUBLE,
            Self::Count => PhysicalType::INT64,
            Self::Flag => PhysicalType::BOOLEAN,
            Self::Text => PhysicalType::BYTE_ARRAY,
        }
    }
}

/// The bytes of a file.
pub(super) fn write(names: &[String], rows: &[Vec<Cell>]) -> Result<Vec<u8>, Failure> {
    let kinds = (0..names.len()).map(|c| kind(&names[c], c, rows)).collect::<Result<Vec<_>, _>>()?;
    encode(names, &kinds, rows).map_err(|e| Failure::failed(format!("Parquet: {e}")))
}

/// The kind of a column; of numbers if nothing in it is known.
fn kind(name: &str, column: usize, rows: &[Vec<Cell>]) -> Result<Kind, Failure> {
    let mut kinds = rows.iter().filter_map(|row| Kind::of(&row[column]));
    let first = kinds.next().unwrap_or(Kind::Number);
    if kinds.all(|kind| kind == first) {
        return Ok(first);
    }
    Err(Failure::failed(format!("Parquet: column {name} has values of several types")))
}

fn encode(names: &[String], kinds: &[Kind], rows: &[Vec<Cell>]) -> Result<Vec<u8>, ParquetError> {
    let field = |(name, kind): (&String, &Kind)| {
        let text = (*kind == Kind::Text).then_some(LogicalType::String);
        let built = Type::primitive_type_builder(name, kind.physical())
            .with_repetition(Repetition::OPTIONAL)
            .with_logical_type(text)
            .build();
        built.map(Arc::new)
    };
    let fields = names.iter().zip(kinds).map(field).collect::<Result<Vec<_>, _>>()?;
    let schema = Arc::new(Type::group_type_builder("states").with_fields(fields).build()?);
    let properties = WriterProperties::builder().set_created_by("grainlab".into()).build();
    let mut writer = SerializedFileWriter::new(Vec::new(), schema, Arc::new(properties))?;
    let mut group = writer.next_row_group()?;
    for (c, kind) in kinds.iter().enumerate() {
        let Some(mut column) = group.next_column()? else { break };
        let cells = || rows.iter().map(|row| &row[c]);
        match kind {
            Kind::Number => put::<DoubleType>(&mut column, cells(), |cell| match cell {
                Cell::Number(v) => Some(*v).filter(|v| v.is_finite()),
                _ => None,
            }),
            Kind::Count => put::<Int64Type>(&mut column, cells(), |cell| match cell {
                Cell::Count(n) => i64::try_from(*n).ok(),
                _ => None,
            }),
            Kind::Flag => put::<BoolType>(&mut column, cells(), |cell| match cell {
                Cell::Flag(flag) => Some(*flag),
                _ => None,
            }),
            Kind::Text => put::<ByteArrayType>(&mut column, cells(), |cell| match cell {
                Cell::Text(text) => Some(ByteArray::from(text.as_str())),
                _ => None,
            }),
        }?;
        column.close()?;
    }
    group.close()?;
    writer.into_inner()
}

/// Writes one column; what is unknown has definition level 0.
fn put<'a, T: DataType>(
    column: &mut SerializedColumnWriter<'_>,
    cells: impl Iterator<Item = &'a Cell>,
    value: impl Fn(&Cell) -> Option<T::T>,
) -> Result<(), ParquetError> {
    let values: Vec<Option<T::T>> = cells.map(value).collect();
    let levels: Vec<i16> = values.iter().map(|v| i16::from(v.is_some())).collect();
    let known: Vec<T::T> = values.into_iter().flatten().collect();
    column.typed::<T>().write_batch(&known, Some(&levels), None).map(|_| ())
}

#[cfg(test)]
mod tests {
    use super::super::Dataset;
    use super::*;
    use parquet::file::reader::{FileReader, SerializedFileReader};
    use parquet::record::RowAccessor;

    fn table() -> Dataset {
        let mut t = Dataset::new(["text", "number", "count", "flag", "empty"].map(str::to_owned));
        t.row([Cell::Text("ε".into()), Cell::Number(0.1), Cell::Count(7), Cell::Flag(true)]);
        t.row([Cell::Unknown, Cell::Unknown, Cell::Unknown, Cell::Unknown]);
        t.row([Cell::Text("b".into()), Cell::Number(f64::INFINITY), Cell::Count(8), Cell::Flag(false)]);
        t
    }

    #[test]
    fn values_are_read_back_and_what_is_unknown_is_null() {
        let file = table().parquet().unwrap();
        assert_eq!(file, table().parquet().unwrap());
        let reader = SerializedFileReader::new(bytes::Bytes::from(file)).unwrap();
        let rows: Vec<_> = reader.get_row_iter(None).unwrap().map(Result::unwrap).collect();
        assert_eq!(rows.len(), 3);
        let first = &rows[0];
        assert_eq!((first.get_string(0).unwrap().as_str(), first.get_double(1).unwrap()), ("ε", 0.1));
        assert_eq!((first.get_long(2).unwrap(), first.get_bool(3).unwrap()), (7, true));
        for (row, column) in [(0, 4), (1, 0), (1, 1), (1, 2), (1, 3), (2, 1)] {
            assert!(rows[row].is_null(column).unwrap(), "row {row}, column {column}");
        }
    }

    #[test]
    fn a_column_of_two_types_is_refused_by_its_name() {
        let mut t = Dataset::new(["mixed".to_owned()]);
        t.row([Cell::Count(1)]);
        t.row([Cell::Number(1.0)]);
        assert!(t.parquet().unwrap_err().to_string().contains("mixed"));
    }
}
