//! Types of ROS 2 as types of Parquet.

use grainlab_any_message::{Element, FieldType, Length, Primitive};
use parquet::basic::{LogicalType, Repetition, TimeUnit, Type as Physical};
use parquet::errors::ParquetError;
use parquet::schema::types::{Type, TypePtr};
use std::sync::Arc;

/// Type of a column.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Kind {
    /// ns since 1970.
    Time,
    /// The type of a field: a number, yes or no, a text, a message (struct), or an array of them (list). `uint8[]` is
    /// bytes.
    Field(FieldType),
}

/// Column of a table.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Column {
    /// In the header.
    pub name: String,
    /// Type of its values.
    pub kind: Kind,
}

/// Fields of a type and of the messages in it.
const MOST: usize = 20_000;

/// The type of a column; `None` for a message without fields.
pub(super) fn column(column: &Column, fields: &mut usize) -> Result<Option<TypePtr>, ParquetError> {
    match &column.kind {
        Kind::Time => {
            let logical = Some(LogicalType::timestamp(true, TimeUnit::NANOS));
            leaf(&column.name, Physical::INT64, logical, true).map(Some)
        }
        Kind::Field(kind) => field(&column.name, kind, true, fields),
    }
}

/// True for a column of texts.
pub(super) fn is_text(kind: &Type) -> bool {
    kind.is_primitive() && kind.get_basic_info().logical_type_ref() == Some(&LogicalType::String)
}

fn field(
    name: &str,
    kind: &FieldType,
    is_optional: bool,
    fields: &mut usize,
) -> Result<Option<TypePtr>, ParquetError> {
    *fields += 1;
    if *fields > MOST {
        return Err(ParquetError::General(format!(
            "a message has more than {MOST} columns: use --format json"
        )));
    }
    if kind.length == Length::One {
        return element(name, &kind.element, is_optional, fields);
    }
    if kind.element == Element::Primitive(Primitive::U8) && kind.length == Length::Any(None) {
        return leaf(name, Physical::BYTE_ARRAY, None, is_optional).map(Some);
    }
    let Some(item) = element("element", &kind.element, false, fields)? else { return Ok(None) };
    let list = group("list", vec![item], Repetition::REPEATED, None)?;
    group(name, vec![list], Repetition::REQUIRED, Some(LogicalType::List)).map(Some)
}

fn element(
    name: &str,
    element: &Element,
    is_optional: bool,
    fields: &mut usize,
) -> Result<Option<TypePtr>, ParquetError> {
    match element {
        Element::Primitive(primitive) => {
            let (physical, logical) = number(*primitive);
            leaf(name, physical, logical, is_optional).map(Some)
        }
        Element::String(_) | Element::WString(_) => {
            leaf(name, Physical::BYTE_ARRAY, Some(LogicalType::String), is_optional).map(Some)
        }
        Element::Message(message) => {
            let types = message.fields.iter().map(|f| field(&f.name, &f.kind, false, fields));
            let types: Vec<TypePtr> = types.filter_map(Result::transpose).collect::<Result<_, _>>()?;
            if types.is_empty() {
                return Ok(None);
            }
            group(name, types, Repetition::REQUIRED, None).map(Some)
        }
    }
}

fn group(
    name: &str,
    fields: Vec<TypePtr>,
    repetition: Repetition,
    logical: Option<LogicalType>,
) -> Result<TypePtr, ParquetError> {
    let group = Type::group_type_builder(name).with_fields(fields).with_repetition(repetition);
    group.with_logical_type(logical).build().map(Arc::new)
}

fn leaf(
    name: &str,
    physical: Physical,
    logical: Option<LogicalType>,
    is_optional: bool,
) -> Result<TypePtr, ParquetError> {
    let repetition = if is_optional { Repetition::OPTIONAL } else { Repetition::REQUIRED };
    let leaf = Type::primitive_type_builder(name, physical).with_repetition(repetition);
    leaf.with_logical_type(logical).build().map(Arc::new)
}

fn number(primitive: Primitive) -> (Physical, Option<LogicalType>) {
    let integer = |bits: i8, signed: bool| Some(LogicalType::integer(bits, signed));
    match primitive {
        Primitive::Bool => (Physical::BOOLEAN, None),
        Primitive::I8 => (Physical::INT32, integer(8, true)),
        Primitive::U8 => (Physical::INT32, integer(8, false)),
        Primitive::I16 => (Physical::INT32, integer(16, true)),
        Primitive::U16 => (Physical::INT32, integer(16, false)),
        Primitive::I32 => (Physical::INT32, None),
        Primitive::U32 => (Physical::INT32, integer(32, false)),
        Primitive::I64 => (Physical::INT64, None),
        Primitive::U64 => (Physical::INT64, integer(64, false)),
        Primitive::F32 => (Physical::FLOAT, None),
        Primitive::F64 => (Physical::DOUBLE, None),
    }
}
