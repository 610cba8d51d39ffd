//! An array of a message as rows, as `explode` of pandas and Polars and `UNNEST` of SQL give it.

use std::sync::Arc;

use crate::types::{Element, Field, FieldType, Length, MessageType, Primitive};
use crate::value::{Array, Message, Value};

/// One row for each value of an array of a message: the other fields of the message, `index` (from 0), and the value. If the values
/// are messages, their fields are those of the row; a name that is taken gets that of the array in front, `estimates.k`, until it is free.
#[derive(Clone, Debug)]
pub struct Exploded {
    kind: Arc<MessageType>,
    /// Place of the array.
    place: usize,
}

impl Exploded {
    /// Rows for the array of this name; `None` if the type has no such array.
    pub fn of(kind: &MessageType, array: &str) -> Option<Self> {
        let place = kind.fields.iter().position(|f| f.name == array && f.kind.length != Length::One)?;
        let mut fields = kind.fields.clone();
        let given = fields.remove(place);
        let one = |element: Element| FieldType { element, length: Length::One };
        let index = Element::Primitive(Primitive::U32);
        let value = match given.kind.element {
            Element::Message(inner) => inner.fields.clone(),
            element => vec![Field { kind: one(element), ..given }],
        };
        for field in
            [Field { name: "index".into(), kind: one(index), default: None }].into_iter().chain(value)
        {
            let mut name = field.name;
            while fields.iter().any(|f| f.name == name) {
                name = format!("{array}.{name}");
            }
            fields.push(Field { name, ..field });
        }
        let (name, constants) = (kind.name.clone(), Vec::new());
        let kind = MessageType { name, fields, constants, least: kind.least, depth: kind.depth };
        Some(Self { kind: Arc::new(kind), place })
    }

    /// The type of the rows.
    pub fn kind(&self) -> &Arc<MessageType> {
        &self.kind
    }

    /// The rows of a message of the type; none if its array is empty.
    pub fn rows(&self, message: &Message) -> Vec<Message> {
        let mut others = message.values.clone();
        let Value::Array(array) = others.remove(self.place) else { return Vec::new() };
        let row = |n: usize| {
            let mut values = others.clone();
            values.push(Value::U32(n as u32));
            match &array {
                Array::Message(messages) => values.extend(messages[n].values.iter().cloned()),
                array => values.extend(array.get(n)),
            }
            Message { kind: self.kind.clone(), values }
        };
        (0..array.len()).map(row).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Schema, Shown};

    #[test]
    fn a_row_has_the_other_fields_the_index_and_those_of_the_value_under_free_names() {
        let text = "string name\nE[] parts\nint8[] many\n====\nMSG: p/E\nstring name\nint8 k\n";
        let schema = Schema::parse("p/msg/A", text).unwrap();
        let given = serde_json::json!({"name": "a", "parts": [{"name": "x", "k": 1}, {"k": 2}], "many": [7]});
        let message = schema.given(&given).unwrap();
        let rows = |array: &str| {
            let rows = Exploded::of(schema.root(), array).unwrap().rows(&message);
            rows.iter().map(|row| Shown::new(row).json()).collect::<Vec<_>>()
        };
        let parts = [
            r#"{"name":"a","many":[7],"index":0,"parts.name":"x","k":1}"#,
            r#"{"name":"a","many":[7],"index":1,"parts.name":"","k":2}"#,
        ];
        assert_eq!(rows("parts"), parts);
        assert!(rows("many")[0].ends_with(r#""index":0,"many":7}"#), "{:?}", rows("many"));
        let text = "uint8 index\nE[] parts\n====\nMSG: p/E\nuint8 index\n";
        let schema = Schema::parse("p/msg/A", text).unwrap();
        let kind = Exploded::of(schema.root(), "parts").unwrap().kind;
        let names: Vec<&str> = kind.fields.iter().map(|f| f.name.as_str()).collect();
        assert_eq!(names, ["index", "parts.index", "parts.parts.index"]);
        assert!(Exploded::of(schema.root(), "name").is_none());
        assert!(Exploded::of(schema.root(), "absent").is_none());
    }
}
