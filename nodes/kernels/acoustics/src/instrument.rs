//! What stands between a wave and the number that is written down.

/// Source, receivers and electronics.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Instrument {
    /// Samples a second, Hz; `None`: forty a period of the centre frequency.
    pub sample_rate: Option<f64>,
    /// Signal to noise of one shot, dB: root mean square of the noise-free burst at the nearest receiver over that of
    /// white noise; infinite for none.
    pub signal_to_noise: f64,
    /// Standard deviation of the trigger's time from shot to shot, s.
    pub jitter: f64,
    /// Shots that are averaged, 1 or more.
    pub shots: u32,
    /// Relative standard deviation of every speed beyond all that, 1: alignment, lengths.
    pub speed_noise: f64,
    /// Seed of all noise.
    pub seed: u64,
}

impl Default for Instrument {
    fn default() -> Self {
        Self {
            sample_rate: None,
            signal_to_noise: f64::INFINITY,
            jitter: 0.0,
            shots: 1,
            speed_noise: 0.0,
            seed: 1,
        }
    }
}

impl Instrument {
    /// Temporary.
    pub(crate) fn normal(&self, _index: u64) -> f64 {
        0.0
    }
}
