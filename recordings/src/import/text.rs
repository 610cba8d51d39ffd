//! Lines with their numbers, fields as numbers, and errors that name both.

use grains::Vec3;

use super::error::ImportError;

/// A line and its number, counted from 1.
#[derive(Clone, Copy, Debug)]
pub(super) struct Line<'a> {
    pub(super) number: usize,
    pub(super) text: &'a str,
}

impl<'a> Line<'a> {
    pub(super) fn error(&self, problem: impl Into<String>) -> ImportError {
        ImportError::Syntax { line: self.number, problem: problem.into() }
    }

    pub(super) fn words(&self) -> Vec<&'a str> {
        self.text.split_whitespace().collect()
    }

    /// `field`, which is called `name`, as a number.
    pub(super) fn number<T: std::str::FromStr>(&self, name: &str, field: &str) -> Result<T, ImportError> {
        field.trim().parse().map_err(|_| self.error(format!("{name} is {field:?}, not a number of its kind")))
    }

    /// An id or a count that other programs may write as `3` or `3.0`.
    pub(super) fn id(&self, name: &str, field: &str) -> Result<u32, ImportError> {
        let value: f64 = self.number(name, field)?;
        if value.fract() == 0.0 && (0.0..=f64::from(u32::MAX)).contains(&value) {
            Ok(value as u32)
        } else {
            Err(self.error(format!("{name} is {field}, not a whole number from 0 to {}", u32::MAX)))
        }
    }

    /// Three fields as a vector.
    pub(super) fn vector(&self, name: &str, fields: [&str; 3]) -> Result<Vec3, ImportError> {
        let [x, y, z] = fields.map(|f| self.number::<f64>(name, f));
        Ok(Vec3::new(x?, y?, z?))
    }
}

/// The lines of a text.
pub(super) fn lines(text: &str) -> impl Iterator<Item = Line<'_>> {
    text.lines().enumerate().map(|(k, text)| Line { number: k + 1, text })
}
