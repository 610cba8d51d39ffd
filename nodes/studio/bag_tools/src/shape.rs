//! Fields, and the greatest length of each array.

use grainlab_any_message::{Array, Element, FieldType, Length, Message, MessageType, Value};

/// The first columns, times of the recording; with `recording.` in front as long as a field has the name.
pub(crate) fn time_columns(is_field: impl Fn(&str) -> bool) -> [String; 2] {
    ["log_time", "publish_time"].map(|time| {
        let mut name = time.to_owned();
        while is_field(&name) {
            name.insert_str(0, "recording.");
        }
        name
    })
}

#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Shape {
    /// A number, yes or no, or a text.
    One,
    Message(Vec<(String, Shape)>),
    /// An array whose type or messages have at most so many values.
    Array(usize, Box<Shape>),
}

pub(crate) const MOST_COLUMNS: usize = 20_000;

impl Shape {
    /// The shape of a type, before any message is seen; `None` if it has more than [`MOST_COLUMNS`] fields. Arrays with a bound
    /// have their bound, if it is at most `widest`.
    pub(crate) fn of(kind: &MessageType, widest: usize) -> Option<Self> {
        Self::message(kind, widest, &mut 0)
    }

    fn message(kind: &MessageType, widest: usize, fields: &mut usize) -> Option<Self> {
        let mut shapes = Vec::with_capacity(kind.fields.len());
        for field in &kind.fields {
            *fields += 1;
            if *fields > MOST_COLUMNS {
                return None;
            }
            shapes.push((field.name.clone(), Self::field(&field.kind, widest, fields)?));
        }
        Some(Self::Message(shapes))
    }

    fn field(kind: &FieldType, widest: usize, fields: &mut usize) -> Option<Self> {
        let one = match &kind.element {
            Element::Primitive(_) | Element::String(_) | Element::WString(_) => Self::One,
            Element::Message(inner) => Self::message(inner, widest, fields)?,
        };
        let length = match kind.length {
            Length::One => return Some(one),
            Length::Fixed(n) => n as usize,
            Length::Any(bound) => bound.map_or(0, |n| n as usize),
        };
        let is_bound = matches!(kind.length, Length::Any(_));
        Some(Self::Array(if is_bound && length > widest { 0 } else { length }, Box::new(one)))
    }

    /// Increases the lengths of arrays to those of a message.
    pub(crate) fn include(&mut self, message: &Message) {
        if let Self::Message(shapes) = self {
            for ((_, shape), value) in shapes.iter_mut().zip(&message.values) {
                match value {
                    Value::Message(inner) => shape.include(inner),
                    Value::Array(array) => shape.include_array(array),
                    _ => {}
                }
            }
        }
    }

    fn include_array(&mut self, array: &Array) {
        if let Self::Array(longest, inner) = self {
            *longest = array.len().max(*longest);
            if let Array::Message(messages) = array {
                messages.iter().for_each(|message| inner.include(message));
            }
        }
    }
}
