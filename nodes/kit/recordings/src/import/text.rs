//! Lines with their numbers, fields as numbers, and errors with both.

use grainlab_core::Vec3;

use super::error::ImportError;

/// A line and its number, counted from 1.
#[derive(Clone, Copy, Debug)]
pub(super) struct Line<'a> {
    pub(super) number: usize,
    pub(super) text: &'a str,
}

impl<'a> Line<'a> {
    pub(super) fn error(&self, problem: impl std::fmt::Display) -> ImportError {
        ImportError::line(self.number, problem)
    }

    pub(super) fn words(&self) -> Vec<&'a str> {
        self.text.split_whitespace().collect()
    }

    /// The number in `field`; `name` is its name in errors.
    pub(super) fn number<T: std::str::FromStr>(&self, name: &str, field: &str) -> Result<T, ImportError> {
        let problem = || format!("{name} is {}, not a valid number", shown(field));
        field.trim().parse().map_err(|_| self.error(problem()))
    }

    pub(super) fn finite(&self, name: &str, field: &str) -> Result<f64, ImportError> {
        let value: f64 = self.number(name, field)?;
        if value.is_finite() { Ok(value) } else { Err(self.error(format!("{name} is not finite ({value})"))) }
    }

    /// An id or a count, written as `3` or `3.0`.
    pub(super) fn id(&self, name: &str, field: &str) -> Result<u32, ImportError> {
        let value: f64 = self.number(name, field)?;
        if value.fract() == 0.0 && (0.0..=f64::from(u32::MAX)).contains(&value) {
            Ok(value as u32)
        } else {
            Err(self.error(format!("{name} is {}, not a whole number from 0 to {}", cut(field), u32::MAX)))
        }
    }

    /// Three fields as a vector of finite numbers.
    pub(super) fn vector(&self, name: &str, fields: [&str; 3]) -> Result<Vec3, ImportError> {
        let [x, y, z] = fields.map(|f| self.finite(name, f));
        Ok(Vec3::new(x?, y?, z?))
    }
}

pub(super) fn lines(text: &str) -> impl Iterator<Item = Line<'_>> {
    text.lines().enumerate().map(|(k, text)| Line { number: k + 1, text })
}

/// Maximum number of characters of a field in an error: a line of an arbitrary file may have megabytes.
const SHOWN: usize = 40;

/// `text` in quotation marks, truncated.
pub(super) fn shown(text: &str) -> String {
    format!("{:?}", cut(text))
}

pub(super) fn cut(text: &str) -> String {
    let head: String = text.chars().take(SHOWN).collect();
    if head.len() < text.len() { head + "…" } else { head }
}

/// Number of significant digits of a printed number: those from the first that is not zero.
pub(super) fn digits(field: &str) -> u32 {
    let mantissa = field.trim().split(['e', 'E']).next().unwrap_or_default();
    let count = mantissa.trim_start_matches(['-', '+', '0', '.']).bytes().filter(u8::is_ascii_digit).count();
    count as u32
}
