//! Statements of a file that are checked: SI units, periodic boundaries on all sides, and quantities stated twice.

use super::error::ImportError;
use super::text::{Line, cut};

/// Refuses other units than m, kg and s, under any of their names.
pub(super) fn units(line: usize, text: &str) -> Result<(), ImportError> {
    let plain: Vec<&str> = text.split([' ', ',', '*', '_', '-']).filter(|word| !word.is_empty()).collect();
    let mut words: Vec<String> = plain.into_iter().map(str::to_lowercase).collect();
    words.sort();
    if words == ["si"] || words == ["kg", "m", "s"] {
        return Ok(());
    }
    let what = format!("units {}", cut(text));
    Err(ImportError::unsupported(line, what, "only SI units are: convert to m, kg and s"))
}

/// Refuses units that LAMMPS states, if they are not `si`.
pub(super) fn lammps_units(line: usize, text: &str) -> Result<(), ImportError> {
    if text.trim() == "si" {
        return Ok(());
    }
    let what = format!("units {}", cut(text.trim()));
    Err(ImportError::unsupported(
        line,
        what,
        "only SI units are: multiply lengths, masses, times and forces by their units",
    ))
}

/// Refuses boundaries that are not periodic on three sides, as `T T T`.
pub(super) fn periodic(line: usize, text: &str) -> Result<(), ImportError> {
    let words: Vec<String> =
        text.split([' ', ',', '[', ']', '"']).filter(|w| !w.is_empty()).map(str::to_lowercase).collect();
    if words.len() == 3 && words.iter().all(|w| ["t", "true", "1"].contains(&w.as_str())) {
        return Ok(());
    }
    let reason = "the cell must be periodic in all directions: there are no walls";
    Err(ImportError::unsupported(line, format!("pbc {}", cut(text)), reason))
}

pub(super) fn radius(
    line: &Line<'_>,
    radius: Option<f64>,
    diameter: Option<f64>,
) -> Result<Option<f64>, ImportError> {
    let half = diameter.map(|d| 0.5 * d);
    same(line, "radius and half of the diameter", radius, half)?;
    Ok(radius.or(half))
}

/// Refuses two values of one quantity that differ by more than the rounding of six digits.
pub(super) fn same(line: &Line<'_>, what: &str, a: Option<f64>, b: Option<f64>) -> Result<(), ImportError> {
    match (a, b) {
        (Some(a), Some(b)) if (a - b).abs() > 1e-5 * b.abs() => {
            Err(line.error(format!("{what} contradict each other: {a} and {b}")))
        }
        _ => Ok(()),
    }
}
