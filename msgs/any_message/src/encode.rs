//! From values to bytes.

use crate::cursor::{HEADER, put};
use crate::types::{Element, Length};
use crate::value::{Array, Message, Value};

impl Message {
    /// The message as CDR (XCDR1), little endian, with its encapsulation header: the inverse of
    /// [`Schema::decode`](crate::Schema::decode), except for parts of a text that are not Unicode.
    pub fn encode(&self) -> Vec<u8> {
        let mut bytes = HEADER.to_vec();
        message(self, &mut bytes);
        bytes
    }
}

fn message(message: &Message, to: &mut Vec<u8>) {
    if message.values.is_empty() {
        to.push(0);
    }
    for (field, value) in message.kind.fields.iter().zip(&message.values) {
        let element = &field.kind.element;
        match value {
            Value::Array(array) => {
                if matches!(field.kind.length, Length::Any(_)) {
                    length(array.len(), to);
                }
                match array {
                    Array::Text(all) => all.iter().for_each(|one| text(one, element, to)),
                    Array::Message(all) => all.iter().for_each(|one| self::message(one, to)),
                    numbers => numbers.write(to),
                }
            }
            Value::Text(one) => text(one, element, to),
            Value::Message(one) => self::message(one, to),
            number => number.write(to),
        }
    }
}

fn length(length: usize, to: &mut Vec<u8>) {
    put(&[u32::try_from(length).unwrap_or(u32::MAX)], to);
}

/// A `string` has its length with the final zero; a `wstring` the number of its UTF-16 units, each as four bytes.
fn text(text: &str, element: &Element, to: &mut Vec<u8>) {
    if matches!(element, Element::WString(_)) {
        let units: Vec<u32> = text.encode_utf16().map(u32::from).collect();
        length(units.len(), to);
        put(&units, to);
    } else {
        length(text.len() + 1, to);
        to.extend(text.as_bytes());
        to.push(0);
    }
}
