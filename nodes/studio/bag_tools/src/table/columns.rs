//! Columns of a shape, and the cells of a message.

use super::shape::{MOST_COLUMNS, Shape};
use grainlab_any_message::{Array, Message, Value};
use grainlab_parquet::{Cell, Column, Kind};

/// The columns of a table, and the shape that fills them.
#[derive(Clone, Debug)]
pub(crate) struct Columns {
    pub(crate) list: Vec<Column>,
    shape: Shape,
    /// Longest array that is written as columns.
    widest: usize,
}

impl Columns {
    /// `log_time`, `publish_time`, and the fields: `stress.xx`; arrays of at most `widest` values as `rate[0]` and so on, longer
    /// ones as JSON. `None` if there are more than [`MOST_COLUMNS`].
    pub(crate) fn of(shape: &Shape, widest: usize) -> Option<Self> {
        let mut list = Vec::new();
        name_columns(shape, "", widest, &mut list)?;
        let times = ["log_time", "publish_time"].map(|time| {
            let taken = list.iter().any(|column| column.name == time);
            let name = if taken { format!("recording.{time}") } else { time.to_owned() };
            Column { name, kind: Kind::Time }
        });
        list.splice(0..0, times);
        Some(Self { list, shape: shape.clone(), widest })
    }

    /// The cells of a message, in the order of the columns.
    pub(crate) fn row(&self, log_time: u64, publish_time: u64, message: &Message) -> Vec<Cell> {
        let mut row = Vec::with_capacity(self.list.len());
        row.extend([Cell::Unsigned(log_time), Cell::Unsigned(publish_time)]);
        self.fill_fields(&self.shape, Some(message), &mut row);
        row
    }

    fn fill(&self, shape: &Shape, value: Option<&Value>, row: &mut Vec<Cell>) {
        match (shape, value) {
            (Shape::One(_) | Shape::Text, value) => row.push(value.map_or(Cell::Missing, cell)),
            (Shape::Array(longest, _), value) if is_json(*longest, self.widest) => row.push(match value {
                Some(Value::Array(array)) => Cell::Text(array.json()),
                _ => Cell::Missing,
            }),
            (Shape::Message(_), Some(Value::Message(message))) => {
                self.fill_fields(shape, Some(message), row);
            }
            (Shape::Message(_), _) => self.fill_fields(shape, None, row),
            (Shape::Array(longest, item), Some(Value::Array(Array::Message(messages)))) => {
                (0..*longest).for_each(|n| self.fill_fields(item, messages.get(n), row));
            }
            (Shape::Array(longest, item), Some(Value::Array(array))) => {
                (0..*longest).for_each(|n| self.fill(item, array.get(n).as_ref(), row));
            }
            (Shape::Array(longest, item), _) => (0..*longest).for_each(|_| self.fill(item, None, row)),
        }
    }

    fn fill_fields(&self, shape: &Shape, message: Option<&Message>, row: &mut Vec<Cell>) {
        if let Shape::Message(fields) = shape {
            for (n, (_, field)) in fields.iter().enumerate() {
                self.fill(field, message.and_then(|m| m.values.get(n)), row);
            }
        }
    }
}

/// True for an array that is one column, as JSON.
fn is_json(longest: usize, widest: usize) -> bool {
    longest == 0 || longest > widest
}

/// Adds the columns of a shape.
fn name_columns(shape: &Shape, name: &str, widest: usize, list: &mut Vec<Column>) -> Option<()> {
    if list.len() >= MOST_COLUMNS {
        return None;
    }
    let mut one = |kind| list.push(Column { name: name.to_owned(), kind });
    match shape {
        Shape::One(primitive) => one(Kind::One(*primitive)),
        Shape::Text => one(Kind::Text),
        Shape::Array(longest, _) if is_json(*longest, widest) => one(Kind::Text),
        Shape::Array(longest, inner) => {
            (0..*longest).try_for_each(|n| name_columns(inner, &format!("{name}[{n}]"), widest, list))?;
        }
        Shape::Message(fields) => {
            let dot = if name.is_empty() { "" } else { "." };
            for (field, shape) in fields {
                name_columns(shape, &format!("{name}{dot}{field}"), widest, list)?;
            }
        }
    }
    Some(())
}

fn cell(value: &Value) -> Cell {
    match value {
        Value::Bool(v) => Cell::Bool(*v),
        Value::I8(v) => Cell::Signed((*v).into()),
        Value::I16(v) => Cell::Signed((*v).into()),
        Value::I32(v) => Cell::Signed((*v).into()),
        Value::I64(v) => Cell::Signed(*v),
        Value::U8(v) => Cell::Unsigned((*v).into()),
        Value::U16(v) => Cell::Unsigned((*v).into()),
        Value::U32(v) => Cell::Unsigned((*v).into()),
        Value::U64(v) => Cell::Unsigned(*v),
        Value::F32(v) => Cell::Single(*v),
        Value::F64(v) => Cell::Double(*v),
        Value::Text(v) => Cell::Text(v.clone()),
        Value::Message(_) | Value::Array(_) => Cell::Missing,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use grainlab_any_message::Schema;

    #[test]
    fn short_arrays_are_columns_and_long_ones_are_json() {
        let text = "P a\nfloat32[] short\nint8[] long\nint8[<=2] bounded\nP[<=2] points\nstring[] none\n====\nMSG: p/P\nint16 x\n";
        let schema = Schema::parse("p/msg/T", text).unwrap();
        let mut shape = Shape::of(schema.root(), 3).unwrap();
        let bytes = [
            &[0, 1, 0, 0, 5, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0x3f, 4, 0, 0, 0, 1, 2, 3, 4, 0, 0, 0, 0][..],
            &[1, 0, 0, 0, 9, 0, 0, 0, 0, 0, 0, 0],
        ]
        .concat();
        let message = schema.decode(&bytes).unwrap();
        shape.include(&message);
        let columns = Columns::of(&shape, 3).unwrap();
        let names: Vec<&str> = columns.list.iter().map(|c| c.name.as_str()).collect();
        let expected = [
            "log_time",
            "publish_time",
            "a.x",
            "short[0]",
            "long",
            "bounded[0]",
            "bounded[1]",
            "points[0].x",
            "points[1].x",
            "none",
        ];
        assert_eq!(names, expected);
        let row = columns.row(1, 2, &message);
        assert_eq!(row[2..5], [Cell::Signed(5), Cell::Single(0.5), Cell::Text("[1,2,3,4]".into())]);
        assert_eq!(
            row[5..],
            [Cell::Missing, Cell::Missing, Cell::Signed(9), Cell::Missing, Cell::Text("[]".into())]
        );
    }

    #[test]
    fn a_type_with_very_many_fields_is_refused() {
        let chain: String = (1..30).map(|n| format!("====\nMSG: p/T{n}\nT{0} a\nT{0} b\n", n + 1)).collect();
        let schema =
            Schema::parse("p/msg/T0", &format!("T1 a\nT1 b\n{chain}====\nMSG: p/T30\nint8 a\n")).unwrap();
        assert_eq!(Shape::of(schema.root(), 3), None);
    }
}
