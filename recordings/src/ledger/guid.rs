//! Identity of a writer.

use std::fmt;
use std::str::FromStr;

/// The RTPS identity of one writer: 16 bytes, shown as 32 hexadecimal digits.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Guid(pub [u8; 16]);

impl fmt::Display for Guid {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.iter().try_for_each(|b| write!(f, "{b:02x}"))
    }
}

impl fmt::Debug for Guid {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Display::fmt(self, f)
    }
}

/// The text is not 32 hexadecimal digits.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{0:?} is not a writer GUID: 32 hexadecimal digits are needed")]
pub struct GuidError(pub String);

impl FromStr for Guid {
    type Err = GuidError;

    fn from_str(text: &str) -> Result<Self, GuidError> {
        // Digits only: from_str_radix alone would accept a sign.
        let value = match text.len() {
            32 if text.bytes().all(|b| b.is_ascii_hexdigit()) => u128::from_str_radix(text, 16).ok(),
            _ => None,
        };
        value.map(|v| Self(v.to_be_bytes())).ok_or_else(|| GuidError(text.to_owned()))
    }
}
