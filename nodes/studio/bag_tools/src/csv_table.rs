//! Tables as CSV files: fields as `stress.xx`, short arrays as `rate[0]`.

use crate::appended::Appended;
use crate::shape::{MOST_COLUMNS, Shape, time_columns};
use grainlab_any_message::{Array, Message, Value};
use std::io;
use std::path::Path;

#[derive(Clone, Debug)]
pub(crate) struct Columns {
    names: Vec<String>,
    shape: Shape,
    widest: usize,
}

pub(crate) struct CsvTable {
    writer: csv::Writer<Appended>,
    columns: Columns,
}

impl Columns {
    /// `log_time`, `publish_time`, and the fields; arrays of at most `widest` values as `rate[0]` and so on, longer ones as JSON.
    /// `None` if there are more than [`MOST_COLUMNS`].
    pub(crate) fn of(shape: &Shape, widest: usize) -> Option<Self> {
        let mut names = Vec::new();
        name_columns(shape, "", widest, &mut names)?;
        let times = time_columns(|time| names.iter().any(|name| name == time));
        names.splice(0..0, times);
        Some(Self { names, shape: shape.clone(), widest })
    }

    /// Writes the values of a shape; empty ones for what is missing.
    fn fill(&self, shape: &Shape, value: Option<&Value>, row: &mut Vec<String>) {
        match (shape, value) {
            (Shape::One, value) => row.push(value.map_or_else(String::new, text)),
            (Shape::Array(longest, _), value) if is_json(*longest, self.widest) => row.push(match value {
                Some(Value::Array(array)) => array.json(),
                _ => String::new(),
            }),
            (Shape::Message(_), Some(Value::Message(message))) => self.fields(shape, Some(message), row),
            (Shape::Message(_), _) => self.fields(shape, None, row),
            (Shape::Array(longest, item), Some(Value::Array(Array::Message(messages)))) => {
                (0..*longest).for_each(|n| self.fields(item, messages.get(n), row));
            }
            (Shape::Array(longest, item), Some(Value::Array(array))) => {
                (0..*longest).for_each(|n| self.fill(item, array.get(n).as_ref(), row));
            }
            (Shape::Array(longest, item), _) => (0..*longest).for_each(|_| self.fill(item, None, row)),
        }
    }

    fn fields(&self, shape: &Shape, message: Option<&Message>, row: &mut Vec<String>) {
        if let Shape::Message(fields) = shape {
            for (n, (_, field)) in fields.iter().enumerate() {
                self.fill(field, message.and_then(|m| m.values.get(n)), row);
            }
        }
    }
}

impl CsvTable {
    /// Begins the file; `buffer` bytes are collected before they are written to it.
    pub(crate) fn create(path: &Path, columns: Columns, buffer: usize) -> io::Result<Self> {
        let mut writer =
            csv::WriterBuilder::new().buffer_capacity(buffer).from_writer(Appended::create(path)?);
        writer.write_record(&columns.names)?;
        Ok(Self { writer, columns })
    }

    pub(crate) fn row(&mut self, times: [u64; 2], message: &Message) -> io::Result<()> {
        let mut row = Vec::with_capacity(self.columns.names.len());
        row.extend(times.map(|time| time.to_string()));
        self.columns.fields(&self.columns.shape, Some(message), &mut row);
        Ok(self.writer.write_record(&row)?)
    }

    pub(crate) fn finish(mut self) -> io::Result<()> {
        self.writer.flush()
    }
}

/// True for an array that is one column, as JSON.
fn is_json(longest: usize, widest: usize) -> bool {
    longest == 0 || longest > widest
}

fn name_columns(shape: &Shape, name: &str, widest: usize, names: &mut Vec<String>) -> Option<()> {
    if names.len() >= MOST_COLUMNS {
        return None;
    }
    match shape {
        Shape::One => names.push(name.to_owned()),
        Shape::Array(longest, _) if is_json(*longest, widest) => names.push(name.to_owned()),
        Shape::Array(longest, inner) => {
            (0..*longest).try_for_each(|n| name_columns(inner, &format!("{name}[{n}]"), widest, names))?;
        }
        Shape::Message(fields) => {
            let dot = if name.is_empty() { "" } else { "." };
            for (field, shape) in fields {
                name_columns(shape, &format!("{name}{dot}{field}"), widest, names)?;
            }
        }
    }
    Some(())
}

/// A number with all digits; one that is not finite is `NaN`, `inf` or `-inf`.
fn text(value: &Value) -> String {
    match value {
        Value::Bool(v) => v.to_string(),
        Value::I8(v) => v.to_string(),
        Value::I16(v) => v.to_string(),
        Value::I32(v) => v.to_string(),
        Value::I64(v) => v.to_string(),
        Value::U8(v) => v.to_string(),
        Value::U16(v) => v.to_string(),
        Value::U32(v) => v.to_string(),
        Value::U64(v) => v.to_string(),
        // Debug has an exponent where digits would be many.
        Value::F32(v) => format!("{v:?}"),
        Value::F64(v) => format!("{v:?}"),
        Value::Text(v) => v.clone(),
        Value::Message(_) | Value::Array(_) => String::new(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use grainlab_any_message::Schema;

    #[test]
    fn fields_are_flattened_and_arrays_are_as_long_as_the_longest_message() {
        let text = "A a\nfloat32[] short\nuint8[] long\nint16[<=2] bounded\nA[] points\nstring[] none\nuint64 log_time\n\
                    ====\nMSG: p/A\nint8 x\n";
        let schema = Schema::parse("p/msg/T", text).unwrap();
        let mut shape = Shape::of(schema.root(), 3).unwrap();
        let given = serde_json::json!({
            "a": {"x": 5}, "short": ["NaN"], "long": [1, 2, 3, 4], "points": [{"x": 9}, {"x": 8}], "log_time": 7,
        });
        shape.include(&schema.given(&given).unwrap());
        let columns = Columns::of(&shape, 3).unwrap();
        let expected = "recording.log_time publish_time a.x short[0] long bounded[0] bounded[1] points[0].x points[1].x none \
                        log_time";
        assert_eq!(columns.names.join(" "), expected);
        let short = schema.given(&serde_json::json!({"points": [{"x": 1}]})).unwrap();
        for (message, expected) in [
            (schema.given(&given).unwrap(), "1,2,5,NaN,\"[1,2,3,4]\",,,9,8,[],7"),
            (short, "1,2,0,,[],,,1,,[],0"),
        ] {
            let folder = tempfile::tempdir().unwrap();
            let path = folder.path().join("t.csv");
            let mut table = CsvTable::create(&path, columns.clone(), 1 << 10).unwrap();
            table.row([1, 2], &message).unwrap();
            table.finish().unwrap();
            assert_eq!(std::fs::read_to_string(path).unwrap().lines().nth(1).unwrap(), expected);
        }
    }

    #[test]
    fn a_type_with_very_many_fields_is_refused() {
        let chain: String = (1..30).map(|n| format!("====\nMSG: p/T{n}\nT{0} a\nT{0} b\n", n + 1)).collect();
        let schema =
            Schema::parse("p/msg/T0", &format!("T1 a\nT1 b\n{chain}====\nMSG: p/T30\nint8 a\n")).unwrap();
        assert_eq!(Shape::of(schema.root(), 3), None);
    }
}
