//! One value of a table.

use crate::output::exact;
use serde::Serialize;

/// A typed value.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
#[serde(untagged)]
pub enum Cell {
    /// Undefined, or not known.
    #[default]
    Unknown,
    /// A number; one that is not finite is unknown.
    Number(f64),
    /// A whole number.
    Count(u64),
    /// Yes or no.
    Flag(bool),
    /// A text or word.
    Text(String),
}

impl Cell {
    /// As CSV has it: at full precision, empty if unknown.
    pub fn text(&self) -> String {
        match self {
            Self::Unknown => String::new(),
            Self::Number(v) => exact(Some(*v)),
            Self::Count(n) => n.to_string(),
            Self::Flag(flag) => flag.to_string(),
            Self::Text(text) => text.clone(),
        }
    }
}
