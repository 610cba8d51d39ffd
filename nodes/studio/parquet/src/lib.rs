//! Tables of typed columns as Parquet.

use grainlab_any_message::Primitive;
use parquet::basic::{LogicalType, Repetition, TimeUnit, Type as PhysicalType};
use parquet::data_type::{
    BoolType, ByteArray, ByteArrayType, DataType, DoubleType, FloatType, Int32Type, Int64Type,
};
use parquet::errors::ParquetError;
use parquet::file::properties::WriterProperties;
use parquet::file::writer::{SerializedColumnWriter, SerializedFileWriter};
use parquet::schema::types::Type;
use std::io::Write;
use std::sync::Arc;

/// Rows and cells of a row group, whichever is reached first.
const ROWS: usize = 1 << 16;
const CELLS: usize = 1 << 21;
/// Bytes of texts of a row group.
const TEXT: usize = 64 << 20;

/// Type of a column.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// ns since 1970.
    Time,
    /// Numbers, or yes and no.
    One(Primitive),
    /// Texts in UTF-8.
    Text,
}

/// Column of a table.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Column {
    /// In the header.
    pub name: String,
    /// Type of its values.
    pub kind: Kind,
}

/// A value of a row.
#[derive(Clone, Debug, PartialEq)]
pub enum Cell {
    /// Not known: null.
    Missing,
    /// Yes or no.
    Bool(bool),
    /// A signed integer.
    Signed(i64),
    /// An unsigned integer, or a time.
    Unsigned(u64),
    /// A number of 32 bits.
    Single(f32),
    /// A number of 64 bits.
    Double(f64),
    /// Text in UTF-8.
    Text(String),
}

/// A Parquet file, written in row groups, not compressed. Every column is optional.
pub struct ParquetTable<W: Write + Send> {
    writer: SerializedFileWriter<W>,
    kinds: Vec<Kind>,
    /// The rows of the next row group, column by column.
    cells: Vec<Vec<Cell>>,
    rows: usize,
    text: usize,
}

impl<W: Write + Send> ParquetTable<W> {
    /// An empty table of this name, written to `file`.
    ///
    /// # Errors
    /// If a column cannot be one, or `file` cannot be written.
    pub fn new(file: W, name: &str, columns: &[Column]) -> Result<Self, ParquetError> {
        let fields = columns.iter().map(|c| field(c).map(Arc::new)).collect::<Result<Vec<_>, _>>()?;
        let schema = Arc::new(Type::group_type_builder(name).with_fields(fields).build()?);
        let properties = WriterProperties::builder().set_created_by("grainlab".into()).build();
        let writer = SerializedFileWriter::new(file, schema, Arc::new(properties))?;
        let kinds: Vec<Kind> = columns.iter().map(|c| c.kind).collect();
        Ok(Self { writer, cells: vec![Vec::new(); kinds.len()], kinds, rows: 0, text: 0 })
    }

    /// Adds a row, and writes the row group if it is large.
    ///
    /// # Errors
    /// If a time is too late for Parquet, or the file cannot be written.
    pub fn row(&mut self, row: Vec<Cell>) -> Result<(), ParquetError> {
        self.push(row)?;
        if self.rows >= ROWS || self.rows * self.kinds.len() >= CELLS || self.text >= TEXT {
            self.write_group()?;
        }
        Ok(())
    }

    /// Adds a row to the row group.
    ///
    /// # Errors
    /// If a time is too late for Parquet.
    pub fn push(&mut self, row: Vec<Cell>) -> Result<(), ParquetError> {
        for ((column, kind), cell) in self.cells.iter_mut().zip(&self.kinds).zip(row) {
            if *kind == Kind::Time && matches!(cell, Cell::Unsigned(ns) if i64::try_from(ns).is_err()) {
                let why = "a time is after the year 2262, which a Parquet timestamp cannot hold: convert to csv or json";
                return Err(ParquetError::General(why.to_owned()));
            }
            if let Cell::Text(text) = &cell {
                self.text += text.len();
            }
            column.push(cell);
        }
        self.rows += 1;
        Ok(())
    }

    /// Writes what is left.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub fn finish(mut self) -> Result<(), ParquetError> {
        if self.rows > 0 {
            self.write_group()?;
        }
        self.writer.close().map(drop)
    }

    /// Writes the rows that were added as one row group.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub fn write_group(&mut self) -> Result<(), ParquetError> {
        let mut group = self.writer.next_row_group()?;
        for (kind, cells) in self.kinds.iter().zip(&mut self.cells) {
            let Some(mut column) = group.next_column()? else { break };
            match physical(*kind) {
                PhysicalType::BOOLEAN => put::<BoolType>(&mut column, cells, |cell| match cell {
                    Cell::Bool(v) => Some(v),
                    _ => None,
                }),
                PhysicalType::INT32 => put::<Int32Type>(&mut column, cells, |cell| match cell {
                    Cell::Signed(v) => Some(v as i32),
                    Cell::Unsigned(v) => Some(v as u32 as i32),
                    _ => None,
                }),
                PhysicalType::INT64 => put::<Int64Type>(&mut column, cells, |cell| match cell {
                    Cell::Signed(v) => Some(v),
                    Cell::Unsigned(v) => Some(v as i64),
                    _ => None,
                }),
                PhysicalType::FLOAT => put::<FloatType>(&mut column, cells, |cell| match cell {
                    Cell::Single(v) => Some(v),
                    _ => None,
                }),
                PhysicalType::DOUBLE => put::<DoubleType>(&mut column, cells, |cell| match cell {
                    Cell::Double(v) => Some(v),
                    _ => None,
                }),
                _ => put::<ByteArrayType>(&mut column, cells, |cell| match cell {
                    Cell::Text(text) => Some(ByteArray::from(text.into_bytes())),
                    _ => None,
                }),
            }?;
            column.close()?;
        }
        group.close()?;
        (self.rows, self.text) = (0, 0);
        Ok(())
    }
}

fn physical(kind: Kind) -> PhysicalType {
    match kind {
        Kind::Time => PhysicalType::INT64,
        Kind::Text => PhysicalType::BYTE_ARRAY,
        Kind::One(primitive) => match primitive {
            Primitive::Bool => PhysicalType::BOOLEAN,
            Primitive::F32 => PhysicalType::FLOAT,
            Primitive::F64 => PhysicalType::DOUBLE,
            Primitive::I64 | Primitive::U64 => PhysicalType::INT64,
            _ => PhysicalType::INT32,
        },
    }
}

fn field(column: &Column) -> Result<Type, ParquetError> {
    let integer = |bits: i8, signed: bool| Some(LogicalType::integer(bits, signed));
    let logical = match column.kind {
        Kind::Time => Some(LogicalType::timestamp(true, TimeUnit::NANOS)),
        Kind::Text => Some(LogicalType::String),
        Kind::One(primitive) => match primitive {
            Primitive::I8 => integer(8, true),
            Primitive::U8 => integer(8, false),
            Primitive::I16 => integer(16, true),
            Primitive::U16 => integer(16, false),
            Primitive::U32 => integer(32, false),
            Primitive::U64 => integer(64, false),
            _ => None,
        },
    };
    Type::primitive_type_builder(&column.name, physical(column.kind))
        .with_repetition(Repetition::OPTIONAL)
        .with_logical_type(logical)
        .build()
}

/// Writes one column and empties it; what is missing has definition level 0.
fn put<T: DataType>(
    column: &mut SerializedColumnWriter<'_>,
    cells: &mut Vec<Cell>,
    value: impl Fn(Cell) -> Option<T::T>,
) -> Result<(), ParquetError> {
    let values: Vec<Option<T::T>> = cells.drain(..).map(value).collect();
    let levels: Vec<i16> = values.iter().map(|v| i16::from(v.is_some())).collect();
    let known: Vec<T::T> = values.into_iter().flatten().collect();
    column.typed::<T>().write_batch(&known, Some(&levels), None).map(drop)
}

#[cfg(test)]
mod tests {
    use super::*;
    use bytes::Bytes;
    use parquet::file::reader::{FileReader, SerializedFileReader};
    use parquet::record::Field;

    #[test]
    fn values_of_every_type_are_read_back_and_what_is_missing_is_null() {
        let column = |name: &str, kind| Column { name: name.into(), kind };
        let columns = [
            column("log_time", Kind::Time),
            column("flag", Kind::One(Primitive::Bool)),
            column("i8", Kind::One(Primitive::I8)),
            column("u64", Kind::One(Primitive::U64)),
            column("f32", Kind::One(Primitive::F32)),
            column("f64", Kind::One(Primitive::F64)),
            column("text", Kind::Text),
        ];
        let mut file = Vec::new();
        let mut table = ParquetTable::new(&mut file, "rows", &columns).unwrap();
        let row = vec![
            Cell::Unsigned(1_700_000_000_000_000_001),
            Cell::Bool(true),
            Cell::Signed(-3),
            Cell::Unsigned(u64::MAX),
            Cell::Single(0.5),
            Cell::Double(f64::INFINITY),
            Cell::Text("[1,2]".into()),
        ];
        let mut late = row.clone();
        late[0] = Cell::Unsigned(1 << 63);
        assert!(table.row(late).unwrap_err().to_string().contains("year 2262"), "it would be one of 1677");
        table.cells.iter_mut().for_each(Vec::clear);
        let count = CELLS / columns.len() + 2;
        (1..count).for_each(|_| table.row(row.clone()).unwrap());
        table.row(vec![Cell::Missing; columns.len()]).unwrap();
        table.finish().unwrap();
        let reader = SerializedFileReader::new(Bytes::from(file)).unwrap();
        assert!(reader.num_row_groups() > 1);
        let rows: Vec<_> = reader.get_row_iter(None).unwrap().map(Result::unwrap).collect();
        assert_eq!(rows.len(), count);
        let values: Vec<&Field> = rows[0].get_column_iter().map(|(_, value)| value).collect();
        assert!(format!("{:?}", values[0]).contains("1700000000000000001"), "{:?}", values[0]);
        let expected = [
            Field::Bool(true),
            Field::Byte(-3),
            Field::ULong(u64::MAX),
            Field::Float(0.5),
            Field::Double(f64::INFINITY),
            Field::Str("[1,2]".into()),
        ];
        assert_eq!(values[1..].iter().map(|v| (*v).clone()).collect::<Vec<_>>(), expected);
        assert!(rows[count - 1].get_column_iter().all(|(_, value)| *value == Field::Null));
    }
}
