//! From bytes to values.

use std::borrow::Cow;
use std::sync::Arc;

use crate::cursor::Cursor;
use crate::schema::Schema;
use crate::types::{Element, FieldType, Length, MessageType};
use crate::value::{Array, Message, Value};

/// Memory of a decoded message per byte of it, and for any message, bytes.
const PER_BYTE: usize = 256;
const ALWAYS: usize = 64 << 10;

/// RTPS pads a payload to four bytes.
const PADDING: usize = 3;

/// Why bytes are not a message of the schema.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{type_name}: {problem}")]
pub struct DecodeError {
    /// Name of the type.
    pub type_name: String,
    /// Description of the fault, beginning with the name of the field if it is of one.
    pub problem: String,
}

impl Schema {
    /// Decodes a message: CDR (XCDR1), little or big endian, with its encapsulation header of four bytes. The memory of the
    /// values is at most 256 times the bytes plus 64 KiB, whatever they and the schema state.
    ///
    /// # Errors
    /// See [`DecodeError`].
    pub fn decode(&self, bytes: &[u8]) -> Result<Message, DecodeError> {
        self.decode_counted(bytes).map(|(message, _)| message)
    }

    /// The message, and the number of its texts that are not valid: U+FFFD stands in them for what is not.
    ///
    /// # Errors
    /// See [`DecodeError`].
    pub fn decode_counted(&self, bytes: &[u8]) -> Result<(Message, u64), DecodeError> {
        let fault = |problem: String| DecodeError { type_name: self.root().name.clone(), problem };
        let length = bytes.len();
        let Some((header, body)) = bytes.split_at_checked(4) else {
            return Err(fault(format!("{length} bytes are too few for a CDR header of 4")));
        };
        // Bytes 2 and 3 are options: some writers store the number of padding bytes there.
        let found = [header[0], header[1]];
        let big_endian = match found {
            [0, 0] => true,
            [0, 1] => false,
            _ => {
                let plain = "[00, 01] little endian or [00, 00] big endian";
                return Err(fault(format!("encapsulation {found:02x?} is not plain CDR ({plain})")));
            }
        };
        let mut decoder = Decoder {
            cursor: Cursor::new(body, big_endian),
            budget: length.saturating_mul(PER_BYTE).saturating_add(ALWAYS),
            field: String::new(),
            invalid: 0,
        };
        let message = decoder.message(self.root());
        let message = message.map_err(|problem| {
            // A type without fields is one byte.
            let what = if decoder.field.is_empty() { "the message" } else { &decoder.field };
            fault(format!("{what} {problem}"))
        })?;
        match decoder.cursor.left() {
            0..=PADDING => Ok((message, decoder.invalid)),
            extra => Err(fault(format!(
                "{extra} bytes follow the message (at most {PADDING} of padding may; another type?)"
            ))),
        }
    }
}

struct Decoder<'a> {
    cursor: Cursor<'a>,
    /// Memory that may still be allocated, bytes.
    budget: usize,
    /// The field with an error; set on the way back.
    field: String,
    /// Texts that are not valid.
    invalid: u64,
}

impl Decoder<'_> {
    fn spend(&mut self, count: usize, size: usize) -> Result<(), String> {
        let left = count.checked_mul(size).and_then(|cost| self.budget.checked_sub(cost));
        let expands = || format!("would take the memory to more than {PER_BYTE} times the bytes");
        self.budget = left.ok_or_else(expands)?;
        Ok(())
    }

    fn message(&mut self, kind: &Arc<MessageType>) -> Result<Message, String> {
        self.spend(kind.fields.len(), size_of::<Value>())?;
        let mut values = Vec::with_capacity(kind.fields.len());
        if kind.fields.is_empty() {
            self.cursor.one::<u8>()?;
        }
        for field in &kind.fields {
            let value = self.value(&field.kind);
            values.push(value.inspect_err(|_| {
                let inner = std::mem::take(&mut self.field);
                let dot = if inner.is_empty() { "" } else { "." };
                self.field = format!("{}{dot}{inner}", field.name);
            })?);
        }
        Ok(Message { kind: kind.clone(), values })
    }

    fn value(&mut self, kind: &FieldType) -> Result<Value, String> {
        let length = match kind.length {
            Length::One => return self.one(&kind.element),
            Length::Fixed(length) => length,
            Length::Any(bound) => {
                let length = self.cursor.one::<u32>()?;
                within(length, bound)?;
                length
            }
        };
        Ok(Value::Array(self.array(&kind.element, length as usize)?))
    }

    fn one(&mut self, element: &Element) -> Result<Value, String> {
        match element {
            Element::Message(kind) => self.message(kind).map(Value::Message),
            other => self.array(other, 1)?.get(0).ok_or_else(|| "has no value".to_owned()),
        }
    }

    fn array(&mut self, element: &Element, length: usize) -> Result<Array, String> {
        // Nothing is reserved for values that cannot be there.
        self.cursor.require(element.least().saturating_mul(length as u64))?;
        if let Element::Primitive(primitive) = element {
            self.spend(length, primitive.size())?;
        }
        Ok(match element {
            Element::Primitive(primitive) => Array::read(*primitive, &mut self.cursor, length)?,
            Element::String(bound) => Array::Text(self.each(length, |d| d.string(*bound))?),
            Element::WString(bound) => Array::Text(self.each(length, |d| d.wide_string(*bound))?),
            Element::Message(kind) => Array::Message(self.each(length, |d| d.message(kind))?),
        })
    }

    fn each<T>(
        &mut self,
        length: usize,
        mut read: impl FnMut(&mut Self) -> Result<T, String>,
    ) -> Result<Vec<T>, String> {
        self.spend(length, size_of::<T>())?;
        let mut values = Vec::with_capacity(length);
        for _ in 0..length {
            values.push(read(self)?);
        }
        Ok(values)
    }

    /// Length with the final zero, and the bytes.
    fn string(&mut self, bound: Option<u32>) -> Result<String, String> {
        let length = self.cursor.one::<u32>()?;
        let bytes = self.cursor.bytes(length as usize)?;
        let bytes = bytes.strip_suffix(&[0]).unwrap_or(bytes);
        within(bytes.len() as u32, bound)?;
        // A byte that is not UTF-8 becomes three.
        self.spend(bytes.len(), 3)?;
        let text = String::from_utf8_lossy(bytes);
        self.invalid += u64::from(matches!(text, Cow::Owned(_)));
        Ok(text.into_owned())
    }

    /// Number of UTF-16 units, and each unit as four bytes, without a final zero: as rmw_fastrtps and rmw_cyclonedds.
    fn wide_string(&mut self, bound: Option<u32>) -> Result<String, String> {
        let length = self.cursor.one::<u32>()?;
        within(length, bound)?;
        self.cursor.require(u64::from(length) * 4)?;
        self.spend(length as usize, 3 + size_of::<u16>() + size_of::<u32>())?;
        let units: Vec<u16> =
            self.cursor.many::<u32>(length as usize)?.into_iter().map(|c| c as u16).collect();
        self.invalid += u64::from(String::from_utf16(&units).is_err());
        Ok(String::from_utf16_lossy(&units))
    }
}

fn within(length: u32, bound: Option<u32>) -> Result<(), String> {
    match bound {
        Some(bound) if length > bound => {
            Err(format!("has {length} entries, and its type allows at most {bound}"))
        }
        _ => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texts_that_are_not_unicode_are_counted() {
        let schema = Schema::parse("p/msg/T", "string a\nwstring b\n").unwrap();
        let of = |a: [u8; 2], b: u32| {
            let a = [&[0, 1, 0, 0, 3, 0, 0, 0], &a[..], &[0, 0]].concat();
            let message = [a, 1u32.to_le_bytes().into(), b.to_le_bytes().into()].concat();
            schema.decode_counted(&message).unwrap().1
        };
        assert_eq!([of(*b"hi", 104), of([0xff, 0xfe], 104), of([0xff, 0xfe], 0xd800)], [0, 1, 2]);
    }
}
