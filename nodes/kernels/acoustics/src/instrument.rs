//! Source, receivers and electronics.

use crate::error::{AcousticsError, setting};
use crate::noise::Noise;

/// Default number of samples per period of the centre frequency.
const SAMPLES_PER_PERIOD: f64 = 40.0;

/// Least and greatest number of samples per period.
const MIN_PER_PERIOD: f64 = 6.0;
const MAX_PER_PERIOD: f64 = 10_000.0;

const MAX_SHOTS: u32 = 1_000_000;

/// Source, receivers and electronics.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Instrument {
    /// Sampling rate, Hz; `None`: forty samples per period of the centre frequency.
    pub sample_rate: Option<f64>,
    /// Signal-to-noise ratio of one shot, dB: root mean square of the noise-free burst at the nearest receiver over
    /// that of white noise; infinite for no noise.
    pub signal_to_noise: f64,
    /// Standard deviation of the trigger time from shot to shot, s.
    pub jitter: f64,
    /// Number of shots that are averaged, 1 or more.
    pub shots: u32,
    /// Additional relative standard deviation of every speed, dimensionless: alignment, lengths.
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

/// Particle velocities at the receivers, sampled far more densely than by the instrument.
#[derive(Clone, Debug, PartialEq)]
pub struct ReceiverSignals {
    /// Time of the first sample after the trigger, s; the signal before it is zero.
    pub start: f64,
    /// Time between samples, s.
    pub interval: f64,
    /// Receivers, the nearest first, all with the same number of samples.
    pub channels: Vec<Vec<f64>>,
}

/// Times at which the instrument samples.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SamplingWindow {
    /// Time of the first sample after the trigger, s; negative: samples before the trigger give the level of the noise.
    pub start: f64,
    /// Sampling rate, Hz.
    pub rate: f64,
    /// Number of samples.
    pub samples: usize,
}

impl Instrument {
    /// The instrument, if its numbers are in range.
    pub fn validated(&self) -> Result<&Self, AcousticsError> {
        let Self { signal_to_noise, jitter, shots, speed_noise, .. } = *self;
        let rate = self.sample_rate.unwrap_or(SAMPLES_PER_PERIOD);
        setting("sample_rate", rate, rate.is_finite() && rate > 0.0, "more than 0 and finite")?;
        setting("signal_to_noise", signal_to_noise, signal_to_noise >= -200.0, "-200 dB or more")?;
        setting("jitter", jitter, jitter.is_finite() && jitter >= 0.0, "0 or more and finite")?;
        setting("shots", shots.into(), (1..=MAX_SHOTS).contains(&shots), "1 to 1,000,000")?;
        setting("speed_noise", speed_noise, (0.0..1.0).contains(&speed_noise), "0 or more and below 1")?;
        Ok(self)
    }

    /// Sampling rate for waves of `frequency`, Hz. The spectrum of a burst extends to twice its centre, so
    /// that fewer than six samples per period would alias; more than 10,000 only need memory.
    pub fn rate(&self, frequency: f64) -> Result<f64, AcousticsError> {
        let rate = self.sample_rate.unwrap_or(SAMPLES_PER_PERIOD * frequency);
        let resolved = (MIN_PER_PERIOD..=MAX_PER_PERIOD).contains(&(rate / frequency));
        setting("sample_rate", rate, resolved, "6 to 10,000 samples per period of the centre frequency")?;
        Ok(rate)
    }

    /// The recorded samples of each receiver: the mean of the shots, each delayed by its jitter and with its own noise.
    ///
    /// There is no anti-aliasing filter: the signals are averages over slabs of grains and of a source without higher
    /// frequencies. `signal` is the root mean square to which the signal-to-noise ratio refers. All receivers of a shot
    /// share its trigger. The noise depends on the seed and on `place` alone.
    pub fn record(
        &self,
        signals: &ReceiverSignals,
        window: &SamplingWindow,
        signal: f64,
        place: &[u64],
    ) -> Vec<Vec<f64>> {
        let noise = signal * 10f64.powf(-self.signal_to_noise / 20.0);
        let mut mean = vec![vec![0.0; window.samples]; signals.channels.len()];
        // Without jitter, shots differ only in their noise: their mean equals one shot with less noise.
        let (shots, noise) = match self.jitter > 0.0 {
            true => (self.shots, noise),
            false => (1, noise / f64::from(self.shots).sqrt()),
        };
        for shot in 0..shots {
            let mut random = Noise::at(self.seed, &[place, &[shot.into()]].concat());
            let late = self.jitter * random.next();
            for (samples, channel) in mean.iter_mut().zip(&signals.channels) {
                for (k, sample) in samples.iter_mut().enumerate() {
                    let time = window.start + k as f64 / window.rate - late;
                    *sample += interpolated(channel, (time - signals.start) / signals.interval);
                    if noise > 0.0 {
                        *sample += noise * random.next();
                    }
                }
            }
        }
        mean.iter_mut().flatten().for_each(|sample| *sample /= f64::from(shots));
        mean
    }
}

/// The largest root mean square over `window` consecutive samples: that of the burst in the signal.
pub(crate) fn burst_level(signal: &[f64], window: usize) -> f64 {
    let window = window.clamp(1, signal.len().max(1));
    let mut sum: f64 = signal.iter().take(window).map(|s| s * s).sum();
    let mut largest = sum;
    for (first, next) in signal.iter().zip(signal.iter().skip(window)) {
        sum += next * next - first * first;
        largest = largest.max(sum);
    }
    (largest.max(0.0) / window as f64).sqrt()
}

/// Catmull–Rom interpolation at `place`, counted in samples; 0 beyond the ends.
fn interpolated(signal: &[f64], place: f64) -> f64 {
    let whole = place.floor();
    let at = |k: f64| {
        let k = whole + k;
        if k >= 0.0 && k < signal.len() as f64 { signal[k as usize] } else { 0.0 }
    };
    let (a, b, c, d) = (at(-1.0), at(0.0), at(1.0), at(2.0));
    let t = place - whole;
    b + 0.5 * t * (c - a + t * (2.0 * a - 5.0 * b + 4.0 * c - d + t * (3.0 * (b - c) + d - a)))
}
