//! What stands between a wave and the number that is written down.

use crate::error::AcousticsError;
use crate::noise::Noise;

/// Samples a period of the centre frequency, where the instrument names no rate.
const SAMPLES_PER_PERIOD: f64 = 40.0;

/// Fewest and most that it may name.
const LEAST_PER_PERIOD: f64 = 6.0;
const MOST_PER_PERIOD: f64 = 10_000.0;

/// Most shots that are averaged.
const MOST_SHOTS: u32 = 1_000_000;

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

/// What receivers would hear if nothing stood between: samples far denser than the instrument's.
#[derive(Clone, Debug, PartialEq)]
pub struct Heard {
    /// Time of the first sample after the trigger, s; before it all is quiet.
    pub start: f64,
    /// Time between samples, s.
    pub interval: f64,
    /// Receivers, the nearest first, all with the same number of samples.
    pub channels: Vec<Vec<f64>>,
}

/// When, and how fast, the instrument samples.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Clock {
    /// Time of the first sample after the trigger, s; negative: samples before the trigger tell what the noise is.
    pub start: f64,
    /// Samples a second, Hz.
    pub rate: f64,
    /// Samples.
    pub samples: usize,
}

impl Instrument {
    /// The instrument itself, if its numbers are in range.
    pub fn validated(&self) -> Result<&Self, AcousticsError> {
        let fault = |name, value, requirement| Err(AcousticsError::Setting { name, value, requirement });
        if let Some(rate) = self.sample_rate.filter(|r| !(r.is_finite() && *r > 0.0)) {
            return fault("sample_rate", rate, "more than 0 and finite");
        }
        if self.signal_to_noise.is_nan() || self.signal_to_noise < -200.0 {
            return fault("signal_to_noise", self.signal_to_noise, "-200 dB or more");
        }
        if !(self.jitter.is_finite() && self.jitter >= 0.0) {
            return fault("jitter", self.jitter, "0 or more and finite");
        }
        if !(1..=MOST_SHOTS).contains(&self.shots) {
            return fault("shots", self.shots.into(), "1 to 1,000,000");
        }
        if !(0.0..1.0).contains(&self.speed_noise) {
            return fault("speed_noise", self.speed_noise, "0 or more and below 1");
        }
        Ok(self)
    }

    /// Samples a second for waves of `frequency`, Hz. Fewer than six a period cannot tell a burst, whose spectrum reaches
    /// to twice its centre, from its aliases; more than 10,000 fill the memory and tell nothing.
    pub fn rate(&self, frequency: f64) -> Result<f64, AcousticsError> {
        let rate = self.sample_rate.unwrap_or(SAMPLES_PER_PERIOD * frequency);
        if !(LEAST_PER_PERIOD..=MOST_PER_PERIOD).contains(&(rate / frequency)) {
            let requirement = "6 to 10,000 samples a period of the centre frequency";
            return Err(AcousticsError::Setting { name: "sample_rate", value: rate, requirement });
        }
        Ok(rate)
    }

    /// What is written down: the mean of the shots, each of them late by its jitter and with its own noise.
    ///
    /// There is no filter before the sampling: what is heard comes from averages over a slab of grains of a source without
    /// higher frequencies, and has none either. `signal` is the root mean square that the signal to noise refers to. All
    /// receivers of a shot share its trigger. The noise is that of the seed at `place`, whatever else is recorded.
    pub fn record(&self, heard: &Heard, clock: &Clock, signal: f64, place: &[u64]) -> Vec<Vec<f64>> {
        let noise = signal * 10f64.powf(-self.signal_to_noise / 20.0);
        let mut mean = vec![vec![0.0; clock.samples]; heard.channels.len()];
        // Shots that come at one time differ in their noise alone, whose mean is as good as one with less of it.
        let (shots, noise) = match self.jitter > 0.0 {
            true => (self.shots, noise),
            false => (1, noise / f64::from(self.shots).sqrt()),
        };
        for shot in 0..shots {
            let mut random = Noise::at(self.seed, &[place, &[shot.into()]].concat());
            let late = self.jitter * random.next();
            for (samples, channel) in mean.iter_mut().zip(&heard.channels) {
                for (k, sample) in samples.iter_mut().enumerate() {
                    let time = clock.start + k as f64 / clock.rate - late;
                    *sample += interpolated(channel, (time - heard.start) / heard.interval);
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

/// The greatest root mean square over any `window` samples of a signal in a row: that of the burst in it.
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

/// The cubic through four neighbours (Catmull–Rom) at `place`, counted in samples; 0 beyond the ends.
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
