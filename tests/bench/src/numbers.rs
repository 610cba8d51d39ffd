//! Statistics of measurements, and numbers of the command line.

/// Mean of at least one number.
pub(super) fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

/// Root mean square of at least one number.
pub(super) fn rms(values: &[f64]) -> f64 {
    mean(&values.iter().map(|v| v * v).collect::<Vec<_>>()).sqrt()
}

/// Parses a number between two limits.
pub(super) fn between(text: &str, least: f64, most: f64) -> Result<f64, String> {
    let value = text.parse().ok().filter(|v| (least..=most).contains(v));
    value.ok_or_else(|| format!("it must be a number from {least:?} to {most:?}"))
}
