//! The types of a schema.

use std::fmt;
use std::sync::Arc;

/// A message type: its fields in order.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct MessageType {
    /// Package and name, `std_msgs/Header`.
    pub name: String,
    /// Fields in the order of the file.
    pub fields: Vec<Field>,
    /// Constants in the order of the file.
    pub constants: Vec<Constant>,
    /// Fewest bytes of a message in CDR, without padding.
    pub(crate) least: u64,
    /// Levels of nested messages in it, at least 1.
    pub(crate) depth: usize,
}

/// A field of a message.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Field {
    /// Name in the message file.
    pub name: String,
    /// Type of the value.
    pub kind: FieldType,
    /// The default in the schema, as its text.
    pub default: Option<String>,
}

/// A constant of a message type. It is not part of a message.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Constant {
    /// Name in the message file.
    pub name: String,
    /// Type of the value.
    pub kind: Element,
    /// Value, as text of the file.
    pub value: String,
}

/// The type of a field: what it has, and how many.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FieldType {
    /// Type of one value.
    pub element: Element,
    /// Number of values.
    pub length: Length,
}

/// Number of values of a field.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Length {
    /// One, not an array.
    One,
    /// An array of so many.
    Fixed(u32),
    /// An array of any length, up to the bound if there is one.
    Any(Option<u32>),
}

/// The type of one value.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Element {
    /// A number, a flag or a byte.
    Primitive(Primitive),
    /// A text of at most so many bytes.
    String(Option<u32>),
    /// A text of at most so many UTF-16 units.
    WString(Option<u32>),
    /// Message of another type.
    Message(Arc<MessageType>),
}

/// Passes the primitives to a macro: for each its variant, its type in Rust, and its name in a message file.
macro_rules! with_primitives {
    ($take:ident) => {
        $take! {
            Bool bool "bool", I8 i8 "int8", U8 u8 "uint8", I16 i16 "int16", U16 u16 "uint16", I32 i32 "int32",
            U32 u32 "uint32", I64 i64 "int64", U64 u64 "uint64", F32 f32 "float32", F64 f64 "float64"
        }
    };
}
pub(crate) use with_primitives;

macro_rules! primitives {
    ($($kind:ident $rust:ident $name:literal),*) => {
        /// Types of fixed size.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub enum Primitive {
            $(
                #[doc = concat!("ROS type `", $name, "`.")]
                $kind,
            )*
        }

        /// Each primitive with its name in a message file and its bytes, in the order of the list.
        const PRIMITIVES: &[(Primitive, &str, usize)] =
            &[$((Primitive::$kind, $name, size_of::<$rust>())),*];
    };
}
with_primitives!(primitives);

impl Primitive {
    /// The type of this name in a message file. `char` is `uint8` in ROS 2, and so is `byte`.
    pub(crate) fn by_name(name: &str) -> Option<Self> {
        let name = if ["byte", "char"].contains(&name) { "uint8" } else { name };
        PRIMITIVES.iter().find(|(_, known, _)| *known == name).map(|(primitive, ..)| *primitive)
    }

    /// Bytes of a value, which is also its alignment.
    pub const fn size(self) -> usize {
        PRIMITIVES[self as usize].2
    }
}

impl Element {
    /// Fewest bytes of a value in CDR, without padding.
    pub(crate) fn least(&self) -> u64 {
        match self {
            Self::Primitive(primitive) => primitive.size() as u64,
            Self::String(_) | Self::WString(_) => 4,
            Self::Message(inner) => inner.least,
        }
    }
}

impl FieldType {
    pub(crate) fn least(&self) -> u64 {
        match self.length {
            Length::One => self.element.least(),
            Length::Fixed(n) => self.element.least().saturating_mul(u64::from(n)),
            Length::Any(_) => 4,
        }
    }
}

/// The type as in a message file.
impl fmt::Display for FieldType {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let bound = |bound: &Option<u32>| bound.map_or_else(String::new, |n| format!("<={n}"));
        match &self.element {
            Element::Primitive(primitive) => f.write_str(PRIMITIVES[*primitive as usize].1)?,
            Element::String(most) => write!(f, "string{}", bound(most))?,
            Element::WString(most) => write!(f, "wstring{}", bound(most))?,
            Element::Message(kind) => f.write_str(&kind.name)?,
        }
        match self.length {
            Length::One => Ok(()),
            Length::Fixed(n) => write!(f, "[{n}]"),
            Length::Any(most) => write!(f, "[{}]", bound(&most)),
        }
    }
}
