//! Weights of the speeds.

/// Relative error of every speed; `None` if none is known.
pub(super) fn errors(known: impl Iterator<Item = Option<f64>> + Clone) -> Option<Vec<f64>> {
    let largest = known.clone().flatten().reduce(f64::max)?;
    Some(known.map(|error| error.unwrap_or(largest)).collect())
}

/// Weights of the speeds for these relative errors, and the error of a speed of weight 1. All weights are 1 if no error
/// is known.
pub(super) fn weights(errors: Option<&[f64]>, speeds: usize) -> (Vec<f64>, Option<f64>) {
    let Some(errors) = errors else { return (vec![1.0; speeds], None) };
    let unit = errors.iter().copied().fold(f64::INFINITY, f64::min);
    (errors.iter().map(|e| (unit / e).powi(2)).collect(), Some(unit))
}
