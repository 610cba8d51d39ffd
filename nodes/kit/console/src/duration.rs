//! Durations for readers.

/// A duration, s, in two units at most.
pub fn duration(seconds: f64) -> String {
    let s = seconds.round() as u64;
    match s {
        0..60 => format!("{s} s"),
        60..3600 => format!("{} min {} s", s / 60, s % 60),
        _ => format!("{} h {} min", s / 3600, s % 3600 / 60),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_duration_has_two_units_at_most() {
        assert_eq!([0.4, 59.4, 61.0, 3660.0].map(duration), ["0 s", "59 s", "1 min 1 s", "1 h 1 min"]);
    }
}
