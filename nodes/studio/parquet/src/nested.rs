//! Values of nested columns with the levels of Dremel (Melnik et al. 2010): at which list a value begins anew, and how many lists and
//! optional values around it are there.

use grainlab_any_message::{Array, Message, Value};
use parquet::basic::{Repetition, Type as Physical};
use parquet::data_type::{
    BoolType, ByteArray, ByteArrayType, DataType, DoubleType, FloatType, Int32Type, Int64Type,
};
use parquet::errors::ParquetError;
use parquet::file::writer::SerializedColumnWriter;
use parquet::schema::types::Type;
use std::mem::take;

/// A column of a row group, as its type nests it.
#[derive(Clone, Debug)]
pub(super) enum Nested {
    Leaf(Leaf),
    Struct(Vec<(String, Self)>),
    /// The item, and the number of lists around it.
    List(Box<Self>, i16),
}

/// Values without the structs and lists around them.
#[derive(Clone, Debug)]
pub(super) struct Leaf {
    values: Values,
    definition: Vec<i16>,
    repetition: Vec<i16>,
    /// Level of definition of a value that is there.
    most: i16,
    /// True below a list.
    is_repeated: bool,
}

impl Nested {
    /// An empty column of this type, below so many lists and levels of definition.
    pub(super) fn of(kind: &Type, lists: i16, definition: i16) -> Self {
        let is_optional = kind.get_basic_info().repetition() == Repetition::OPTIONAL;
        if kind.is_primitive() {
            let most = definition + i16::from(is_optional);
            let (values, is_repeated) = (Values::of(kind.get_physical_type()), lists > 0);
            return Self::Leaf(Leaf {
                values,
                definition: Vec::new(),
                repetition: Vec::new(),
                most,
                is_repeated,
            });
        }
        if let [list] = kind.get_fields()
            && list.get_basic_info().repetition() == Repetition::REPEATED
        {
            return Self::List(
                Box::new(Self::of(&list.get_fields()[0], lists + 1, definition + 1)),
                lists + 1,
            );
        }
        let fields = kind.get_fields().iter();
        Self::Struct(fields.map(|f| (f.name().to_owned(), Self::of(f, lists, definition))).collect())
    }

    /// Adds a value, or null, at these levels; `size` grows by its bytes.
    pub(super) fn push(&mut self, value: Option<&Value>, repetition: i16, definition: i16, size: &mut usize) {
        match (self, value) {
            (Self::Leaf(leaf), value) => {
                *size += value.map_or(0, |value| leaf.values.one(value));
                leaf.level(repetition, if value.is_some() { leaf.most } else { definition }, size);
            }
            (Self::List(item, lists), Some(Value::Array(array))) if !array.is_empty() => {
                item.extend(array, [repetition, *lists], definition + 1, size);
            }
            (Self::List(item, _), _) => item.push(None, repetition, definition, size),
            (this, Some(Value::Message(message))) => this.message(message, repetition, definition, size),
            (Self::Struct(fields), _) => {
                fields.iter_mut().for_each(|(_, field)| field.push(None, repetition, definition, size));
            }
        }
    }

    fn message(&mut self, message: &Message, repetition: i16, definition: i16, size: &mut usize) {
        let Self::Struct(fields) = self else { return };
        // Fields without a column are left out of the struct.
        let mut values = message.fields();
        for (name, field) in fields {
            let value = values.find(|(of, _)| of == name).map(|(_, value)| value);
            field.push(value, repetition, definition, size);
        }
    }

    /// Adds the values of a list that is not empty, the first and the others at these levels of repetition.
    fn extend(&mut self, array: &Array, [first, next]: [i16; 2], definition: i16, size: &mut usize) {
        match (self, array) {
            (Self::Leaf(leaf), array) => {
                *size += leaf.values.many(array);
                let (most, count) = (leaf.most, array.len() - 1);
                leaf.level(first, most, size);
                leaf.definition.resize(leaf.definition.len() + count, most);
                leaf.repetition.resize(leaf.repetition.len() + count, next);
                *size += 4 * count;
            }
            (item, Array::Message(messages)) => {
                for (n, message) in messages.iter().enumerate() {
                    item.message(message, if n == 0 { first } else { next }, definition, size);
                }
            }
            _ => {}
        }
    }

    /// The leaves, in the order of the columns of the file.
    pub(super) fn leaves<'a>(&'a mut self, all: &mut Vec<&'a mut Leaf>) {
        match self {
            Self::Leaf(leaf) => all.push(leaf),
            Self::Struct(fields) => fields.iter_mut().for_each(|(_, field)| field.leaves(all)),
            Self::List(item, _) => item.leaves(all),
        }
    }
}

impl Leaf {
    fn level(&mut self, repetition: i16, definition: i16, size: &mut usize) {
        if self.most > 0 {
            self.definition.push(definition);
            *size += 2;
        }
        if self.is_repeated {
            self.repetition.push(repetition);
            *size += 2;
        }
    }

    /// Writes the column, and empties it.
    pub(super) fn write(&mut self, mut column: SerializedColumnWriter<'_>) -> Result<(), ParquetError> {
        let definition = (self.most > 0).then_some(&self.definition[..]);
        let repetition = self.is_repeated.then_some(&self.repetition[..]);
        let to = &mut column;
        match &mut self.values {
            Values::Bool(v) => put::<BoolType>(to, take(v), definition, repetition),
            Values::I32(v) => put::<Int32Type>(to, take(v), definition, repetition),
            Values::I64(v) => put::<Int64Type>(to, take(v), definition, repetition),
            Values::F32(v) => put::<FloatType>(to, take(v), definition, repetition),
            Values::F64(v) => put::<DoubleType>(to, take(v), definition, repetition),
            Values::Bytes(v) => put::<ByteArrayType>(to, take(v), definition, repetition),
        }?;
        self.definition.clear();
        self.repetition.clear();
        column.close()
    }
}

fn put<T: DataType>(
    column: &mut SerializedColumnWriter<'_>,
    values: Vec<T::T>,
    definition: Option<&[i16]>,
    repetition: Option<&[i16]>,
) -> Result<(), ParquetError> {
    column.typed::<T>().write_batch(&values, definition, repetition).map(drop)
}

/// Values by their type in the file.
#[derive(Clone, Debug)]
enum Values {
    Bool(Vec<bool>),
    I32(Vec<i32>),
    I64(Vec<i64>),
    F32(Vec<f32>),
    F64(Vec<f64>),
    Bytes(Vec<ByteArray>),
}

/// Adds one value, and many, of each numeric type; each returns the bytes that it added.
macro_rules! numbers {
    ($($column:ident $type:ident $to:ty,)*) => {
        fn one(&mut self, value: &Value) -> usize {
            match (self, value) {
                $((Self::$column(to), Value::$type(v)) => {
                    to.push(*v as $to);
                    size_of::<$to>()
                })*
                (Self::Bytes(to), Value::Text(v)) => bytes(to, v.as_bytes()),
                (Self::Bytes(to), Value::Array(Array::U8(v))) => bytes(to, v),
                (_, other) => unreachable!("a value of the schema: {other:?}"),
            }
        }

        fn many(&mut self, array: &Array) -> usize {
            match (self, array) {
                $((Self::$column(to), Array::$type(v)) => {
                    to.extend(v.iter().map(|v| *v as $to));
                    size_of::<$to>() * v.len()
                })*
                (Self::Bytes(to), Array::Text(v)) => v.iter().map(|v| bytes(to, v.as_bytes())).sum(),
                (_, other) => unreachable!("an array of the schema: {other:?}"),
            }
        }
    };
}

impl Values {
    fn of(kind: Physical) -> Self {
        match kind {
            Physical::BOOLEAN => Self::Bool(Vec::new()),
            Physical::INT32 => Self::I32(Vec::new()),
            Physical::INT64 => Self::I64(Vec::new()),
            Physical::FLOAT => Self::F32(Vec::new()),
            Physical::DOUBLE => Self::F64(Vec::new()),
            _ => Self::Bytes(Vec::new()),
        }
    }

    numbers!(
        Bool Bool bool,
        I32 I8 i32,
        I32 U8 i32,
        I32 I16 i32,
        I32 U16 i32,
        I32 I32 i32,
        I32 U32 i32,
        I64 I64 i64,
        I64 U64 i64,
        F32 F32 f32,
        F64 F64 f64,
    );
}

fn bytes(to: &mut Vec<ByteArray>, value: &[u8]) -> usize {
    to.push(ByteArray::from(value.to_vec()));
    value.len() + size_of::<ByteArray>()
}
