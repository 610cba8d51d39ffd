//! Values of decoded messages.

use std::sync::Arc;

use crate::types::MessageType;

/// A decoded message: one value for each field of its type.
#[derive(Clone, Debug, PartialEq)]
pub struct Message {
    /// Type of the message.
    pub kind: Arc<MessageType>,
    /// Values, in the order of the fields.
    pub values: Vec<Value>,
}

/// The value of a field.
#[derive(Clone, Debug, PartialEq)]
#[allow(missing_docs, reason = "the variants are the types of ROS 2")]
pub enum Value {
    Bool(bool),
    I8(i8),
    U8(u8),
    I16(i16),
    U16(u16),
    I32(i32),
    U32(u32),
    I64(i64),
    U64(u64),
    F32(f32),
    F64(f64),
    /// A `string` or `wstring`; parts that are not Unicode are replaced by U+FFFD.
    Text(String),
    Message(Message),
    Array(Array),
}

/// The values of a field that is an array.
#[derive(Clone, Debug, PartialEq)]
#[allow(missing_docs, reason = "the variants are the types of ROS 2")]
pub enum Array {
    Bool(Vec<bool>),
    I8(Vec<i8>),
    U8(Vec<u8>),
    I16(Vec<i16>),
    U16(Vec<u16>),
    I32(Vec<i32>),
    U32(Vec<u32>),
    I64(Vec<i64>),
    U64(Vec<u64>),
    F32(Vec<f32>),
    F64(Vec<f64>),
    Text(Vec<String>),
    Message(Vec<Message>),
}

impl Message {
    /// The fields, each with its name.
    pub fn fields(&self) -> impl Iterator<Item = (&str, &Value)> {
        self.kind.fields.iter().map(|f| f.name.as_str()).zip(&self.values)
    }
}

impl Array {
    /// Number of values.
    pub fn len(&self) -> usize {
        match self {
            Self::Bool(v) => v.len(),
            Self::I8(v) => v.len(),
            Self::U8(v) => v.len(),
            Self::I16(v) => v.len(),
            Self::U16(v) => v.len(),
            Self::I32(v) => v.len(),
            Self::U32(v) => v.len(),
            Self::I64(v) => v.len(),
            Self::U64(v) => v.len(),
            Self::F32(v) => v.len(),
            Self::F64(v) => v.len(),
            Self::Text(v) => v.len(),
            Self::Message(v) => v.len(),
        }
    }

    /// True if it has no values.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The value at this place, if there is one.
    pub fn get(&self, at: usize) -> Option<Value> {
        Some(match self {
            Self::Bool(v) => Value::Bool(*v.get(at)?),
            Self::I8(v) => Value::I8(*v.get(at)?),
            Self::U8(v) => Value::U8(*v.get(at)?),
            Self::I16(v) => Value::I16(*v.get(at)?),
            Self::U16(v) => Value::U16(*v.get(at)?),
            Self::I32(v) => Value::I32(*v.get(at)?),
            Self::U32(v) => Value::U32(*v.get(at)?),
            Self::I64(v) => Value::I64(*v.get(at)?),
            Self::U64(v) => Value::U64(*v.get(at)?),
            Self::F32(v) => Value::F32(*v.get(at)?),
            Self::F64(v) => Value::F64(*v.get(at)?),
            Self::Text(v) => Value::Text(v.get(at)?.clone()),
            Self::Message(v) => Value::Message(v.get(at)?.clone()),
        })
    }
}
