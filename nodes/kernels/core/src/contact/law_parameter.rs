//! Parameters of contact laws.

/// A parameter of a contact law, which does not follow from the material. It must be finite and positive, or zero where it
/// may be.
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
    /// True if zero is valid.
    pub may_be_zero: bool,
}

impl LawParameter {
    /// True if `value` is valid.
    pub fn admits(&self, value: f64) -> bool {
        value.is_finite() && (value > 0.0 || (self.may_be_zero && value == 0.0))
    }
}
