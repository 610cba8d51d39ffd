//! Reference data: files beside the code, each with its source.

use crate::error::VerificationError;
use serde::de::DeserializeOwned;

/// The content of a TOML file.
pub(crate) fn parse<T: DeserializeOwned>(file: &'static str, text: &str) -> Result<T, VerificationError> {
    toml::from_str(text).map_err(|e| VerificationError::Data { file, why: e.to_string() })
}

/// The numbers of a table: one row a line, separated by commas or white space; lines that begin with # are comments.
pub(crate) fn table(file: &'static str, text: &str) -> Result<Vec<Vec<f64>>, VerificationError> {
    let row = |line: &str| {
        let words = line.split([',', ' ', '\t']).filter(|w| !w.is_empty());
        words
            .map(|w| {
                w.parse().map_err(|_| VerificationError::Data { file, why: format!("{w:?} is no number") })
            })
            .collect()
    };
    text.lines().filter(|l| !l.starts_with('#') && !l.trim().is_empty()).map(row).collect()
}
