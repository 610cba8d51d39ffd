//! Tables as Apache Parquet.

use grainlab_any_message::{Element, FieldType, Length, Primitive, Value};
use grainlab_console::{Cell, Failure};
use grainlab_parquet::{Column, Kind, ParquetTable};

/// The bytes of a file.
pub(super) fn write(names: &[String], rows: &[Vec<Cell>]) -> Result<Vec<u8>, Failure> {
    let columns =
        names.iter().enumerate().map(|(c, name)| column(name, c, rows)).collect::<Result<Vec<_>, _>>()?;
    let written = ParquetTable::new(Vec::new(), "states", &columns).and_then(|mut table| {
        for row in rows {
            let values: Vec<Option<Value>> = row.iter().map(|cell| typed(cell)?.1).collect();
            table.row(values.iter().map(Option::as_ref))?;
        }
        table.finish()
    });
    written.map_err(|e| Failure::failed(format!("Parquet: {e}")))
}

/// A column with the type of its values; of numbers if nothing in it is known.
fn column(name: &str, column: usize, rows: &[Vec<Cell>]) -> Result<Column, Failure> {
    let mut kinds = rows.iter().filter_map(|row| Some(typed(&row[column])?.0));
    let first = kinds.next().unwrap_or(Element::Primitive(Primitive::F64));
    if kinds.all(|kind| kind == first) {
        let kind = Kind::Field(FieldType { element: first, length: Length::One });
        return Ok(Column { name: name.to_owned(), kind });
    }
    Err(Failure::failed(format!("Parquet: column {name} has values of several types")))
}

/// Type and value of a cell; `None` if it is unknown.
fn typed(cell: &Cell) -> Option<(Element, Option<Value>)> {
    Some(match cell {
        Cell::Unknown => return None,
        Cell::Number(v) => (Element::Primitive(Primitive::F64), v.is_finite().then_some(Value::F64(*v))),
        Cell::Count(n) => (Element::Primitive(Primitive::I64), i64::try_from(*n).ok().map(Value::I64)),
        Cell::Flag(flag) => (Element::Primitive(Primitive::Bool), Some(Value::Bool(*flag))),
        Cell::Text(text) => (Element::String(None), Some(Value::Text(text.clone()))),
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
