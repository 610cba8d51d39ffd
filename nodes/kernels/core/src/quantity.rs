//! Tables of quantities: what has a name, a unit and a meaning in one place, for printers, readers and references.

use crate::stiffness::Stiffness;
use crate::tensor::{SymTensor, Vec3};

/// Suffixes of the columns of a vector.
const AXES: [&str; 3] = ["x", "y", "z"];

/// One quantity of results of type `R`: a row of a table.
#[derive(Debug)]
pub struct Quantity<R: 'static> {
    /// Name in JSON, in CSV and on command lines, with the unit at its end where there is one.
    pub key: &'static str,
    /// Symbol in formulas; empty for a quantity without one.
    pub symbol: &'static str,
    /// Unit; `1` if it is dimensionless, empty if it is no number.
    pub unit: &'static str,
    /// Meaning, in a line.
    pub meaning: &'static str,
    /// Number and names of its columns.
    pub shape: Shape,
    /// Value in a result.
    pub value: fn(&R) -> Value,
    /// Other names under which a table may have it.
    pub aliases: &'static [Alias],
}

/// Another name of a quantity in a table.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Alias {
    /// The other name.
    pub name: &'static str,
    /// One unit of the column named so, in the unit of the quantity.
    pub factor: f64,
}

/// Number and names of the columns of a quantity.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shape {
    /// One: the column is the key.
    Scalar,
    /// x, y, z: the columns are the key with `_x`, `_y`, `_z`.
    Vector,
    /// Voigt order, tensor components: the columns are the key with `_xx`, `_yy`, `_zz`, `_yz`, `_xz`, `_xy`.
    Tensor,
    /// 6×6, row by row: the columns are `c11_pa` to `c66_pa` with this in front.
    Stiffness(&'static str),
    /// Any number of them: an array in JSON, and no column.
    List,
    /// One, in JSON alone: a column would be read as a measurement of its own.
    Aside,
}

/// A value of a quantity.
#[derive(Clone, Debug, PartialEq)]
pub enum Value {
    /// Undefined, or not known.
    Unknown,
    /// A floating-point number.
    Number(f64),
    /// A whole number.
    Count(u64),
    /// Yes or no.
    Flag(bool),
    /// One of some words.
    Word(&'static str),
    /// A text of any length.
    Text(String),
    /// As many numbers as the shape has, in its order.
    Numbers(Vec<Option<f64>>),
    /// Counts of a histogram.
    Counts(Vec<u32>),
}

impl<R> Quantity<R> {
    /// Names of its columns in CSV.
    pub fn columns(&self) -> Vec<String> {
        let with = |suffixes: &[&str]| suffixes.iter().map(|s| format!("{}_{s}", self.key)).collect();
        match self.shape {
            Shape::Scalar => vec![self.key.to_owned()],
            Shape::Vector => with(&AXES),
            Shape::Tensor => with(&SymTensor::COMPONENTS),
            Shape::Stiffness(prefix) => {
                (0..36).map(|n| format!("{prefix}c{}{}_pa", n / 6 + 1, n % 6 + 1)).collect()
            }
            Shape::List | Shape::Aside => Vec::new(),
        }
    }
}

/// A table of quantities of the result type `$of`, a row each: key, symbol, unit, meaning, shape, value, and aliases with
/// what one unit of theirs is in the unit of the quantity.
#[macro_export]
macro_rules! quantities {
    ($of:ty: $($key:literal $symbol:literal $unit:literal $meaning:literal $shape:expr,
        |$result:ident| $value:expr $(, or $alias:literal x $factor:literal)*;)*) => {
        &[$($crate::quantity::Quantity::<$of> {
            key: $key,
            symbol: $symbol,
            unit: $unit,
            meaning: $meaning,
            shape: $shape,
            value: |$result| $crate::quantity::Value::from($value),
            aliases: &[$($crate::quantity::Alias { name: $alias, factor: $factor }),*],
        }),*]
    };
}
/// The quantity of this key.
pub fn by_key<R>(table: &'static [Quantity<R>], key: &str) -> Option<&'static Quantity<R>> {
    table.iter().find(|q| q.key == key)
}

impl From<f64> for Value {
    fn from(value: f64) -> Self {
        Self::Number(value)
    }
}

impl From<u32> for Value {
    fn from(value: u32) -> Self {
        Self::Count(value.into())
    }
}

impl From<u64> for Value {
    fn from(value: u64) -> Self {
        Self::Count(value)
    }
}

impl From<usize> for Value {
    fn from(value: usize) -> Self {
        Self::Count(value as u64)
    }
}

impl From<bool> for Value {
    fn from(value: bool) -> Self {
        Self::Flag(value)
    }
}

impl From<&'static str> for Value {
    fn from(value: &'static str) -> Self {
        Self::Word(value)
    }
}

impl From<String> for Value {
    fn from(value: String) -> Self {
        Self::Text(value)
    }
}

impl From<Vec3> for Value {
    fn from(v: Vec3) -> Self {
        Self::from([v.x, v.y, v.z])
    }
}

impl From<SymTensor> for Value {
    fn from(tensor: SymTensor) -> Self {
        Self::from(tensor.voigt())
    }
}

impl From<Stiffness> for Value {
    fn from(stiffness: Stiffness) -> Self {
        Self::from(stiffness.row_major())
    }
}

impl<const N: usize> From<[f64; N]> for Value {
    fn from(values: [f64; N]) -> Self {
        Self::Numbers(values.map(Some).to_vec())
    }
}

impl<const N: usize> From<[Option<f64>; N]> for Value {
    fn from(values: [Option<f64>; N]) -> Self {
        Self::Numbers(values.to_vec())
    }
}

impl<const N: usize> From<[u32; N]> for Value {
    fn from(counts: [u32; N]) -> Self {
        Self::Counts(counts.to_vec())
    }
}

impl<T: Into<Value>> From<Option<T>> for Value {
    fn from(value: Option<T>) -> Self {
        value.map_or(Self::Unknown, Into::into)
    }
}
