//! Identities of readers and writers.

use serde::{Deserialize, Serialize};
use std::fmt;
use std::str::FromStr;

/// The RTPS identity of one reader or writer: 12 bytes of its participant and 4 of its own, shown as 32 hexadecimal digits.
#[derive(Clone, Copy, Default, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(transparent)]
pub struct Guid(pub [u8; 16]);

impl Guid {
    /// Stands for every endpoint of a participant: its entity is zero.
    pub fn of_participant(participant: [u8; 12]) -> Self {
        Self(std::array::from_fn(|n| participant.get(n).copied().unwrap_or(0)))
    }

    /// The GUID prefix: the 12 bytes that all endpoints of one process share.
    pub fn participant(&self) -> [u8; 12] {
        std::array::from_fn(|n| self.0[n])
    }
}

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

impl FromStr for Guid {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        // Digits only: from_str_radix alone would accept a sign.
        let value = match text.len() {
            32 if text.bytes().all(|b| b.is_ascii_hexdigit()) => u128::from_str_radix(text, 16).ok(),
            _ => None,
        };
        value
            .map(|v| Self(v.to_be_bytes()))
            .ok_or_else(|| format!("{text:?} is not a GUID: 32 hexadecimal digits are needed"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn guids_read_back_from_their_hexadecimal_form() {
        let id = Guid(std::array::from_fn(|i| (i * 17) as u8));
        assert_eq!(id.to_string(), "00112233445566778899aabbccddeeff");
        assert_eq!(id.to_string().parse(), Ok(id));
        for bad in ["", "0011", "zz112233445566778899aabbccddeeff", "é0112233445566778899aabbccddeef"] {
            assert!(bad.parse::<Guid>().is_err(), "{bad}");
        }
    }
}
