//! Statistics of measurements, and numbers as text.

use grainlab_console::fixed;

/// Mean of at least one number.
pub(super) fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

/// Root mean square of at least one number.
pub(super) fn rms(values: &[f64]) -> f64 {
    mean(&values.iter().map(|v| v * v).collect::<Vec<_>>()).sqrt()
}

/// A number as text with four significant digits: all digits before the point, and at most six after it.
pub(super) fn rounded(value: Option<f64>) -> String {
    let digits = value.map_or(0, |v| (3 - v.abs().max(1e-3).log10().floor() as i32).clamp(0, 6));
    fixed(value, digits as usize)
}

/// Parses a number between two limits.
pub(super) fn between(text: &str, least: f64, most: f64) -> Result<f64, String> {
    let value = text.parse().ok().filter(|v| (least..=most).contains(v));
    value.ok_or_else(|| format!("it must be a number from {least:?} to {most:?}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_has_four_significant_digits() {
        let shown = [21_345_678.9, 15.2345, 0.12345].map(|v| rounded(Some(v)));
        assert_eq!(shown, ["21345679", "15.23", "0.1235"].map(str::to_owned));
    }
}
