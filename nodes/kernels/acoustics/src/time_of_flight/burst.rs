//! Tone bursts of the source.

use std::f64::consts::{PI, TAU};

/// A sine under a Hann window; its mean is zero for any number of periods.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Burst {
    /// Centre frequency, Hz.
    pub(crate) frequency: f64,
    pub(crate) cycles: f64,
}

impl Burst {
    /// Duration of the burst, s.
    pub(crate) fn duration(&self) -> f64 {
        self.cycles / self.frequency
    }

    /// Value at `time` s after the start of the burst, at most 1.
    pub(crate) fn at(&self, time: f64) -> f64 {
        let from_middle = time - 0.5 * self.duration();
        if from_middle.abs() >= 0.5 * self.duration() {
            return 0.0;
        }
        let window = (PI * from_middle / self.duration()).cos().powi(2);
        window * (TAU * self.frequency * from_middle).sin()
    }
}
