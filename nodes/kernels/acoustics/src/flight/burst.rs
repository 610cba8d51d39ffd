//! Tone bursts.

use std::f64::consts::{PI, TAU};

/// Some periods of a sine under a Hann window; its mean is zero, whatever the number of periods.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Burst {
    /// Centre frequency, Hz.
    pub(crate) frequency: f64,
    /// Periods.
    pub(crate) cycles: f64,
}

impl Burst {
    /// From its first to its last moment, s.
    pub(crate) fn duration(&self) -> f64 {
        self.cycles / self.frequency
    }

    /// Its value at `time` s after it began: 1 at most.
    pub(crate) fn at(&self, time: f64) -> f64 {
        let from_middle = time - 0.5 * self.duration();
        if from_middle.abs() >= 0.5 * self.duration() {
            return 0.0;
        }
        let window = (PI * from_middle / self.duration()).cos().powi(2);
        window * (TAU * self.frequency * from_middle).sin()
    }
}
