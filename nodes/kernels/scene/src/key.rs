//! A key of the format: its meaning and its values.

use std::fmt;
use std::ops::{Bound, RangeBounds};

/// A key of the format.
#[derive(Clone, Copy, Debug)]
pub struct Key {
    /// Tables and name, as in `grains.count`; the keys of a phase begin with `phase`.
    pub path: &'static str,
    /// Kinds of phases that have the key; empty for all, and for keys outside phases.
    pub kinds: &'static [&'static str],
    /// Unit; empty for none.
    pub unit: &'static str,
    /// Values of the key.
    pub domain: Domain,
    /// Value if the scene does not set it.
    pub default: DefaultValue,
    /// Description in one line.
    pub meaning: &'static str,
}

/// Values of a key.
#[derive(Clone, Copy, Debug)]
pub enum Domain {
    /// A number within an interval.
    Number(Interval),
    /// A whole number from the first to the second.
    Whole(u64, u64),
    /// True or false.
    Flag,
    /// Any text in quotes.
    Text,
    /// One of these words.
    Choice(&'static [&'static str]),
    /// Another form, described in words.
    Form(&'static str),
}

/// Value of a key that the scene does not set.
#[derive(Clone, Copy, Debug)]
pub enum DefaultValue {
    /// No default: the scene must set it.
    Required,
    /// A default number.
    Number(f64),
    /// A whole number.
    Whole(u64),
    /// True or false.
    Flag(bool),
    /// A default text.
    Text(&'static str),
    /// Depends on other keys, or the key has no effect without a value; in words.
    Words(&'static str),
}

/// Numbers between two bounds; infinity only where there is no upper bound.
#[derive(Clone, Copy, Debug)]
pub struct Interval {
    /// Lower bound of the numbers.
    pub low: Bound<f64>,
    /// Upper bound of the numbers.
    pub high: Bound<f64>,
}

impl Interval {
    pub(crate) const FINITE: Self =
        Self { low: Bound::Excluded(f64::NEG_INFINITY), high: Bound::Excluded(f64::INFINITY) };
    pub(crate) const POSITIVE: Self = Self { low: Bound::Excluded(0.0), ..Self::FINITE };
    pub(crate) const NEGATIVE: Self = Self { high: Bound::Excluded(0.0), ..Self::FINITE };
    pub(crate) const FROM_ZERO: Self = Self { low: Bound::Included(0.0), ..Self::FINITE };
    pub(crate) const FROM_ZERO_TO_INFINITY: Self = Self { high: Bound::Unbounded, ..Self::FROM_ZERO };

    /// Numbers from `low` to `high`, both included.
    pub(crate) const fn from_to(low: f64, high: f64) -> Self {
        Self { low: Bound::Included(low), high: Bound::Included(high) }
    }

    /// True if `value` is in the interval; NaN never is.
    pub fn contains(&self, value: f64) -> bool {
        (self.low, self.high).contains(&value)
    }
}

impl fmt::Display for Interval {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        use Bound::{Excluded, Included};
        match (self.low, self.high) {
            (Included(low), Included(high)) => write!(f, "from {low} to {high}"),
            (Excluded(low), Included(high)) => write!(f, "more than {low}, at most {high}"),
            (Excluded(low), Excluded(high)) if low.is_finite() && high.is_finite() => {
                write!(f, "more than {low}, below {high}")
            }
            (Included(low), Excluded(_)) => write!(f, "{low} or more"),
            (Included(low), Bound::Unbounded) => write!(f, "{low} or more, inf too"),
            (Excluded(low), Excluded(_)) if low.is_finite() => write!(f, "more than {low}"),
            (_, Excluded(high)) if high.is_finite() => write!(f, "below {high}"),
            _ => f.write_str("finite"),
        }
    }
}

impl Key {
    /// Name in its table.
    pub fn name(&self) -> &'static str {
        self.path.rsplit('.').next().unwrap_or(self.path)
    }

    /// True for a condition that ends a phase. `hold` and `timeout` are not conditions.
    pub(crate) fn is_condition(&self) -> bool {
        self.path.starts_with("phase.until.") && !matches!(self.default, DefaultValue::Number(_))
    }

    /// The requirement on its value: "a number in m, more than 0".
    pub fn requirement(&self) -> String {
        let unit = if self.unit.is_empty() { String::new() } else { format!(" in {}", self.unit) };
        match self.domain {
            Domain::Number(range) => format!("a number{unit}, {range}"),
            Domain::Whole(min, max) => format!("a whole number{unit} from {min} to {max}"),
            Domain::Flag => "true or false".into(),
            Domain::Text => "text in quotes".into(),
            Domain::Choice(words) => words.iter().map(|w| format!("{w:?}")).collect::<Vec<_>>().join(" or "),
            Domain::Form(words) => words.into(),
        }
    }
}
