//! Parameters of contact laws.

use std::ops::{Bound, RangeBounds};

/// A parameter of a contact law, which does not follow from the material.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LawParameter {
    /// Key in scenes.
    pub key: &'static str,
    /// Unit; empty for none.
    pub unit: &'static str,
    /// Meaning in words.
    pub meaning: &'static str,
    /// Value in scenes that do not give it; `None` if they must.
    pub default: Option<f64>,
    /// Lower and upper bound.
    pub range: (Bound<f64>, Bound<f64>),
}

impl LawParameter {
    /// Finite numbers above 0.
    pub const POSITIVE: (Bound<f64>, Bound<f64>) = (Bound::Excluded(0.0), Bound::Excluded(f64::INFINITY));
    /// Finite numbers from 0.
    pub const FROM_ZERO: (Bound<f64>, Bound<f64>) = (Bound::Included(0.0), Bound::Excluded(f64::INFINITY));

    /// A parameter with this key, unit, meaning, default value and range.
    pub const fn new(
        key: &'static str,
        unit: &'static str,
        meaning: &'static str,
        default: Option<f64>,
        range: (Bound<f64>, Bound<f64>),
    ) -> Self {
        Self { key, unit, meaning, default, range }
    }

    /// True if `value` is valid.
    pub fn admits(&self, value: f64) -> bool {
        self.range.contains(&value)
    }
}
