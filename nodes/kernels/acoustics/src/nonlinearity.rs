//! Departure from a linear response, from a second run at half the amplitude.

/// Ratio of the changes of a speed: from half the amplitude to zero over from the full amplitude to half. The change is
/// proportional to a power of one half or more of the amplitude.
pub(crate) const TO_ZERO: f64 = 3.0;

/// Root mean square of full − 2 × half over that of the full signal, for pairs of samples (full, half).
pub(crate) fn relative_change<'a>(pairs: impl Iterator<Item = (&'a f64, &'a f64)>) -> f64 {
    let (mut difference, mut square) = (0.0, 0.0);
    for (full, half) in pairs {
        difference += (full - 2.0 * half).powi(2);
        square += full * full;
    }
    (difference / square).sqrt()
}
