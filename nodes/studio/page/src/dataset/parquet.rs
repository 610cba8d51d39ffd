//! Tables as Apache Parquet.

use grainlab_any_message::Primitive;
use grainlab_console::{Cell, Failure};
use grainlab_parquet::{Cell as Value, Column, Kind, ParquetTable};

/// The bytes of a file.
pub(super) fn write(names: &[String], rows: &[Vec<Cell>]) -> Result<Vec<u8>, Failure> {
    let columns =
        names.iter().enumerate().map(|(c, name)| column(name, c, rows)).collect::<Result<Vec<_>, _>>()?;
    let value = |cell| typed(cell).map_or(Value::Missing, |(_, value)| value);
    let mut file = Vec::new();
    let written = ParquetTable::new(&mut file, "states", &columns).and_then(|mut table| {
        rows.iter().try_for_each(|row| table.push(row.iter().map(&value).collect()))?;
        table.write_group()?;
        table.finish()
    });
    written.map_err(|e| Failure::failed(format!("Parquet: {e}")))?;
    Ok(file)
}

/// A column with the type of its values; of numbers if nothing in it is known.
fn column(name: &str, column: usize, rows: &[Vec<Cell>]) -> Result<Column, Failure> {
    let mut kinds = rows.iter().filter_map(|row| Some(typed(&row[column])?.0));
    let first = kinds.next().unwrap_or(Kind::One(Primitive::F64));
    if kinds.all(|kind| kind == first) {
        return Ok(Column { name: name.to_owned(), kind: first });
    }
    Err(Failure::failed(format!("Parquet: column {name} has values of several types")))
}

/// Type and value of a cell; `None` if it is unknown.
fn typed(cell: &Cell) -> Option<(Kind, Value)> {
    Some(match cell {
        Cell::Unknown => return None,
        Cell::Number(v) if !v.is_finite() => (Kind::One(Primitive::F64), Value::Missing),
        Cell::Number(v) => (Kind::One(Primitive::F64), Value::Double(*v)),
        Cell::Count(n) => {
            (Kind::One(Primitive::I64), i64::try_from(*n).map_or(Value::Missing, Value::Signed))
        }
        Cell::Flag(flag) => (Kind::One(Primitive::Bool), Value::Bool(*flag)),
        Cell::Text(text) => (Kind::Text, Value::Text(text.clone())),
    })
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
