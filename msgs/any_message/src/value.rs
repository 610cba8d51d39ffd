//! Values of decoded messages.

use std::sync::Arc;

use crate::cursor::{Cursor, put};
use crate::types::{Element, MessageType, Primitive, with_primitives};

/// A decoded message: one value for each field of its type.
#[derive(Clone, Debug, PartialEq)]
pub struct Message {
    /// Type of the message.
    pub kind: Arc<MessageType>,
    /// Values, in the order of the fields.
    pub values: Vec<Value>,
}

impl Message {
    /// The fields, each with its name.
    pub fn fields(&self) -> impl Iterator<Item = (&str, &Value)> {
        self.kind.fields.iter().map(|f| f.name.as_str()).zip(&self.values)
    }
}

macro_rules! values {
    ($($kind:ident $rust:ident $name:literal),*) => {
        /// The value of a field.
        #[derive(Clone, Debug, PartialEq)]
        #[allow(missing_docs, reason = "the variants are the types of ROS 2")]
        pub enum Value {
            $($kind($rust),)*
            /// A `string` or `wstring`; parts that are not Unicode are replaced by U+FFFD.
            Text(String),
            Message(Message),
            Array(Array),
        }

        /// The values of a field that is an array.
        #[derive(Clone, Debug, PartialEq)]
        #[allow(missing_docs, reason = "the variants are the types of ROS 2")]
        pub enum Array {
            $($kind(Vec<$rust>),)*
            Text(Vec<String>),
            Message(Vec<Message>),
        }

        impl Array {
            /// Number of values.
            pub fn len(&self) -> usize {
                match self {
                    $(Self::$kind(v) => v.len(),)*
                    Self::Text(v) => v.len(),
                    Self::Message(v) => v.len(),
                }
            }

            /// The value at this place, if there is one.
            pub fn get(&self, at: usize) -> Option<Value> {
                Some(match self {
                    $(Self::$kind(v) => Value::$kind(*v.get(at)?),)*
                    Self::Text(v) => Value::Text(v.get(at)?.clone()),
                    Self::Message(v) => Value::Message(v.get(at)?.clone()),
                })
            }

            pub(crate) fn read(kind: Primitive, from: &mut Cursor<'_>, length: usize) -> Result<Self, String> {
                Ok(match kind {
                    $(Primitive::$kind => Self::$kind(from.many(length)?),)*
                })
            }

            /// Creates an array of primitives from values that are all of this kind.
            pub(crate) fn of(kind: Primitive, all: Vec<Value>) -> Self {
                match kind {
                    $(Primitive::$kind => Self::$kind(
                        all.into_iter().filter_map(|v| if let Value::$kind(v) = v { Some(v) } else { None }).collect(),
                    ),)*
                }
            }

            pub(crate) fn write(&self, to: &mut Vec<u8>) {
                match self {
                    $(Self::$kind(all) => put(all, to),)*
                    Self::Text(_) | Self::Message(_) => {}
                }
            }
        }

        impl Value {
            pub(crate) fn write(&self, to: &mut Vec<u8>) {
                match self {
                    $(Self::$kind(v) => put(&[*v], to),)*
                    Self::Text(_) | Self::Message(_) | Self::Array(_) => {}
                }
            }
        }
    };
}
with_primitives!(values);

impl Array {
    pub(crate) fn empty(element: &Element) -> Self {
        match element {
            Element::Primitive(kind) => Self::of(*kind, Vec::new()),
            Element::String(_) | Element::WString(_) => Self::Text(Vec::new()),
            Element::Message(_) => Self::Message(Vec::new()),
        }
    }

    /// True if it has no values.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}
