//! The declaration of a parameter: name, type and default, range, description.

use super::value::{IntoParameter, ParameterValue, parameter_text, type_name};
use std::fmt;

/// The valid values of a parameter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Range {
    /// Any value of its type (a double is never NaN).
    Any,
    /// An integer or every integer of a list, bounds included.
    Integer {
        /// Least valid value.
        min: i64,
        /// Greatest valid value.
        max: i64,
    },
    /// A double or every double of a list, bounds included; an infinite bound is no limit.
    Double {
        /// Least valid value.
        min: f64,
        /// Greatest valid value.
        max: f64,
    },
    /// A double strictly above zero, and finite.
    Positive,
    /// One of these texts.
    Choice(&'static [&'static str]),
}

impl Range {
    /// True if `value` lies within.
    pub fn contains(&self, value: &ParameterValue) -> bool {
        use ParameterValue as V;
        let doubles: &[f64] = match value {
            V::Double(v) => std::slice::from_ref(v),
            V::DoubleArray(v) => v,
            _ => &[],
        };
        if doubles.iter().any(|v| v.is_nan()) {
            return false;
        }
        match (self, value) {
            (Range::Any, _) => true,
            (Range::Integer { min, max }, V::Integer(v)) => (min..=max).contains(&v),
            (Range::Integer { min, max }, V::IntegerArray(v)) => v.iter().all(|v| (min..=max).contains(&v)),
            (Range::Double { min, max }, V::Double(_) | V::DoubleArray(_)) => {
                doubles.iter().all(|v| (min..=max).contains(&v))
            }
            (Range::Positive, V::Double(_) | V::DoubleArray(_)) => {
                doubles.iter().all(|v| *v > 0.0 && v.is_finite())
            }
            (Range::Choice(allowed), V::String(v)) => allowed.contains(&v.as_str()),
            (Range::Choice(allowed), V::StringArray(v)) => v.iter().all(|v| allowed.contains(&v.as_str())),
            // A range of another type than the parameter is a mistake of the declaration; it allows nothing.
            _ => false,
        }
    }
}

impl fmt::Display for Range {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Range::Any => write!(f, "any value that is a number"),
            Range::Integer { min, max: i64::MAX } => write!(f, "at least {min}"),
            Range::Integer { min, max } => write!(f, "{min} to {max}"),
            Range::Double { min, max } if max.is_infinite() => write!(f, "at least {min}"),
            Range::Double { min, max } => write!(f, "{min} to {max}"),
            Range::Positive => write!(f, "greater than 0 and finite"),
            Range::Choice(allowed) => {
                let named: Vec<&str> = allowed.iter().copied().filter(|name| !name.is_empty()).collect();
                write!(f, "one of {}", named.join(", "))
            }
        }
    }
}

/// One parameter of a node.
#[derive(Clone, Debug, PartialEq)]
pub struct ParameterSpec {
    /// Name, dots separating groups.
    pub name: &'static str,
    /// Default value, which also fixes its type.
    pub default: ParameterValue,
    /// Range of valid values.
    pub range: Range,
    /// Description, with the unit.
    pub description: &'static str,
    /// True if it cannot change while the node runs.
    pub read_only: bool,
}

impl ParameterSpec {
    /// A read-only parameter that may take any value of its type.
    pub fn new(name: &'static str, default: impl IntoParameter, description: &'static str) -> Self {
        Self { name, default: default.into_parameter(), range: Range::Any, description, read_only: true }
    }

    /// Makes it settable while the node runs. For what changes no result.
    #[must_use]
    pub fn changeable(self) -> Self {
        Self { read_only: false, ..self }
    }

    /// Sets its range.
    #[must_use]
    pub fn within(self, range: Range) -> Self {
        Self { range, ..self }
    }
}

/// A table of parameters, a row each: name, default value, range, description with the unit.
#[macro_export]
macro_rules! parameters {
    ($($name:literal $default:expr, $range:expr, $description:expr;)*) => {
        vec![$($crate::ParameterSpec::new($name, $default, $description).within($range)),*]
    };
}

/// One line of `--help`: `name (type, default …, range): description`.
impl fmt::Display for ParameterSpec {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} ({}, default {}", self.name, type_name(&self.default), parameter_text(&self.default))?;
        if self.range != Range::Any {
            write!(f, ", {}", self.range)?;
        }
        write!(f, "): {}", self.description)
    }
}
