//! What a file states about itself and packings here cannot be otherwise: SI units, and periodic boundaries on all sides.

use super::error::ImportError;
use super::text::cut;

/// Refuses other units than m, kg and s, under any of their names.
pub(super) fn units(line: usize, text: &str) -> Result<(), ImportError> {
    let plain: Vec<&str> = text.split([' ', ',', '*', '_', '-']).filter(|word| !word.is_empty()).collect();
    let mut words: Vec<String> = plain.into_iter().map(str::to_lowercase).collect();
    words.sort();
    if words == ["si"] || words == ["kg", "m", "s"] {
        return Ok(());
    }
    let what = format!("units {}", cut(text));
    Err(ImportError::Unsupported { line, what, reason: "only SI units are: convert to m, kg and s" })
}

/// Refuses boundaries that are not periodic on three sides, as `T T T`.
pub(super) fn periodic(line: usize, text: &str) -> Result<(), ImportError> {
    let words: Vec<String> =
        text.split([' ', ',', '[', ']', '"']).filter(|w| !w.is_empty()).map(str::to_lowercase).collect();
    if words.len() == 3 && words.iter().all(|w| ["t", "true", "1"].contains(&w.as_str())) {
        return Ok(());
    }
    let what = format!("pbc {}", cut(text));
    Err(ImportError::Unsupported {
        line,
        what,
        reason: "the cell must be periodic in all directions: there are no walls",
    })
}
