//! Numbers in the sentences of notes.

use std::fmt;
use std::ops::Mul;

/// Decimals beyond which two numbers are printed as equal.
const MOST_DIGITS: usize = 16;

/// A number of a note, or the least and the greatest number of several notes; printed as `1.2` or `1.2 to 1.5`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Shown {
    least: f64,
    greatest: f64,
}

impl From<f64> for Shown {
    fn from(value: f64) -> Self {
        Self { least: value, greatest: value }
    }
}

impl Mul<f64> for Shown {
    type Output = Self;

    fn mul(self, factor: f64) -> Self {
        Self { least: self.least * factor, greatest: self.greatest * factor }
    }
}

impl Shown {
    pub(super) fn widen(&mut self, value: f64) {
        self.least = self.least.min(value);
        self.greatest = self.greatest.max(value);
    }

    pub(super) fn abs(self) -> Self {
        let ends = [self.least.abs(), self.greatest.abs()];
        let crosses_zero = self.least < 0.0 && self.greatest > 0.0;
        Self { least: if crosses_zero { 0.0 } else { ends[0].min(ends[1]) }, greatest: ends[0].max(ends[1]) }
    }

    /// Returns the texts of this number and of the ends of a range that it is outside of, with `digits` decimals, or more if
    /// the number and the nearer end would look equal.
    pub(super) fn outside(self, [low, high]: [Self; 2], digits: usize) -> [String; 3] {
        self.apart([low, high], digits, |n, digits| format!("{n:.digits$}"))
    }

    /// Returns the same texts with exponents, for numbers that decimals do not show.
    pub(super) fn outside_by_exponent(self, [low, high]: [Self; 2], digits: usize) -> [String; 3] {
        self.apart([low, high], digits, |n, digits| format!("{n:.digits$e}"))
    }

    fn apart(
        self,
        [low, high]: [Self; 2],
        digits: usize,
        text: impl Fn(Self, usize) -> String,
    ) -> [String; 3] {
        let looks_equal = |value: f64, digits: usize| {
            let end = if value < low.least { low } else { high };
            text(value.into(), digits) == text(end, digits)
        };
        let differs = |digits: &usize| ![self.least, self.greatest].iter().any(|v| looks_equal(*v, *digits));
        let digits = (digits..=MOST_DIGITS).find(differs).unwrap_or(MOST_DIGITS);
        [self, low, high].map(|number| text(number, digits))
    }

    fn write(self, f: &mut fmt::Formatter<'_>, text: impl Fn(f64) -> String) -> fmt::Result {
        let [least, greatest] = [self.least, self.greatest].map(text);
        if least == greatest { f.write_str(&least) } else { write!(f, "{least} to {greatest}") }
    }
}

impl fmt::Display for Shown {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let precision = f.precision();
        self.write(f, |number| {
            precision.map_or_else(|| number.to_string(), |digits| format!("{number:.digits$}"))
        })
    }
}

impl fmt::LowerExp for Shown {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let precision = f.precision();
        self.write(f, |n| precision.map_or_else(|| format!("{n:e}"), |digits| format!("{n:.digits$e}")))
    }
}
