//! From values to bytes.

use crate::types::{Element, Length};
use crate::value::{Array, Message, Value};

/// Plain CDR, little endian.
const HEADER: [u8; 4] = [0, 1, 0, 0];

impl Message {
    /// The message as CDR (XCDR1), little endian, with its encapsulation header: the inverse of
    /// [`Schema::decode`](crate::Schema::decode), except for parts of a text that are not Unicode.
    pub fn encode(&self) -> Vec<u8> {
        let mut writer = Writer { bytes: HEADER.to_vec() };
        writer.message(self);
        writer.bytes
    }
}

struct Writer {
    bytes: Vec<u8>,
}

impl Writer {
    /// A number, aligned to its size from the end of the header.
    fn put<const N: usize>(&mut self, bytes: [u8; N]) {
        let at = self.bytes.len() - HEADER.len();
        self.bytes.resize(HEADER.len() + at.next_multiple_of(N), 0);
        self.bytes.extend(bytes);
    }

    fn length(&mut self, length: usize) {
        self.put(u32::try_from(length).unwrap_or(u32::MAX).to_le_bytes());
    }

    fn message(&mut self, message: &Message) {
        if message.values.is_empty() {
            self.put([0]);
        }
        for (field, value) in message.kind.fields.iter().zip(&message.values) {
            match value {
                Value::Array(array) => {
                    if matches!(field.kind.length, Length::Any(_)) {
                        self.length(array.len());
                    }
                    self.array(array, &field.kind.element);
                }
                one => self.one(one, &field.kind.element),
            }
        }
    }

    fn one(&mut self, value: &Value, element: &Element) {
        match value {
            Value::Bool(v) => self.put([u8::from(*v)]),
            Value::I8(v) => self.put(v.to_le_bytes()),
            Value::U8(v) => self.put(v.to_le_bytes()),
            Value::I16(v) => self.put(v.to_le_bytes()),
            Value::U16(v) => self.put(v.to_le_bytes()),
            Value::I32(v) => self.put(v.to_le_bytes()),
            Value::U32(v) => self.put(v.to_le_bytes()),
            Value::I64(v) => self.put(v.to_le_bytes()),
            Value::U64(v) => self.put(v.to_le_bytes()),
            Value::F32(v) => self.put(v.to_le_bytes()),
            Value::F64(v) => self.put(v.to_le_bytes()),
            Value::Text(text) => self.text(text, element),
            Value::Message(message) => self.message(message),
            Value::Array(array) => self.array(array, element),
        }
    }

    fn array(&mut self, array: &Array, element: &Element) {
        match array {
            Array::U8(all) => self.bytes.extend(all),
            Array::F64(all) => all.iter().for_each(|v| self.put(v.to_le_bytes())),
            Array::Text(all) => all.iter().for_each(|text| self.text(text, element)),
            Array::Message(all) => all.iter().for_each(|message| self.message(message)),
            numbers => {
                (0..numbers.len()).filter_map(|at| numbers.get(at)).for_each(|v| self.one(&v, element));
            }
        }
    }

    /// A `string` has its length with the final zero; a `wstring` the number of its UTF-16 units, each as four bytes.
    fn text(&mut self, text: &str, element: &Element) {
        if matches!(element, Element::WString(_)) {
            let units: Vec<u16> = text.encode_utf16().collect();
            self.length(units.len());
            units.into_iter().for_each(|unit| self.put(u32::from(unit).to_le_bytes()));
        } else {
            self.length(text.len() + 1);
            self.bytes.extend(text.as_bytes());
            self.bytes.push(0);
        }
    }
}
