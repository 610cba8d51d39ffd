//! Arrival times in the traces of one burst.

use super::burst::Burst;
use super::settings::ArrivalPick;
use super::spectrum::{Analytic, Spectrum, summit, vertex};
use std::f64::consts::FRAC_PI_2;

/// Interpolated samples per period.
const FINE: f64 = 64.0;

/// Number of standard deviations of the noise by which the envelope of an arrival must exceed it: among a hundred
/// independent samples of noise the largest does so once in thirty times.
const STANDS_OUT: f64 = 4.0;

/// Durations of the burst before its peak in which its onset is looked for.
const BEFORE: f64 = 1.5;

/// Amplitude over the maximum at the first receiver below which a trace is zero. It is not relative to each receiver's own maximum, because
/// the front of a wave keeps its height where scattering reduces the peak.
const FLOOR: f64 = 0.1;

/// Noise over that maximum which hides an onset.
const MOST_NOISE: f64 = 0.13;

/// Least number of samples on either side of an onset.
const MARGIN: usize = 8;

/// Picks arrivals in traces of one length and sampling.
#[derive(Clone)]
pub(crate) struct Picker {
    pick: ArrivalPick,
    spectrum: Spectrum,
    /// Shape of the burst's spectrum, and a low pass.
    band: Vec<f64>,
    low: Vec<f64>,
    finer: usize,
    /// Original samples per burst.
    burst: f64,
    /// Interpolated samples per period.
    period: f64,
}

impl Picker {
    /// For traces of `samples` samples at the sampling rate `rate`, Hz.
    pub(crate) fn new(pick: ArrivalPick, burst: Burst, rate: f64, samples: usize) -> Self {
        let length = burst.duration() * rate;
        let sent: Vec<f64> = (0..length.ceil() as usize).map(|k| burst.at(k as f64 / rate)).collect();
        Self::of(pick, &sent, length, burst.frequency / rate, samples)
    }

    /// For a signal `sent` of the duration `burst` (samples) and the centre frequency `frequency` (samples⁻¹).
    pub(crate) fn of(pick: ArrivalPick, sent: &[f64], burst: f64, frequency: f64, samples: usize) -> Self {
        let finer = ((FINE * frequency).ceil().max(1.0) as usize).next_power_of_two();
        let spectrum = Spectrum::new(samples, finer);
        let band = spectrum.shape(sent);
        let low = |f: f64| (-0.5 * (f / (1.5 * frequency)).powi(2)).exp();
        let low = spectrum.frequencies().map(low).collect();
        Self { pick, spectrum, band, low, finer, burst, period: finer as f64 / frequency }
    }

    /// The arrival at each receiver, in samples after the first sample. For a correlation: the first receiver's peak
    /// plus the delay. `noise` is the standard deviation of white noise in the samples. `Err` is the reason why there
    /// is no arrival.
    pub(crate) fn times(&self, channels: &[&[f64]], noise: f64) -> Result<Vec<f64>, String> {
        let signals: Vec<Vec<Analytic>> =
            channels.iter().map(|c| self.spectrum.filtered(c, &self.band)).collect();
        let noise_left = noise * Spectrum::passed(&self.band);
        let mut peaks = Vec::with_capacity(signals.len());
        for (receiver, signal) in signals.iter().enumerate() {
            let (time, height) = summit(|k| signal[k].norm(), 0..signal.len()).unwrap_or((0.0, 0.0));
            if height.is_nan() || height <= STANDS_OUT * noise_left {
                let out = if noise_left > 0.0 { height / noise_left } else { 0.0 };
                return Err(format!(
                    "at receiver {receiver} the burst exceeds the noise by {out:.1} standard deviations, and {STANDS_OUT} \
                     are needed"
                ));
            }
            peaks.push(time);
        }
        let fine = match self.pick {
            ArrivalPick::Peak => peaks,
            ArrivalPick::CrossCorrelation => self.correlated(&signals, &peaks),
            ArrivalPick::FirstArrival => self.onsets(channels, &peaks, noise)?,
        };
        Ok(fine.iter().map(|t| t / self.finer as f64).collect())
    }

    /// Delays of largest correlation with the first receiver.
    fn correlated(&self, signals: &[Vec<Analytic>], peaks: &[f64]) -> Vec<f64> {
        let cut = |(s, p): (&Vec<Analytic>, &f64)| self.spectrum.of_analytic(self.cut(s, *p));
        let cut: Vec<Vec<Analytic>> = signals.iter().zip(peaks).map(cut).collect();
        let mut times = vec![peaks[0]];
        for k in 1..cut.len() {
            // The correlation of neighbours has one highest crest, since the carrier shifts little relative to the
            // envelope.
            let near = self.spectrum.correlation(&cut[k], &cut[k - 1]);
            let step = crest(&near, self.period, None);
            let far = self.spectrum.correlation(&cut[k], &cut[0]);
            let expected = times[k - 1] - times[0] + step;
            times.push(times[0] + crest(&far, self.period, Some(expected)));
        }
        times
    }

    /// A signal at the original times, tapered to its peak.
    fn cut(&self, signal: &[Analytic], peak: f64) -> Vec<Analytic> {
        let peak = peak / self.finer as f64;
        let flat = 0.75 * self.burst;
        let taper = |from: f64| {
            let beyond = ((from.abs() - flat) / (0.5 * self.burst)).clamp(0.0, 1.0);
            (FRAC_PI_2 * beyond).cos().powi(2)
        };
        signal.iter().step_by(self.finer).enumerate().map(|(k, s)| s * taper(k as f64 - peak)).collect()
    }

    fn onsets(&self, channels: &[&[f64]], peaks: &[f64], noise: f64) -> Result<Vec<f64>, String> {
        let noise = noise * Spectrum::passed(&self.low);
        let length = self.burst * self.finer as f64;
        let signals = channels.iter().map(|c| self.spectrum.filtered(c, &self.low));
        let signals: Vec<Vec<f64>> = signals.map(|s| s.iter().map(|s| s.re).collect()).collect();
        let largest = |of: &[f64]| of.iter().fold(0.0, |most: f64, s| most.max(s.abs()));
        let first = largest(&signals[0]);
        if noise > MOST_NOISE * first {
            return Err(format!("the noise hides the onset: it is {:.2} of the peak", noise / first));
        }
        let found = |(signal, peak): (&Vec<f64>, &f64)| {
            let from = (peak - BEFORE * length).max(0.0) as usize;
            onset(signal, from, *peak as usize, FLOOR * first)
                .ok_or("there is no onset before the peak".to_owned())
        };
        signals.iter().zip(peaks).map(found).collect()
    }
}

/// The place between two that divides a signal best into a part of small and a part of large variance (Maeda's AIC, 1985). `floor` is
/// the amplitude below which a signal is zero.
pub(crate) fn onset(signal: &[f64], from: usize, to: usize, floor: f64) -> Option<f64> {
    let part = &signal[from.min(signal.len())..to.clamp(from, signal.len())];
    let n = part.len();
    let grown = |sum: &mut f64, s: &f64| {
        *sum += s * s + floor * floor;
        Some(*sum)
    };
    let sums: Vec<f64> = std::iter::once(0.0).chain(part.iter().scan(0.0, grown)).collect();
    let of = |k: usize| {
        let (early, late) = (k as f64, (n - k) as f64);
        -early * (sums[k] / early).ln() - late * ((sums[n] - sums[k]) / late).ln()
    };
    let (place, _) = summit(of, MARGIN..n.saturating_sub(MARGIN))?;
    Some(from as f64 + place)
}

/// The delay of the crest of a correlation nearest to `expected`, or to the peak of its envelope.
fn crest(correlation: &[Analytic], period: f64, expected: Option<f64>) -> f64 {
    let zero = (correlation.len() / 2) as f64;
    let near = match expected {
        Some(delay) => zero + delay,
        None => summit(|k| correlation[k].norm(), 0..correlation.len()).map_or(zero, |(place, _)| place),
    };
    let reach = 0.75 * period;
    let last = correlation.len().saturating_sub(2) as f64;
    let range = (near - reach).clamp(1.0, last) as usize..(near + reach).clamp(1.0, last) as usize;
    let of = |k: usize| correlation[k].re;
    // Local maxima inside the range, not its ends.
    let crests = range.filter(|k| of(*k) >= of(k - 1) && of(*k) > of(k + 1));
    let nearest = crests.min_by(|a, b| (*a as f64 - near).abs().total_cmp(&(*b as f64 - near).abs()));
    nearest.map_or(near, |k| vertex(&of, k).0) - zero
}
